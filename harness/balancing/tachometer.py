"""Raw samples with a tachometer channel: the part of a vibration that turns with the rotor.

A file has the columns `time_s`, `tacho` (one pulse a revolution) and one a sensor.  The rotor's
angle is 0 where the pulse rises through the middle of its range and grows evenly between pulses.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from ...models.arrays import Array
from ...models.linear.synchronous import synchronous
from ..errors import UserError
from ..input_files import read_csv

FEWEST = 3  # whole revolutions: fewer do not show that the speed is steady
_STEADY = 0.02  # of the speed, between the longest and the shortest revolution


def read_samples(path: Path) -> tuple[float, dict[str, complex]]:
    """Speed [rad/s], and the complex amplitude of every sensor: its value is Re(A e^{i angle}).

    Raises:
        UserError: the file cannot be read, holds no whole revolutions, or the speed is not steady.
    """
    names, rows = read_csv(path)
    sensors = [name for name in names if name not in ("time_s", "tacho")]
    if not {"time_s", "tacho"} <= set(names) or not sensors:
        raise UserError(f"{path}: needs the columns time_s, tacho and one a sensor")
    table = {name: np.array([row.number(name) for row in rows]) for name in names}
    if not all(np.isfinite(column).all() for column in table.values()):
        raise UserError(f"{path}: every sample must be a finite number")
    pulses = pulse_times(table["time_s"], table["tacho"])
    if len(pulses) <= FEWEST:
        raise UserError(
            f"{path}: the tachometer shows {max(0, len(pulses) - 1)} whole revolutions: needs "
            f"{FEWEST} or more"
        )
    turns = np.diff(pulses)
    if turns.max() > (1.0 + _STEADY) * turns.min():
        raise UserError(
            f"{path}: the speed is not steady: revolutions of {turns.min():.4g} to "
            f"{turns.max():.4g} s; must agree within {_STEADY:.0%}"
        )
    inside = (table["time_s"] >= pulses[0]) & (table["time_s"] < pulses[-1])
    angle = np.interp(table["time_s"][inside], pulses, 2.0 * math.pi * np.arange(len(pulses)))
    reading = synchronous(angle, np.array([table[name][inside] for name in sensors]))
    speed = 2.0 * math.pi / float(turns.mean())
    return speed, dict(zip(sensors, reading.amplitude.tolist(), strict=True))


def pulse_times(time: Array, tacho: Array) -> Array:
    """When the channel rises through the middle of its range, between samples by a line [s]."""
    high = tacho - 0.5 * (tacho.min() + tacho.max())
    at = np.flatnonzero((high[:-1] < 0.0) & (high[1:] >= 0.0))
    share = -high[at] / (high[at + 1] - high[at])
    return time[at] + share * (time[at + 1] - time[at])
