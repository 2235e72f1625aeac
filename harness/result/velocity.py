"""Vibration velocity as a signal, rms over the last revolution: ISO 20816 rates machines by it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from ...models.arrays import Array
from ..master.names import stations
from ..scene import Scene

VELOCITY = "velocity_rms"


def velocities(scene: Scene) -> list[str]:
    """The signals of all stations [m/s]."""
    return [f"rotor.{prefix}{VELOCITY}" for prefix in stations(len(scene.rotor.points))]


def recorded_for(names: Sequence[str]) -> tuple[list[str], list[str]]:
    """Signals of units that are asked for, and others that velocities are made of."""
    own = [name for name in names if not name.endswith(f".{VELOCITY}")]
    made_of = [f"{n.removesuffix(VELOCITY)}v{axis}" for n in names if n not in own for axis in "xy"]
    return own, [name for name in made_of if name not in own]


def with_velocities(
    scene: Scene, names: Sequence[str], time: Array, signals: Mapping[str, Array]
) -> dict[str, Array]:
    """Signals by these names, velocities among them, from what `recorded_for` names."""
    if all(name in signals for name in names):
        return {name: signals[name] for name in names}
    turned = revolutions_at(scene, time)
    return {
        name: signals[name]
        if name in signals
        else np.maximum(
            *(_rms(time, turned, signals[f"{name.removesuffix(VELOCITY)}v{axis}"]) for axis in "xy")
        )
        for name in names
    }


def revolutions_at(scene: Scene, time: Array) -> Array:
    """Revolutions turned at each time; with a motor those of its no-load speed."""
    return scene.profile().angles_at(time) / math.tau


def _rms(time: Array, turned: Array, velocity: Array) -> Array:
    """Root of the mean square over the revolution before each time, or since the start."""
    square, step = velocity**2, np.diff(time)
    sums = np.append(0.0, np.cumsum(0.5 * step * (square[1:] + square[:-1])))
    begin = np.interp(np.maximum(turned - 1.0, turned[0]), turned, time)
    # between points the integral is a cubic: its slope, the square, is known
    k = np.clip(np.searchsorted(time, begin, side="right") - 1, 0, max(0, len(step) - 1))
    h = np.maximum(step[k], np.finfo(float).tiny)
    s, rise = (begin - time[k]) / h, (sums[k + 1] - sums[k]) / h
    f, g = square[k], square[k + 1]
    before = sums[k] + h * s * (f + s * (3.0 * rise - 2.0 * f - g + s * (f + g - 2.0 * rise)))
    span = time - begin
    mean = np.divide(sums - before, span, out=square.copy(), where=span > 0.0)
    return np.sqrt(np.maximum(mean, 0.0))
