"""The liquid of Dubovik 2006: masses, reaction, clearance, refusals."""

from __future__ import annotations

import math

import pytest

from autobalancer.models.liquid import Liquid

SIZES = {"chamber_radius": 0.05, "float_radius": 0.04, "height": 0.1, "density": 1000.0}


def test_mu_is_that_of_dubovik_10() -> None:
    liquid, m1 = Liquid(**SIZES), 2.0
    m2 = 1000.0 * math.pi * (0.05**2 - 0.04**2) * 0.1
    r = 0.05**2 / (0.05**2 - 0.04**2)
    assert liquid.liquid_mass == pytest.approx(m2, rel=1e-14)
    assert (m1 + liquid.added_mass) / m1 == pytest.approx(1 + r * m2 / m1, rel=1e-14)


def test_the_liquid_moves_as_if_it_filled_the_whole_chamber() -> None:
    thin, wide = Liquid(0.05, 0.0499999, 0.1, 1000.0), Liquid(0.05, 0.001, 0.1, 1000.0)
    full = 1000.0 * math.pi * 0.05**2 * 0.1
    assert thin.added_mass == pytest.approx(full, rel=1e-14)
    assert wide.added_mass == pytest.approx(full, rel=1e-14)
    assert thin.liquid_mass < 1e-5 * full


def test_a_gap_of_1e_12_of_the_radius_keeps_its_digits() -> None:
    gap = 2.0**-44
    liquid = Liquid(1.0, 1.0 - gap, 1.0, 1.0)
    assert liquid.gap == gap
    assert liquid.liquid_mass == pytest.approx(math.pi * gap * (2.0 - gap), rel=1e-15)


def test_clearance_is_used_up_when_the_bending_reaches_the_gap() -> None:
    liquid = Liquid(**SIZES)
    assert liquid.clearance(0.0) == pytest.approx(0.01)
    assert liquid.clearance(0.006 + 0.008j) == pytest.approx(0.0, abs=1e-16)
    assert liquid.clearance(0.02) < 0.0


@pytest.mark.parametrize("float_radius", [0.05, 0.06])
def test_a_float_that_does_not_fit_is_refused(float_radius: float) -> None:
    with pytest.raises(ValueError, match="smaller than chamber_radius"):
        Liquid(**{**SIZES, "float_radius": float_radius})
