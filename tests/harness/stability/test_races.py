"""Speeds and verdicts on races with lobes: about the true steady motion, and what it leaves."""

from __future__ import annotations

import re

import pytest

import autobalancer as ab
from autobalancer.harness.stability import boundaries
from autobalancer.harness.stability.growth_search import GrowthSearch
from autobalancer.harness.stability.main_motion import MainMotion
from autobalancer.models.linear.on_race import NoRest
from autobalancer.models.stability import find_growth
from tests.harness.master.test_races import balls, machine


def fan(amplitude: float, **run):
    race = [{"lobes": 2, "amplitude": amplitude, "angle": 0.3}]
    return machine(balancer=balls(race=race), run=run or {"revolutions": 300})


def test_speeds_say_what_is_left_and_runs_leave_it():
    found = fan(2e-5).speeds(10.0, 200.0, "criterion,floquet,cosim,proved")
    (crossing,) = found.methods["floquet"]
    assert crossing.above == "stable"
    assert crossing.speed == pytest.approx(43.934254, abs=1e-4)
    (by_units,) = found.methods["cosim"]
    assert by_units.above == "stable"
    assert by_units.speed == pytest.approx(crossing.speed, abs=1e-5)
    assert set(found.refused) == {"criterion", "proved"}
    assert all("round" in why or "lobes" in why for why in found.refused.values())
    (said, *_) = found.whirl.lines()
    assert said.startswith("The weights do not balance fully: the race is not round (balls): ")
    assert "0.0448 mm of 2.22 mm are left at 100 rad/s" in said
    at = {round(one.speed): one for one in found.whirl.at}
    assert at[105].amplitude[0] == pytest.approx(4.4837e-5, rel=1e-3)
    assert at[10].amplitude[0] > 5e-4  # below the critical speed


def test_growth_of_the_units_is_that_of_the_equations_on_several_races():
    scene = ab.load("oval_fan")
    with MainMotion(scene) as motion:
        search = GrowthSearch(motion)
        for speed in (50.0, 157.0):
            found, expected = search.find(speed).growth, find_growth(scene.assembly(), speed)
            assert found.state == expected.state
            assert found.rate == pytest.approx(expected.rate, rel=1e-3)


def test_where_weights_have_no_rest_the_units_are_refused_with_the_speed(monkeypatch):
    def fail(_assembly, speed, *_):
        raise NoRest(f"no rest of weights on their race was found at {speed:g} rad/s")

    monkeypatch.setattr("autobalancer.harness.stability.main_motion.main_motion", fail)
    found = fan(2e-5).speeds(90.0, 120.0, "cosim,floquet")
    assert "no rest of weights on their race was found at 100 rad/s" in found.refused["cosim"]


def test_a_rest_that_does_not_hold_is_said_to_be_unstable():
    """A run at this speed leaves far more than the rest would, see the test below."""
    found = fan(2e-5).replace({"operation.speed": 42.0}).speeds(41.0, 42.5, "floquet")
    assert found.lowest["floquet"] == "unstable"
    assert "by a rest that is unstable at 42 rad/s" in found.whirl.why


def test_where_no_rest_is_found_it_is_not_said_that_weights_cannot_balance(monkeypatch):
    def fail(*_):
        raise NoRest("no rest of weights on their race was found at 100 rad/s")

    monkeypatch.setattr(boundaries, "main_motion", fail)
    found = fan(2e-5).speeds(99.0, 101.0, "floquet")
    (said, *_) = found.whirl.lines()
    assert said.startswith("It is not known where the weights come to rest: no rest of weights")


def test_growth_changes_its_sign_where_runs_do():
    """A degree of speed on both sides of the limit, judged by runs."""
    scene = fan(2e-5, revolutions=600)
    ends = {}
    for speed in (42.0, 47.0):
        run = scene.replace({"operation.speed": speed, "balls.angles": [2.35, 3.97]}).run()
        ends[speed] = abs(run["rotor.x"] + 1j * run["rotor.y"])[-500:].max()
    assert ends[47.0] < 1e-4 < 5e-4 < ends[42.0]


@pytest.mark.parametrize(
    ("amplitude", "balanced", "words"),
    [
        (2e-5, True, "The race is not round: in balance it leaves 0.045 mm"),
        (1.5e-4, False, "the race is not round .*: in balance 18 % of the vibration is left"),
    ],
)
def test_the_verdict_says_what_the_race_leaves(amplitude, balanced, words):
    verdict = fan(amplitude).run()._verdict
    assert verdict.balanced is balanced
    assert verdict.left_by_race == pytest.approx(verdict.vibration, rel=1e-2)
    assert re.search(words, str(verdict))
