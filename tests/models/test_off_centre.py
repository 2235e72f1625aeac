"""Weights on a track that is off centre: against long co-simulations and the closed form."""

from __future__ import annotations

import numpy as np
import pytest

import autobalancer as ab
from autobalancer.models.linear.balanced import balanced_angles
from autobalancer.models.linear.off_centre import centred

OFFSET = 4e-4 * np.exp(0.7j)  # m
SPEED = 150.0


def scene(**changes):
    """A drum that balances itself within 300 revolutions."""
    return ab.Scene.from_document(
        {
            "rotor": {"kind": "planar", "mass": 8.0, "stiffness": 20000.0, "damping": 120.0,
                      "unbalance": 0.01, "unbalance_angle": 0.4},
            "balancer": [{"kind": "balls", "name": "balls", "count": 2, "mass": 0.06,
                          "track_radius": 0.15, "drag": 0.3, "angles": [2.0, 5.0]}],
            "operation": {"speed": SPEED},
            "run": {"revolutions": 300},
        }
    ).replace({"balls.track_offset_xi": OFFSET.real, "balls.track_offset_eta": OFFSET.imag,
               **changes})  # fmt: skip


def test_weights_bring_the_centre_of_their_track_to_rest():
    machine = scene()
    run = machine.run()
    expected = np.sort(balanced_angles(centred(machine.assembly(), SPEED)) % (2 * np.pi))
    seen = np.sort([run[f"balls.weight[{k}].angle"][-1] % (2 * np.pi) for k in (1, 2)])
    np.testing.assert_allclose(seen, expected, atol=1e-3)
    assert np.hypot(run["rotor.x"], run["rotor.y"])[-1] == pytest.approx(abs(OFFSET), rel=1e-3)


def test_the_unbalance_that_is_left_to_the_weights_is_that_about_the_tracks_centre():
    """Closed form of a disc: u + m delta + delta (k - M w^2 + i c w)/w^2 with all masses M."""
    made = centred(scene().assembly(), SPEED)
    carried = 2 * 0.06
    mass = 8.0 + carried
    dynamic = 20000.0 - mass * SPEED**2 + 1j * 120.0 * SPEED
    unbalance = 0.01 * np.exp(0.4j) + carried * OFFSET + dynamic * OFFSET / SPEED**2
    assert complex(made.rotor.unbalance[0]) == pytest.approx(unbalance, rel=1e-12)
    assert not any(mounted.offset for mounted in made.weights)


def test_a_centred_machine_is_left_as_it_is():
    assembly = ab.load("two_balls").assembly()
    assert centred(assembly, 3.0) is assembly
