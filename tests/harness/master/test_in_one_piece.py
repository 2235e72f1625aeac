"""Runs in one piece keep their tolerance, state their error, and say what they are."""

import numpy as np
import pytest

from autobalancer.harness import Scene, load_scene
from autobalancer.harness.master.compared import motion_signals
from autobalancer.harness.master.one_file_run import OneFileRun
from autobalancer.harness.result.run import cosimulate
from autobalancer.models.monolith import simulate
from tests.studies.one_piece import EVENTFUL, FAMILIES, compared, drawn
from tests.studies.truth.draw import draw


@pytest.mark.parametrize("family", [*FAMILIES, *EVENTFUL])
def test_random_machines_keep_their_tolerance_and_state_their_error(family):
    known = 0
    for number in range(24):
        scene = drawn(family, number)
        found = compared(scene) if scene else None
        if found and not found.is_chaotic:
            assert not found.is_understated
            assert not found.is_missed
            known += 1
    assert known >= 6


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"weights.weight_radius": 0.1},
        {"weights.rolling_resistance": 1e-3},
        {"rotor.friction": [{"limit": 0.1}]},
        {"rotor.stiffness": [1.0, 1e5], "rotor.damping": [0.5, 1.0]},
        {"weights.drag": 200.0},
    ],
)
def test_all_machines_that_keep_a_tolerance_go_on_in_one_piece(changes):
    scene = load_scene("two_balls").replace({"coupling.tolerance": 1e-4, **changes})
    with OneFileRun(scene) as run:
        assert run.in_one_piece


@pytest.mark.parametrize("name", ["two_balls", "run_up", "drum", "sommerfeld", "balls_and_liquid"])
def test_both_engines_find_the_same_motion(name):
    """By power series, and by signals in given steps."""
    scene = load_scene(name).replace({"run.revolutions": 3})
    tight = {"coupling.scheme": "auto", "coupling.corrections": None}
    result = cosimulate(scene.replace({**tight, "coupling.tolerance": 1e-8}))
    given = cosimulate(scene.replace({**tight, "coupling.steps_per_rev": 400}))
    for signal in ("rotor.x", "rotor.y"):
        if signal not in result.signals:
            continue
        # at points of both
        times, at, there = np.intersect1d(
            np.round(result.time, 9), np.round(given.time, 9), return_indices=True
        )
        size = np.abs(given[signal]).max()
        assert len(times) >= 2
        assert np.abs(result[signal][at] - given[signal][there]).max() <= 3e-6 * size


@pytest.mark.parametrize(
    ("family", "numbers"),
    [
        ("finite", (2, 4, 5)),
        ("impacts", (0, 2, 9)),
        ("sticking", (0, 4, 9)),
        ("friction", (0, 4)),
        ("unequal", (8, 59)),
    ],
)
def test_events_are_those_of_an_independent_integration(family, numbers):
    """By SciPy, whose equations share nothing with the series but the physics."""
    for number in numbers:
        scene = Scene.from_document(draw(family, 5, number)).replace({"coupling.tolerance": 1e-6})
        result = cosimulate(scene)
        drive, start = scene.operation.drive(), scene.run.initial.motion()
        right = simulate(scene.assembly(), drive, result.time, initial=start, rtol=1e-11)
        for name in motion_signals(scene):
            expected = right.signal(name)
            size = max(np.abs(expected).max(), 1.0 if name.endswith("angle") else 0.0)
            assert np.abs(result[name] - expected).max() <= 1e-6 * size
