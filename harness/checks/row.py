"""Rows of a check: what is expected, what was measured, how far they may part, the time it took."""

from __future__ import annotations

import time
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

Value = float | str


@dataclass(frozen=True)
class Row:
    """One comparison.

    Attributes:
        scene, check, quantity: what was compared.
        expected, measured: numbers in the quantity's unit, or words where there is no number.
        error, tolerance: relative unless the quantity says otherwise; None where words compare.
        holds: whether the row is as expected.
        seconds: time the measurement took.
        source: paper and equation of the expected value.
    """

    scene: str
    check: str
    quantity: str
    expected: Value
    measured: Value
    error: float | None
    tolerance: float | None
    holds: bool
    seconds: float
    source: str


@dataclass
class Rows:
    """Makes the rows of one check; the clock starts anew with every row."""

    scene: str
    check: str
    start_time: float = field(default_factory=time.perf_counter)

    def number(
        self,
        quantity: str,
        expected: ArrayLike,
        measured: ArrayLike,
        tolerance: float,
        source: str,
        scale: ArrayLike | None = None,
    ) -> Row:
        """Two numbers, or the point of a curve where measured and expected differ most.

        Holds if |measured - expected| <= tolerance * scale there; NaN differs most and never holds.

        Args:
            expected, measured: one number each, or (k,) values.
            scale: (k,) or one number; by default |expected|, and 1 where nothing is expected.
        """
        expected, measured = np.atleast_1d(expected).astype(float), np.atleast_1d(measured)
        size = np.abs(expected) if scale is None else np.asarray(scale, float)
        with np.errstate(invalid="ignore"):  # infinity less infinity is NaN, which does not hold
            errors = np.abs(measured - expected) / np.where(size > 0.0, size, 1.0)
        worst = int(np.argmax(np.where(np.isnan(errors), np.inf, errors)))
        error, numbers = float(errors[worst]), (float(expected[worst]), float(measured[worst]))
        return self.statement(quantity, *numbers, error <= tolerance, source, error, tolerance)

    def statement(
        self,
        quantity: str,
        expected: Value,
        measured: Value,
        holds: bool,
        source: str,
        error: float | None = None,
        tolerance: float | None = None,
    ) -> Row:
        """A finding whose verdict is known, mostly one in words."""
        now = time.perf_counter()
        seconds, self.start_time = now - self.start_time, now
        verdict = (error, tolerance, bool(holds), seconds, source)
        return Row(self.scene, self.check, quantity, expected, measured, *verdict)
