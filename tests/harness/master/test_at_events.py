"""The error of a signal that jumps at an event, where a record has a point at the instant of it."""

import numpy as np
import pytest

from autobalancer.harness import Scene
from autobalancer.harness.master.at_events import Counted, on_the_same_side
from autobalancer.harness.master.compared import largest_difference
from autobalancer.harness.master.one_file_run import OneFileRun
from autobalancer.harness.master.recorder import Recorder, divided
from autobalancer.harness.master.schedule import end_time
from tests.studies.truth.draw import draw
from tests.studies.truth.judge import beside_jumps, deviations, motion

PARTS = 4
GRID = np.linspace(0.0, 1.0, 21)
UNITS = {"motor.speed": "rad/s", "balls.weight[1].angle": "rad"}
LEAST = dict.fromkeys(UNITS, 0.0)


def struck(times, instants):
    """A shaft whose speed falls by 1 rad/s at each instant, and the angle of a weight."""
    passed = sum((times > at).astype(float) for at in instants)
    turned = sum(np.maximum(times - at, 0.0) for at in instants)
    signals = {"motor.speed": 10.0 + np.sin(times) - passed, "balls.weight[1].angle": turned}
    return Counted(signals, np.asarray(passed, float) + np.zeros_like(times))


def difference(first, second):
    """What a run with its impacts at `first` differs by from a finer one with those at `second`."""
    run, fine = struck(GRID, first), struck(divided(GRID, PARTS), second)
    compared = on_the_same_side(run, fine, PARTS, UNITS)
    return largest_difference(compared, fine.at(slice(None, None, PARTS)).signals, LEAST)


def test_a_point_on_either_side_of_an_impact_is_no_error():
    """The record has points at 0.3 and 0.35; signals between points are smooth to 1e-7."""
    instants = GRID[[6, 7]]
    earlier, later = instants - 1e-9, instants + 1e-9
    assert difference(instants, earlier) <= 1e-6
    assert difference(earlier, instants) <= 1e-6
    assert difference(instants, later) <= 1e-6
    assert difference(later, instants) <= 1e-6


@pytest.mark.parametrize("last", [[], [0.3 + 1.5 * GRID[1]]], ids=["missed", "two points later"])
def test_an_impact_that_a_run_misses_or_has_later_than_the_next_point_is_an_error(last):
    assert difference([0.1, *last], [0.1, 0.3]) >= 1.0 / 11.0
    assert difference([0.1, 0.3], [0.1, *last]) >= 1.0 / 11.0


def test_an_angle_is_compared_as_it_is_on_both_sides_of_an_impact():
    run, fine = struck(GRID, [GRID[6]]), struck(divided(GRID, PARTS), [GRID[6] - 1e-9])
    run.signals["balls.weight[1].angle"][6] += 1e-3
    compared = on_the_same_side(run, fine, PARTS, UNITS)
    own = fine.at(slice(None, None, PARTS)).signals
    assert largest_difference(compared, own, LEAST) == pytest.approx(1e-3, rel=1e-5)


def test_runs_that_have_passed_unlike_numbers_of_events_are_compared_point_by_point():
    """An event that one of them lacks is no reason to take any value near a point for right."""
    fine = struck(divided(GRID, PARTS), [0.1])
    run = fine.at(slice(None, None, PARTS))
    off = Counted({n: each + 1e-3 for n, each in run.signals.items()}, run.events + 1.0)
    compared = on_the_same_side(off, fine, PARTS, UNITS)
    assert largest_difference(compared, run.signals, LEAST) == pytest.approx(1e-3, rel=1e-6)


@pytest.mark.parametrize(("points", "allowed"), [(1, 1e-6), (2, 1.01)])
def test_the_judge_takes_one_point_for_the_other_side_of_a_jump_and_no_two(points, allowed):
    right = struck(GRID, [GRID[6] - 1e-9]).signals["motor.speed"]
    found = right + 1e-7
    found[6 : 6 + points] += 0.9
    worst = np.abs(beside_jumps(found, right)).max()
    assert 0.9 * (points > 1) < worst <= allowed


# balls that strike each other and slow a motor's shaft by steps
COLLIDING = draw("motor_contacts", 1, 54)


def test_a_run_counts_the_impacts_before_each_of_its_points():
    """The shaft's speed jumps between the points where the count rises, and nowhere else."""
    with OneFileRun(Scene.from_document(COLLIDING)) as run:
        recorder = Recorder(run.units, ["motor.speed"])
        run.start(1e-4, np.linspace(0.0, end_time(run.scene), 1000))
        run.record(recorder, None)
        _, found = recorder.columns()
        assert len(run.events) == len(found["motor.speed"])
    rises, jumps = np.diff(run.events), np.abs(np.diff(found["motor.speed"], 2))
    assert rises.min() == 0.0
    assert rises.sum() >= 3.0
    steady = (rises[1:] == 0.0) & (rises[:-1] == 0.0)
    assert jumps[~steady].max() > 100.0 * jumps[steady].max()


@pytest.mark.slow
@pytest.mark.parametrize("number", [70, 54])
def test_a_motor_s_speed_recorded_at_an_impact_leaves_the_error_known(number):
    scene = Scene.from_document(draw("motor_contacts", 1, number))
    run = scene.run()
    assert run.error_known, run.events
    assert run.estimated_error <= 1e-4
    assert max(deviations(run, motion(scene, run)).values()) <= 3.0 * run.estimated_error
