"""Speeds of weights on races with lobes: known where they have a rest, undecided where not."""

from __future__ import annotations

import json

import numpy as np
import pytest

import autobalancer as ab
from autobalancer.harness.show import window as strip
from autobalancer.harness.stability.speeds import Speeds
from autobalancer.models.linear.on_race import NoRest, main_motion
from autobalancer.models.linear.regions import Crossing
from autobalancer.models.lobes import turned_races
from autobalancer.models.stability import find_growth, growth_map


@pytest.fixture(scope="module")
def found():
    return ab.load("oval_fan").speeds(40.0, 44.0, "floquet", narrowest=1.0)


def test_a_band_without_a_rest_is_undecided_and_what_is_beside_it_is_known(found):
    (limit,) = found.methods["floquet"]
    assert (found.lowest["floquet"], limit.above) == ("undecided", "unstable")
    assembly = ab.load("oval_fan").assembly()
    with pytest.raises(NoRest):
        main_motion(assembly.at_speed(0.99 * limit.speed), 0.99 * limit.speed)
    machine, angles = main_motion(assembly.at_speed(1.01 * limit.speed), 1.01 * limit.speed)
    assert np.abs(machine.missing(angles)).max() < 1e-12


def test_a_rest_to_which_weights_creep_freely_is_found_where_balanced_ones_creep_without_end():
    scene = ab.load("oval_fan")
    assembly = turned_races(scene.assembly(), 5.0 * np.pi / 3.0)
    for speed in (80.0, scene.profile().end):
        machine, angles = main_motion(assembly, speed)
        assert np.abs(machine.missing(angles)).max() < 1e-12
        assert find_growth(assembly, speed).state == "stable"


def test_it_is_said_why_and_the_result_is_still_json(found):
    (said,) = found.unknown()
    assert "no rest of the weights on their races was found there" in said
    (region,) = json.loads(json.dumps(found.as_json()))["undecided"]["floquet"]
    assert region["growth_below"] is None


def test_a_map_has_a_hole_where_there_is_no_rest():
    rates = growth_map([ab.load("oval_fan").assembly()], [40.5, 44.0])
    assert np.isnan(rates).tolist() == [[True, False]]


def test_the_strip_of_a_page_shows_undecided_speeds_as_unknown(monkeypatch):
    crossings = (Crossing(50.0, "unstable"), Crossing(60.0, "stable"))
    answer = Speeds("", (40.0, 70.0), {"floquet": crossings}, {"floquet": "undecided"})
    monkeypatch.setattr(strip, "speeds", lambda *_, **__: answer)
    assert strip.window(ab.load("oval_fan")).kinds == ("unknown", "unstable", "good")
