"""Ticks of logarithmic axes; within two decades the library's own are few and hard to read."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axis import Axis
from matplotlib.ticker import LogFormatterSciNotation, LogLocator, NullFormatter

_STEPS = (1.0, 2.0, 3.0, 5.0, 7.0)  # of a decade
_FEW = 100.0  # from one end of the axis to the other: two decades
_PLAIN = (1e-4, 1e5)  # numbers between are written without a power of ten


def logarithmic(axis: Axis) -> None:
    """Have an axis drawn logarithmically: with 1, 2, 3, 5, 7 of few decades, or each of many."""
    axis.axes.set(**{f"{axis.axis_name}scale": "log"})  # type: ignore[attr-defined]
    axis.set_major_locator(_Places())
    axis.set_major_formatter(_Labels())
    axis.set_minor_formatter(NullFormatter())


def _are_few(low: float, high: float) -> bool:
    return max(low, high) < _FEW * min(low, high)


class _Places(LogLocator):
    def tick_values(self, vmin: float, vmax: float) -> Any:
        self.set_params(subs=_STEPS if _are_few(vmin, vmax) else (1.0,))
        return super().tick_values(vmin, vmax)  # evenly, where there is hardly a step between


class _Labels(LogFormatterSciNotation):
    def __call__(self, x: float, pos: int | None = None) -> str:
        low, high = self.axis.get_view_interval()  # type: ignore[union-attr]
        if not _are_few(low, high):
            return str(super().__call__(x, pos))
        if _PLAIN[0] <= x < _PLAIN[1]:
            return f"{x:.6g}"
        power = int(np.floor(np.log10(x) + 1e-9))
        return rf"${x / 10.0**power:.4g} \times 10^{{{power}}}$"
