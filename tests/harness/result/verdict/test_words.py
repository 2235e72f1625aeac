"""Numbers of a verdict in words: no exponent, and nothing more exact than it is known."""

from __future__ import annotations

import pytest

from autobalancer.harness.result.verdict.words import millimetres, percent, velocity


@pytest.mark.parametrize("exponent", range(-30, 31))
def test_no_size_is_written_with_an_exponent(exponent):
    said = [words(3.7 * 10.0**exponent) for words in (millimetres, percent, velocity)]
    assert not [text for text in said if "e+" in text or "e-" in text]


def test_what_is_as_good_as_nothing_or_without_bound_is_said_so():
    assert (millimetres(5e-8), millimetres(2e27)) == ("below 0.0001 mm", "over 1 km")
    assert (percent(5e-5), percent(1e30)) == ("below 0.01 %", "over a million %")
    assert (velocity(0.0), velocity(6e28)) == ("below 0.0001 mm/s rms", "over 1 km/s rms")
