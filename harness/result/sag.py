"""The sag under gravity: signals hold it, pictures and tables show the displacement from it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...models.arrays import Array, Complex
from ..master.names import along_axes
from ..scene import Scene

FROM_SAG = "displacement from the sag"
_GRID = 129  # speeds at which the sag is solved for; between them lines


def sag_of(scene: Scene, time: Array, speed: Array | None = None) -> dict[str, Array]:
    """Displacements at rest under gravity, by the signals' names, each (T,) [m].

    Internal damping, which turns with the shaft, draws the sag aside in proportion to the speed.

    Args:
        speed: of a motor (T,) [rad/s]; by default the scene's own, of a motor that at its start.

    Returns:
        `rotor.x`, `rotor.y` or those of all stations; empty without gravity.
    """
    if not scene.operation.gravity:
        return {}
    rotor = scene.assembly().resting_rotor  # waves of liquid move no sag
    if not (rotor.varies or rotor.internal_damping.any()):
        speed = np.zeros_like(time)
    elif speed is None and scene.operation.motor:
        speed = np.full_like(time, scene.operation.start_speed)
    elif speed is None:
        speed = scene.profile().speeds_at(time)
    low, high = float(speed.min()), float(speed.max())
    grid = np.linspace(low, high, _GRID) if high > low else np.array([low])
    solved = np.array([rotor.rest_position(w) for w in grid])  # (g, 2, n)
    return {
        name: np.interp(speed, grid, solved[:, k, j])
        for k, names in enumerate(along_axes(rotor.stations))
        for j, name in enumerate(names)
    }


def complex_motion(signals: Mapping[str, Array], count: int) -> Complex:
    """x + i y of each of so many stations (n, T) [m]."""
    x, y = along_axes(count)
    return np.array([signals[a] + 1j * signals[b] for a, b in zip(x, y, strict=True)])


def from_sag(signals: Mapping[str, Array], sag: Mapping[str, Array]) -> dict[str, Array]:
    """Signals less the sag of those that have one."""
    return {name: values - sag[name] if name in sag else values for name, values in signals.items()}
