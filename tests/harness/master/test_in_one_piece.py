"""Runs in one piece keep their tolerance, state their error, and say what they are."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from autobalancer.harness import Scene, load_scene
from autobalancer.harness.master.compared import motion_signals
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
        {"coupling.tolerance": 1e-4},
        {"coupling.steps_per_rev": 20, "coupling.corrections": 2},
        {"coupling.steps_per_rev": 20, "coupling.scheme": "iterated"},
        {"coupling.steps_per_rev": 20, "coupling.scheme": "jacobi"},
        {"coupling.steps_per_rev": 20, "coupling.scheme": "compensated"},
        {"coupling.steps_per_rev": 20, "coupling.order": 0},
        {"coupling.tolerance": 1e-4, "coupling.scheme": "gauss-seidel"},
    ],
)
def test_a_scene_runs_in_one_piece_whatever_it_says_of_separate_units(changes):
    """Its motion is the same; with given steps it has rows there."""
    free = dict.fromkeys(("coupling.scheme", "coupling.corrections", "coupling.steps_per_rev"))
    scene = load_scene("two_balls").replace({**free, "run.revolutions": 3})
    best = cosimulate(scene.replace({"coupling.tolerance": 1e-9}))
    run = cosimulate(scene.replace(changes))
    assert run.series_order > 0
    given = changes.get("coupling.steps_per_rev")
    assert (len(run.time) == 3 * 20 + 1) == (given is not None)
    for signal in ("rotor.x", "rotor.y"):
        expected = CubicSpline(best.time, best[signal])(run.time)
        assert np.abs(run[signal] - expected).max() <= 1e-4 * np.abs(expected).max()


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


@pytest.mark.parametrize(
    "counts", [(2, 1), (1, 2), (1, 1, 1), (5, 1), (5, 2), (6, 1), (3, 3), (4, 1, 1), (1, 8)]
)
def test_weights_belong_to_their_track_however_many_there_are(counts):
    """A plain machine expands four weights at once, also of several tracks; by SciPy."""
    balancers = [
        {
            "kind": "balls", "name": f"b{k}", "at": 1 + k % 2, "count": count, "mass": 0.01,
            "drag": 0.5, "track_radius": 0.05 + 0.01 * k,
            "angles": [0.7 * k + 5.0 * j / count for j in range(count)],
        }
        for k, count in enumerate(counts)
    ]  # fmt: skip
    rotor = {
        "kind": "two_support", "mass": 1.5, "com": 0.3, "inertia": 0.05, "polar_inertia": 0.03,
        "span": 0.7, "planes": [0.2, 0.5], "stiffness": [3e4, 4e4], "damping": [15.0, 20.0],
        "unbalances": [{"amount": 1e-3, "angle": 2.4, "position": 0.1}],
    }  # fmt: skip
    scene = Scene.from_document(
        {
            "rotor": rotor, "balancer": balancers, "operation": {"speed": 300.0},
            "coupling": {"tolerance": 1e-7}, "run": {"revolutions": 3.0},
        }
    )  # fmt: skip
    run = cosimulate(scene)
    drive, start = scene.operation.drive(), scene.run.initial.motion()
    right = simulate(scene.assembly(), drive, run.time, initial=start, rtol=1e-11)
    for name in motion_signals(scene):
        assert np.abs(run[name] - right[name]).max() <= 1e-6 * np.abs(right[name]).max()
