"""The energy of runs, of separate kinetic and potential parts: none of the units' equations."""

from __future__ import annotations

import numpy as np
import pytest

from autobalancer.harness import Scene, cosimulate
from tests.energy import balance, signals

WEIGHTS = {"name": "weights", "mass": 0.05, "track_radius": 0.1, "count": 2}
ROTOR = {"kind": "planar", "mass": 2.0, "stiffness": [8e3, 6e3]}
STARTS = {"angles": [0.3, 2.0], "speeds": [3.0, -8.0]}


def unaccounted(scene: Scene, largest: float = 0.0) -> float:
    """Largest energy that comes from nowhere, over the range of the energy or `largest` [J]."""
    run = cosimulate(scene, record=signals(scene))
    energy, work = balance(scene, run)
    return float(np.abs(energy - energy[0] - work).max() / max(np.ptp(energy), largest))


@pytest.mark.parametrize("kind", ["pendulums", "balls"])
@pytest.mark.parametrize("lossy", [False, True])
def test_under_gravity_energy_is_what_was_there_and_what_was_fed_in(kind, lossy):
    scene = Scene.from_document(
        {
            "rotor": ROTOR | {"damping": 30.0 * lossy, "unbalance": 2e-3 * lossy},
            "balancer": [WEIGHTS | STARTS | {"kind": kind, "drag": 0.05 * lossy}],
            "operation": {"speed": 40.0, "gravity": 9.81},
            "coupling": {"steps_per_rev": 400},
            "run": {"revolutions": 6},
        }
    )
    assert unaccounted(scene, 2.0 * 0.05 * 9.81 * 0.1) < 2e-7


@pytest.mark.parametrize("kind", ["pendulums", "balls", "rollers"])
@pytest.mark.parametrize("size", [{}, {"weight_radius": 0.02}])
def test_in_a_run_up_the_spinning_track_feeds_in_what_rolling_takes(kind, size):
    scene = Scene.from_document(
        {
            "rotor": ROTOR | {"damping": 30.0, "unbalance": 2e-3},
            "balancer": [WEIGHTS | {"kind": kind, "count": 1, "drag": 0.2, "angles": [0.3]} | size],
            "operation": {"run_up": {"from": 20.0, "to": 80.0, "seconds": 0.8}, "gravity": 9.81},
            "coupling": {"steps_per_rev": 800},
            "run": {"revolutions": 6},
        }
    )
    assert unaccounted(scene) < 1e-6
