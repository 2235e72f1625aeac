"""The length of a run in seconds."""

import math

import pytest

from autobalancer import load
from autobalancer.harness.errors import SceneError

SCENE = load("two_balls")


def test_a_duration_is_the_length_of_the_run_in_time():
    scene = SCENE.replace({"run.duration": "7 s"})
    assert scene.run().time[-1] == pytest.approx(7.0, rel=1e-12)
    assert scene.revolutions == pytest.approx(7.0 * 3.0 / math.tau)


def test_it_and_revolutions_are_two_words_for_one_length():
    turns = 7.0 * 3.0 / math.tau
    by_time = SCENE.replace({"run.duration": 7.0}).run()
    by_turns = SCENE.replace({"run.revolutions": turns}).run()
    assert by_time["rotor.x"][-1] == pytest.approx(by_turns["rotor.x"][-1], rel=1e-6)


def test_setting_one_takes_the_place_of_the_other():
    timed = SCENE.replace({"run.revolutions": 5}).replace({"run.duration": 7.0})
    assert "revolutions" not in timed.document["run"]
    assert timed.replace({"run.revolutions": 5}).run.duration is None


def test_both_at_once_are_refused():
    with pytest.raises(SceneError, match="either duration"):
        SCENE.replace({"run.revolutions": 5, "run.duration": 7.0})


def test_a_profile_that_ends_at_rest_may_go_on_at_rest():
    stopping = {"operation.profile": [[0, 3], [5, 0]], "run.revolutions": None, "run.duration": 8.0}
    assert SCENE.replace(stopping).run().time[-1] == pytest.approx(8.0)


def test_runs_of_a_table_last_as_long():
    short = SCENE.replace({"run.duration": 7.0})
    found = short.run.many({"speed": [3.0, 4.0]}, results=["residual"])
    assert (found["failure"] == "").all()
    alone = short.replace({"speed": 4.0, "run.duration": 7.0}).run()
    size = (alone["rotor.x"] ** 2 + alone["rotor.y"] ** 2) ** 0.5
    last = alone.time > 7.0 - math.tau / 4.0
    assert found["residual"][1] == pytest.approx(size[last].max(), rel=0.02)
