"""The range of speeds that `speeds` looks at where none is given."""

from __future__ import annotations

import math

import pytest

import autobalancer as ab
from autobalancer.harness.errors import UserError


def scene(**rotor):
    given = {"mass": 10.0, "stiffness": 4e4, "damping": 40.0, "unbalance": 2e-3} | rotor
    balls = {"name": "balls", "kind": "balls", "count": 2, "mass": 0.05, "track_radius": 0.1,
             "drag": 0.5}  # fmt: skip
    return ab.Scene(rotor={"kind": "planar", **given}, balancer=[balls], speed=200.0)


def test_it_reaches_from_half_the_natural_frequency_beyond_the_operation():
    machine = scene()
    resting = math.sqrt(4e4 / 10.1)  # with the balls
    found = machine.speeds(methods="floquet")
    assert found.range == pytest.approx((0.5 * resting, 250.0), rel=0.01)
    again = machine.speeds(*found.range, "floquet").methods["floquet"]
    assert [each.speed for each in found.methods["floquet"]] == [each.speed for each in again]
    assert again


def test_it_stays_within_the_tables_of_bearings():
    row = [1e5, 0.0, 0.0, 1e5, 60.0, 0.0, 0.0, 60.0]
    table = [[90.0, *row], [220.0, *row]]
    machine = scene().document
    machine["rotor"] = {"kind": "planar", "mass": 10.0, "unbalance": 2e-3}
    machine["rotor"]["bearings"] = [{"table": table}]
    assert ab.Scene.from_document(machine).speeds(methods="floquet").range == (90.0, 220.0)


def test_the_operation_of_a_free_tool_is_in_it():
    low, high = ab.load("angle_grinder").speeds(methods="criterion").range
    assert low < ab.load("angle_grinder").profile().end < high


def test_one_end_alone_is_refused():
    with pytest.raises(UserError, match="both of its ends"):
        scene().speeds(50.0)


def test_a_mass_that_rounding_makes_singular_is_refused_by_name():
    rotor = {"kind": "two_support", "mass": 1e20, "inertia": 0.5, "span": 0.4,
             "stiffness": [1e5, 1e5]}  # fmt: skip
    with pytest.raises(ab.SceneError, match="its mass matrix is singular"):
        ab.Scene(rotor=rotor, speed=100.0)


def test_the_design_of_a_scene_with_liquid_alone_names_its_kind():
    with pytest.raises(ab.SceneError, match='of kind "liquid", without weights'):
        ab.load("liquid_heavy").design()
