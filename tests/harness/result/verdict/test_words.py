"""Numbers of a verdict in words: no exponent, and nothing more exact than it is known."""

from __future__ import annotations

import pytest

from autobalancer.harness.result.verdict.words import (
    millimetres,
    percent,
    seconds,
    show_too_little,
    times,
    velocity,
)


@pytest.mark.parametrize("exponent", range(-30, 31))
def test_no_size_is_written_with_an_exponent(exponent):
    kinds = (millimetres, percent, velocity, seconds)
    said = [words(3.7 * 10.0**exponent) for words in kinds]
    assert not [text for text in said if "e+" in text or "e-" in text]


def test_what_is_as_good_as_nothing_or_without_bound_is_said_so():
    assert (millimetres(5e-8), millimetres(2e27)) == ("below 0.0001 mm", "over 1 km")
    assert (percent(5e-5), percent(1e30)) == ("below 0.01 %", "over a million %")
    assert (velocity(0.0), velocity(6e28)) == ("below 0.0001 mm/s rms", "over 1 km/s rms")
    assert (seconds(1.7e18), seconds(3e-5)) == ("over a billion s", "below 0.0001 s")


@pytest.mark.parametrize(
    ("count", "before", "said"),
    [
        (1, None, "once"),
        (3, 3, "3 times"),
        (2, 3, "2 to 3 times"),
        (1, 0, "at most once"),
        (32, 32, "about 30 times"),
        (28, 34, "about 30 times"),
        (24, 26, "about 20 times"),
        (4, 32, "about 4 to 30 times"),
        (1234, None, "about 1200 times"),
    ],
)
def test_touches_are_counted_as_exactly_as_two_runs_agree(count, before, said):
    assert times(count, before) == said


def test_one_revolution_shows_and_several_show_too_little():
    assert show_too_little(1.0) == "1 revolution shows too little"
    assert show_too_little(1.5) == "1.5 revolutions show too little"
