"""Signals that were recorded on a plateau."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ....models.arrays import Array
from ...master.names import along_axes, weight
from ...scene import Scene
from ...scene.balancer import WeightBalancer

Mask = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Record:
    """Recorded signals on a plateau, since the last change of speed or unbalance.

    Attributes:
        scene: that was run.
        time: (T,) [s].
        angle: of the rotor (T,) [rad].
        speed: of the rotor, its mean on the plateau [rad/s].
        signals: (T,) each, by name, displacements from the sag.
        natural: natural frequencies that the motion may hold [rad/s].
    """

    scene: Scene
    time: Array
    angle: Array
    speed: float
    signals: Mapping[str, Array]
    natural: Sequence[float] = ()

    @property
    def revolutions(self) -> float:
        """Turned since the last change."""
        return float(self.angle[-1] - self.angle[0]) / math.tau if len(self.angle) > 1 else 0.0

    @property
    def seconds(self) -> float:
        """Time since the last change [s]."""
        return float(self.time[-1] - self.time[0])

    @cached_property
    def displacement(self) -> Array:
        """x, then y, of all stations (T, 2 n) [m]."""
        x, y = along_axes(len(self.scene.rotor.points))
        return np.stack([self.signals[name] for name in (*x, *y)], axis=1)

    def since(self, revolutions: float) -> Mask:
        """Which points lie in the last revolutions (T,)."""
        return self.angle >= self.angle[-1] - math.tau * revolutions * (1.0 + 1e-9)

    @cached_property
    def weights(self) -> Array | None:
        """Angles of all weights in the rotor (T, K) [rad]; None where they were not recorded."""
        names = list(weight_angles(self.scene))
        if any(name not in self.signals for name in names):
            return None
        rows = [self.signals[name] for name in names]
        return np.stack(rows, axis=1) if rows else np.zeros((len(self.time), 0))


def weight_angles(scene: Scene) -> Iterator[str]:
    """Signals of all weights' angles, in their order."""
    for one in scene.balancer:
        if isinstance(one, WeightBalancer):
            for k in range(1, one.count + 1):
                yield f"{one.label}.{weight(k, 'angle')}"
