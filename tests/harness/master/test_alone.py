"""The error that a rotor without a loop states."""

from __future__ import annotations

import pytest

from autobalancer.harness import Scene
from autobalancer.harness.result.run import cosimulate

RIG = {
    "rotor": {
        "kind": "planar",
        "mass": 2.0,
        "stiffness": [8000.0, 9000.0],
        "damping": 4.0,
        "unbalance": 0.004,
    },
    "operation": {"speed": 70.0},
    "run": {"revolutions": 12.3},
}
SLIDERS = {
    "rigid": [{"limit": 4.0}],
    "behind springs": [{"limit": [4.0, 6.0], "stiffness": 5e4}],
}


@pytest.mark.parametrize("sliders", SLIDERS.values(), ids=SLIDERS)
def test_dry_friction_states_the_difference_to_a_run_in_half_the_steps(sliders):
    """Of separate units; in one piece runs with other tolerances of steps are compared."""
    scene = Scene.from_document(RIG).replace({"rotor.friction": sliders})
    assert 0.0 < cosimulate(scene).estimated_error < 1e-4
    run = cosimulate(scene, separate=True)
    assert run.error_known
    assert 0.0 < run.estimated_error < 1e-9
    assert run.steps == len(run.time) - 1  # of the run that is shown


def test_a_rotor_without_friction_is_exact():
    assert cosimulate(Scene.from_document(RIG)).estimated_error == 0.0
