"""Stability proved on rubber, and on bodies that move along one axis."""

from __future__ import annotations

import pytest

import autobalancer as ab

pytest.importorskip("flint")

BALLS = {"name": "balls", "kind": "balls", "count": 2, "mass": 0.05, "track_radius": 0.1,
         "drag": 1.0}  # fmt: skip
DISC = {"kind": "planar", "mass": 10.0, "stiffness": 4e4, "damping": 40.0, "unbalance": 3e-3}
RUBBER = {"stiffness": [6e4, 7e4], "loss_factor": [0.2, 0.3], "loss_frequency": 90.0}
SPRING = {"stiffness": [6e4, 7e4], "damping": 200.0}


def on_a_base(foot, **body):
    base = {"name": "base", "mass": 30.0, "feet": [foot]} | body
    return ab.Scene(rotor=DISC | {"on": "base", "bodies": [base]}, balancer=[BALLS], speed=150.0)


ON_RUBBER = ab.Scene(
    rotor={**DISC, "damping": 0.0, "support_loss_factor": 0.2, "loss_frequency": 90.0},
    balancer=[BALLS], speed=150.0,
)  # fmt: skip
SCENES = {
    "supports": (ON_RUBBER, (60.0, 70.0)),
    "foot": (on_a_base(RUBBER), (75.0, 85.0)),
    "one way": (on_a_base(SPRING, free="y"), (65.0, 75.0)),
}


@pytest.mark.parametrize("name", SCENES)
def test_the_limit_by_floquet_lies_between_what_is_proved(name):
    scene, span = SCENES[name]
    (limit,) = (each.speed for each in scene.speeds(*span, "floquet").methods["floquet"])
    bands = scene.speeds(*span, "proved", narrowest=0.5).proof.bands
    assert {band.state for band in bands} == {"unstable", "undecided", "stable"}
    for band in bands:
        if band.state == "undecided":
            assert band.high - band.low <= 0.5
        else:
            assert limit <= band.low if band.state == "stable" else band.high <= limit


def test_internal_damping_on_a_body_that_moves_one_way_is_refused_by_name():
    with pytest.raises(ab.SceneError, match="free along y alone"):
        on_a_base(SPRING, free="y").replace({"rotor.internal_damping": 5.0})
