"""Rows of a check: what is expected, what was measured, how far they may part, the time it took."""

from __future__ import annotations

import time
from dataclasses import dataclass

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
    begun: float = 0.0

    def __post_init__(self) -> None:
        self.begun = time.perf_counter()

    def number(
        self,
        quantity: str,
        expected: float,
        measured: float,
        tolerance: float,
        source: str,
        scale: float | None = None,
    ) -> Row:
        """Two numbers, by the rule of `worst`."""
        return self.worst(quantity, [expected], [measured], tolerance, source, scale)

    def worst(
        self,
        quantity: str,
        expected: ArrayLike,
        measured: ArrayLike,
        tolerance: float,
        source: str,
        scale: ArrayLike | None = None,
    ) -> Row:
        """The point of a curve where measured and expected differ most.

        Holds if |measured - expected| <= tolerance * scale there; NaN differs most and never holds.

        Args:
            expected, measured: (k,) values.
            scale: (k,) or one number; by default |expected|, and 1 where nothing is expected.
        """
        expected, measured = np.asarray(expected, float), np.asarray(measured, float)
        size = np.abs(expected) if scale is None else np.asarray(scale, float)
        with np.errstate(invalid="ignore"):  # infinity less infinity is NaN, which does not hold
            errors = np.abs(measured - expected) / np.where(size > 0.0, size, 1.0)
        worst = int(np.argmax(np.where(np.isnan(errors), np.inf, errors)))
        error = float(errors[worst])
        return self._row(
            quantity,
            float(expected[worst]),
            float(measured[worst]),
            error <= tolerance,
            source,
            error,
            tolerance,
        )

    def statement(
        self, quantity: str, expected: str, measured: str, holds: bool, source: str
    ) -> Row:
        """A finding in words."""
        return self._row(quantity, expected, measured, holds, source)

    def _row(
        self,
        quantity: str,
        expected: Value,
        measured: Value,
        holds: bool,
        source: str,
        error: float | None = None,
        tolerance: float | None = None,
    ) -> Row:
        now = time.perf_counter()
        seconds, self.begun = now - self.begun, now
        return Row(
            self.scene,
            self.check,
            quantity,
            expected,
            measured,
            error,
            tolerance,
            bool(holds),
            seconds,
            source,
        )
