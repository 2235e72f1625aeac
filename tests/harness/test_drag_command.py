"""`autobalancer drag`: wrong input is refused with what is allowed."""

from __future__ import annotations

import pytest

import autobalancer as ab
from autobalancer.harness import UserError


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        ("--oil VG46", "--ball: give the diameter of the ball"),
        ("--ball 10 --oil VG46", "below 1 m, such as --ball 10mm"),
        ("--ball 10g --oil VG46", "a length is expected"),
        ("--ball 10mm", "give either --decay"),
        ("--ball 10mm --oil VG46 --decay 30deg 10deg 1s", "give either --decay"),
        ("--ball 10mm --oil VG47", "must be one of 10, 15, 22"),
        ("--ball 10mm --oil grease", "must be an ISO grade"),
        ("--ball 10mm --oil VG46 --temperature 60", "such as 40degC"),
        ("--ball 10mm --decay 10deg 30deg 1s", "LAST must be below FIRST"),
        ("--ball 10mm --decay 30deg 10rpm 1s", "two angles of a ball that swings"),
        ("--ball 10mm --decay 30 10 1s", "two angles of a ball that swings"),
        ("--ball 10mm --decay 200deg 10deg 1s", "stays below 180 deg"),
        ("--ball 10mm --decay 30deg 10deg 1kg", "a time is expected"),
        ("--ball 10mm --decay 30deg 10deg 1s --swings 2.3", "must be whole or half"),
        ("--ball 10mm --decay 90rpm 10rpm 1s --swings 2", "--decay gives two speeds"),
        ("--ball 10mm --oil VG46 --swings 2", "must be the number of swings of --decay"),
    ],
)
def test_wrong_input_is_refused_with_what_is_allowed(invoke, arguments, problem):
    outcome = invoke("drag", *arguments.split())
    assert outcome.exit_code == 2
    assert problem in outcome.stderr


def test_a_decay_from_a_large_angle_says_what_is_not_known_without_the_number_of_swings(invoke):
    decay = ("drag", "--ball", "10mm", "--decay", "170deg", "20deg", "1.2s")
    alone, counted = invoke(*decay), invoke(*decay, "--swings", "3")
    assert "give --swings" in alone.stdout
    assert "give --swings" not in counted.stdout
    assert (
        "give --swings"
        not in invoke("drag", "--ball", "10mm", "--decay", "30deg", "10deg", "1.2s").stdout
    )


def test_a_drag_is_a_number_of_python_and_its_arguments_are_read_with_units():
    found = ab.find_drag("10 mm", decay=("30deg", "10deg", "1.2s"), swings=1000)
    assert (type(found.value), type(found.decay_time)) == (float, float)
    dense = ab.find_drag("10 mm", decay=("30deg", "10deg", "1.2s"), density="7.8 g/cm^3")
    assert dense == ab.find_drag("10 mm", decay=("30deg", "10deg", "1.2s"))
    for wrong, words in (({"swings": "x"}, "--swings x: a ratio"), ({"density": "x"}, "a density")):
        with pytest.raises(UserError, match=words):
            ab.find_drag("10 mm", decay=("30deg", "10deg", "1.2s"), **wrong)
