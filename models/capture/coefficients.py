"""Matrices of a rotor at many speeds."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..rotor import LinearRotor


class Coefficients:
    """Velocity and displacement matrices over the speed; complex or real as those of the rotor.

    Gyroscopic and internal damping are linear in the speed.  Bearings with a table and waves of a
    ring are not: their matrices are those of each speed, beyond a table of its end.

    Args:
        rotor: n stations.

    Attributes:
        mass: (m, m), m = n, or 2n where the axes are not alike.
        follow_speed: whether they change with it.
        lowest, highest: speeds that the tables hold [rad/s].
    """

    def __init__(self, rotor: LinearRotor) -> None:
        self._rotor, self._is_linear = rotor, not (rotor.varies or rotor.waves)
        turns = rotor.gyroscopic.any() or rotor.internal_damping.any()
        self.follow_speed = bool(turns or not self._is_linear)
        self.lowest, self.highest = rotor.table_speeds
        self._known: dict[float, tuple[NDArray[Any], NDArray[Any]]] = {}
        self.mass: NDArray[Any] = rotor.coefficients(self.lowest)[0]
        if self._is_linear:
            self._start = self._one(0.0)
            self._rise = tuple(b - a for a, b in zip(self._start, self._one(1.0), strict=True))

    def at(self, speeds: Array) -> tuple[NDArray[Any], NDArray[Any]]:
        """Velocity and displacement matrices (b, m, m) at speeds (b,)."""
        if not self.follow_speed:
            return self._start[0][None], self._start[1][None]
        if self._is_linear:
            om = speeds[:, None, None]
            damping, stiffness = (a + om * b for a, b in zip(self._start, self._rise, strict=True))
            return damping, stiffness
        each, place = np.unique(speeds, return_inverse=True)
        found = [self._one(float(speed)) for speed in each]
        return np.array([c for c, _ in found])[place], np.array([k for _, k in found])[place]

    def _one(self, speed: float) -> tuple[NDArray[Any], NDArray[Any]]:
        if speed not in self._known:
            held = min(max(speed, self.lowest), self.highest)
            self._known[speed] = self._rotor.coefficients(held)[1:]
        return self._known[speed]
