"""What is proved of places along the axis, and of machines that nothing holds."""

from __future__ import annotations

import pytest

import autobalancer as ab

pytest.importorskip("flint")

BALLS = {"name": "balls", "kind": "balls", "count": 2, "mass": "10 g", "track_radius": "70 mm",
         "drag": 0.2, "angles": ["80 deg", "200 deg"]}  # fmt: skip


def rotor(place: str):
    table = {
        "kind": "two_support", "mass": "5 kg", "inertia": "0.02 kg m^2", "span": "200 mm",
        "stiffness": [["90 kN/m", "90 kN/m"]] * 2, "damping": [["80 N s/m", "80 N s/m"]] * 2,
        "planes": ["80 mm"], "unbalances": [{"position": place, "amount": "300 g mm"}],
    }  # fmt: skip
    return ab.Scene(rotor=table, balancer=[BALLS], speed="3000 rpm")


def test_an_unbalance_written_at_the_place_of_a_plane_is_proved_to_be_there():
    found = rotor("80 mm").speeds(330.0, 400.0, "proved")
    assert found.proof.bands[-1].state == "stable"
    other = rotor("80.1 mm").speeds(330.0, 400.0, "proved")
    assert other.proof is None


def test_a_machine_that_nothing_holds_is_refused_by_name():
    found = ab.load("angle_grinder").speeds(300.0, 1500.0, "proved")
    assert "nothing holds 'housing'" in found.refused["proved"]
