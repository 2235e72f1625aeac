"""Vibration while the speed rises or falls, by records as of a rig: run-ups and run-downs in C."""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import SimulationError, UserError
from ..scene import Scene
from .alike import table_of
from .names import stations
from .one_file import composition

SAMPLES_PER_RECORD = 200  # some at every phase of the few revolutions that a record holds


@dataclass(frozen=True, eq=False)
class Sweeps:
    """Records of run-ups of scenes that differ in numbers.

    Attributes:
        speeds: (m,) in the middle of every record [rad/s].
        amplitude: (runs, m, stations) largest sqrt(x^2 + y^2) of the record [m].
    """

    speeds: NDArray[np.float64]
    amplitude: NDArray[np.float64]


def sweep_alike(scenes: Sequence[Scene], record: float) -> Sweeps:
    """Run the rise (or fall) of speed of scenes, as `cosimulate_alike` takes them, in C.

    Args:
        record: length of a record [s]; what is left of the rise after the last whole one is not
            looked at.

    Raises:
        UserError: as `cosimulate_alike`; the rise is shorter than a record.
        SimulationError: a run has failed.
    """
    from ...fmus.composite.batch import BatchRuns  # compiles where it has to

    first = scenes[0]
    profile, table = first.profile(), table_of(scenes)
    count = int(profile.seconds / record * (1.0 + 1e-9))
    if not count:
        raise UserError(f"{first.name}: operation.run_up.seconds: must be {record:g} s or more")
    asked = [
        f"rotor.{prefix}{axis}" for prefix in stations(len(first.rotor.stations)) for axis in "xy"
    ]
    runs = BatchRuns(composition(first), list(table), asked, count * SAMPLES_PER_RECORD)
    ends = np.array([count * record])

    def amplitude(values: NDArray[np.float64]) -> NDArray[np.float64]:
        signals, (reason,) = runs(values[None], ends)
        if reason:
            raise SimulationError(f"{first.name}: {reason}")
        pairs = signals[0, 1:].reshape(count, SAMPLES_PER_RECORD, -1, 2)
        return np.hypot(pairs[..., 0], pairs[..., 1]).max(axis=1)

    with ThreadPoolExecutor(os.cpu_count()) as executor:
        found = list(executor.map(amplitude, np.array(list(table.values())).T))
    middles = record * (np.arange(count) + 0.5)
    return Sweeps(np.array([profile.speed(t) for t in middles.tolist()]), np.array(found))
