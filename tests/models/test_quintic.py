"""Quintics over a step."""

from __future__ import annotations

from numpy.testing import assert_allclose
from scipy.interpolate import BPoly

from autobalancer.models import quintic


def test_quintic_is_that_of_scipy_through_the_same_ends() -> None:
    step, start, end = 0.7, (1.0, -2.0, 3.0), (0.5, 4.0, -1.0)
    expected = BPoly.from_derivatives([0.0, step], [start, end])
    found = (*start, *quintic.hermite(start, end, step))
    for t in (0.0, 0.1, 0.5, step):
        values = [float(expected.derivative(k)(t)) if k else float(expected(t)) for k in range(3)]
        assert_allclose(quintic.at(found, t), values, rtol=1e-12, atol=1e-12)
