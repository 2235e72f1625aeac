"""Scenes on rubber, and with bodies that move along one axis alone."""

from __future__ import annotations

import numpy as np
import pytest

import autobalancer as ab
from autobalancer.harness import SceneError, cosimulate
from autobalancer.models.monolith import simulate
from autobalancer.models.rubber import zener

BALLS = {
    "name": "balls", "kind": "balls", "count": 2, "mass": 0.03, "track_radius": 0.08, "drag": 0.3,
    "angles": [1.0, 2.8],
}  # fmt: skip
DRIVE = {"kind": "planar", "mass": 8.0, "stiffness": 4e5, "damping": 60.0, "unbalance": 1.5e-3,
         "on": "base"}  # fmt: skip
FOOT = {"stiffness": [9e4, 6e4], "loss_factor": [0.2, 0.3], "loss_frequency": "25 Hz"}


def drive(foot=FOOT, operation=None, **body):
    base = {"name": "base", "mass": 20.0, "feet": [foot]} | body
    return ab.Scene(
        rotor=DRIVE | {"bodies": [base]}, balancer=[BALLS], operation=operation or {"speed": 160.0},
        run={"revolutions": 8},
    )  # fmt: skip


def test_both_engines_move_a_drive_on_rubber_feet_as_an_independent_integration():
    scene = drive()
    one, several = (cosimulate(scene, separate=choice) for choice in (False, True))
    apart = simulate(scene.assembly(), scene.profile(), one.time, method="DOP853", rtol=1e-10)
    for number in (1, 2):
        name = f"rotor.station[{number}].y"
        expected = apart.y[:, number - 1]
        size = np.abs(expected).max()
        assert one[name] == pytest.approx(expected, abs=2e-4 * size)
        last = np.interp(several.time[-1], one.time, expected)
        assert several[name][-1] == pytest.approx(last, abs=2e-4 * size)


def test_stiffness_of_rubber_is_the_dynamic_one_at_its_frequency():
    w = zener(1.0, 0.2, 1.0)
    rotor = {"kind": "planar", "mass": 1.0, "stiffness": 1.0, "support_loss_factor": 0.2,
             "loss_frequency": 1.0}  # fmt: skip
    scene = ab.Scene(rotor=rotor, speed=3.0)
    support = scene.assembly().rotor.supports[0]
    assert support.stiffness[0, 0, 0, 0] == pytest.approx(w.static + w.branch)
    text = rotor | {"loss_frequency": "50 Hz"}
    assert ab.Scene(rotor=text, speed=3.0).rotor.loss_frequency == pytest.approx(100.0 * np.pi)


@pytest.mark.parametrize(
    ("foot", "body", "words"),
    [
        ({"stiffness": 1e4, "loss_factor": 0.2}, {}, "requires loss_frequency"),
        ({"stiffness": 1e4, "loss_frequency": 9.0}, {}, "belongs to loss_factor"),
        ({"stiffness": 1e4, "loss_factor": -0.1, "loss_frequency": 9.0}, {}, "loss_factor"),
        ({"stiffness": 1e4}, {"free": "z"}, "free"),
        ({"stiffness": 1e4}, {"free": "x", "feet": []}, "requires feet"),
    ],
)
def test_rubber_and_free_axes_that_say_half_are_refused(foot, body, words):
    with pytest.raises(SceneError, match=words):
        drive(foot, **body)


def test_gravity_on_rubber_or_along_a_rigid_axis_is_refused():
    heavy = {"speed": 160.0, "gravity": 9.81}
    with pytest.raises(SceneError, match="does not support rubber"):
        drive(operation=heavy)
    with pytest.raises(SceneError, match="along y, in which a body cannot move"):
        drive({"stiffness": 1e4}, heavy, free="x")


def test_a_base_that_moves_along_y_alone_stands_still_along_x():
    scene = drive({"stiffness": [1e4, 8e4], "damping": 40.0}, free="y")
    run = cosimulate(scene)
    assert not run["rotor.station[2].x"].any()
    assert np.abs(run["rotor.station[2].y"]).max() > 1e-5
    apart = simulate(scene.assembly(), scene.profile(), run.time, method="DOP853", rtol=1e-10)
    size = np.abs(apart.x[:, 0]).max()
    assert run["rotor.station[1].x"] == pytest.approx(apart.x[:, 0], abs=2e-4 * size)
