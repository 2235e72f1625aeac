"""Rows of weights that come together: what a run states of them at least."""

from __future__ import annotations

import numpy as np

import autobalancer as ab
from autobalancer.harness.master.cascades import UNRESOLVED, has_cascade


def row(angles, speeds, restitution=0.1):
    """Three balls on a rotor that hardly moves."""
    return ab.Scene.from_document(
        {
            "rotor": {"kind": "planar", "mass": 5.0, "stiffness": 5e4, "damping": 20.0,
                      "unbalance": 2e-3},
            "balancer": [{"kind": "balls", "name": "b", "count": 3, "mass": 0.05,
                          "track_radius": 0.1, "weight_radius": 0.008, "drag": 1e-4,
                          "restitution": restitution, "angles": angles, "speeds": speeds}],
            "operation": {"speed": 60.0},
            "run": {"revolutions": 0.6},
        }
    )  # fmt: skip


def path(*rows):
    """Angles of three balls at some times."""
    return {
        f"b.weight[{k}].angle": np.array(one) for k, one in enumerate(zip(*rows, strict=True), 1)
    }


def test_a_row_of_three_that_comes_together_states_what_no_run_resolves():
    scene = row([1.0, 1.4, 2.0], [20.0, 0.0, -20.0])
    assert scene.replace({"coupling.tolerance": 1e-6}).run().estimated_error >= UNRESOLVED


def test_two_of_three_that_collide_are_no_row():
    scene = row([1.0, 1.4, 4.0], [20.0, 0.0, 0.0])
    assert scene.replace({"coupling.tolerance": 1e-6}).run().estimated_error < UNRESOLVED


def test_a_row_is_three_neighbours_that_touch_at_one_time_and_did_not_before():
    scene = row([1.0, 1.4, 2.0], [0.0] * 3)
    gap = 2 * np.arcsin(0.08)
    apart, first, both = [1.0, 1.4, 2.0], [1.0, 1.0 + gap, 2.0], [1.0, 1.0 + gap, 1.0 + 2 * gap]
    second = [0.5, 1.0 + gap, 1.0 + 2 * gap]
    assert has_cascade(scene, path(apart, first, both))
    assert not has_cascade(scene, path(apart, first, second, first))
    assert not has_cascade(scene, path(both, both))
