"""Real signals as the coupling keeps them: pairs of one order, as real and imaginary part of a row.

The schemes, the loop and the control of errors know rows; what is two by two in a rotor's plane is
two by two here for their sake alone.  A signal whose unit gives its derivative is a cubic over a
step; of any other the values are joined by lines.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..signals import Cubics, Knots, Signals, end_of, interpolated

Reals = NDArray[np.float64]  # (m, 4) cubics or (m, 2) knots


class Rows:
    """Which signal is which part of which row.

    Args:
        orders: of every signal: 0 held, 1 linear, 3 cubic.

    Attributes:
        count: of rows; `orders` of every row.
        places: of every signal among the parts of all rows.
    """

    def __init__(self, orders: Sequence[int]) -> None:
        self.signals = len(orders)
        self.places = np.zeros(len(orders), int)
        row_orders: list[int] = []
        for order in sorted(set(orders), reverse=True):
            own = [k for k, each in enumerate(orders) if each == order]
            for place, k in enumerate(own):
                self.places[k] = 2 * len(row_orders) + place
            row_orders += [order] * ((len(own) + 1) // 2)
        self.count, self.orders = len(row_orders), np.array(row_orders, int)

    def reals(self, rows: NDArray[np.complex128]) -> Reals:
        """(m, k) of the signals, from complex (rows, k)."""
        parts = np.stack([rows.real, rows.imag], axis=1).reshape(2 * len(rows), rows.shape[1])
        return np.asarray(parts[self.places])

    def rows(self, reals: Reals) -> NDArray[np.complex128]:
        """Complex (rows, k) from (m, k) of the signals."""
        parts = np.zeros((2 * self.count, reals.shape[1]))
        parts[self.places] = reals
        return np.asarray(parts[0::2] + 1j * parts[1::2])

    def each(self, values: Reals, padding: float = 0.0) -> Reals:
        """(2 * rows,) of the parts of all rows, from (m,) of the signals."""
        parts = np.full(2 * self.count, padding)
        parts[self.places] = values
        return parts


class MixedSignals(Signals):
    """Signals of different orders; the order that is asked for is the highest of any."""

    def __init__(self, rows: Rows) -> None:
        super().__init__(rows.count)
        self._orders = rows.orders
        self._slopes = (rows.orders == 3).astype(float)

    def predicted(self, order: int) -> Cubics:
        """What they would do over the next step; one without derivative goes on in a line."""
        cubics = super().predicted(order)
        for low in (0, 1):
            cubics[self._orders == low, low + 1 :] = 0.0
        return cubics

    def to(self, ends: Knots, step: float, order: int = 3) -> Cubics:
        """What they do on their way to these ends after a step [s]."""
        cubics = interpolated(self.now, ends, step, order)
        for low in (0, 1):
            if order > low and (which := self._orders == low).any():
                cubics[which] = interpolated(self.now[which], ends[which], step, low)
        return cubics

    def ends(self, cubics: Cubics, step: float) -> Knots:
        """Their ends; no slope of those whose units do not give it."""
        found = end_of(cubics, step)
        found[:, 1] *= self._slopes
        return found
