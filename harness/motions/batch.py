"""Runs of many starts in C, seen in windows at their ends."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ...models.arrays import Array
from ..master.names import stations, weight
from .kinds import WINDOWS, Seen
from .starts import Job, holders

if TYPE_CHECKING:
    from numpy.typing import NDArray

_PER_TURN = 16  # points of a revolution
_CHUNK = 8  # runs at a time: some MB
_WINDOW = 0.06  # of the time at the speed that a window takes
_FEWEST = 6.0  # revolutions of a window


def displacements(job: Job) -> tuple[Array, list[str]]:
    """Largest squared distance of a station (r, t) at evenly spread times [m^2]; failures."""
    from ...fmus.composite.batch import BatchRuns
    from ..master.one_file import composition

    names = [f"rotor.{p}{axis}" for p in stations(len(job.scene.rotor.points)) for axis in "xy"]
    points = math.ceil(_turns(job) * _PER_TURN)
    runs = BatchRuns(composition(job.scene), list(job.columns), names, points)
    signals, reasons = runs(job.values, np.full(len(job.values), job.seconds))
    return _squares(signals), reasons


def run(job: Job) -> tuple[Seen, NDArray[np.object_], Array]:
    """All runs of a job in windows.

    Returns:
        Windows; why a run has failed, else empty; largest distance of each run [m].
    """
    from ...fmus.composite.batch import BatchRuns  # compiles where it has to
    from ..master.one_file import composition

    scene = job.scene
    rotor = [f"rotor.{p}{axis}" for p in stations(len(scene.rotor.points)) for axis in "xy"]
    angles = [
        f"{b.label}.{weight(k, 'angle')}" for b in holders(scene) for k in range(1, b.count + 1)
    ]
    motor = ["motor.speed"] if scene.operation.motor else []
    points = math.ceil(_turns(job) * _PER_TURN)
    runs = BatchRuns(composition(scene), list(job.columns), [*rotor, *angles, *motor], points)
    ends = np.full(len(job.values), job.seconds)
    parts, reasons, largest = [], [], []
    for first in range(0, len(ends), _CHUNK):
        part = slice(first, first + _CHUNK)
        signals, failed = runs(job.values[part], ends[part])
        parts.append(_windows(signals, job, len(rotor), bool(motor)))
        largest.append(np.sqrt(_squares(signals[:, :, : len(rotor)]).max(axis=1)))
        reasons += failed
    arrays = [np.concatenate(each) for each in zip(*(a for a, _ in parts), strict=True)]
    seen = Seen(arrays[0], arrays[1], arrays[2], arrays[3], parts[0][1])
    return seen, np.array(reasons, object), np.concatenate(largest)


def _turns(job: Job) -> float:
    """Revolutions of a run; where its speed is lower, points lie closer."""
    return job.seconds * job.speed / math.tau


def _squares(displacements: Array) -> Array:
    """Largest squared distance of a station (r, t), of x and y of all (r, t, 2 s)."""
    pairs = displacements.reshape(*displacements.shape[:2], -1, 2)
    return np.asarray((pairs**2).sum(axis=3).max(axis=2))


def _windows(signals: Array, job: Job, rotor: int, motor: bool) -> tuple[tuple[Array, ...], float]:
    count, points = len(signals), signals.shape[1] - 1
    step = job.seconds / points
    turn = math.tau / job.speed
    size = max(_FEWEST * turn, job.window or _WINDOW * job.settled) / step
    size = min(int(size), points // WINDOWS)
    late = signals[:, -(WINDOWS * size) - 1 :]
    heavy = bool(job.scene.operation.gravity)
    shown = late[:, :, :rotor] - (late[:, :, :rotor].mean(axis=1, keepdims=True) if heavy else 0.0)
    squares = _squares(shown)[:, 1:].reshape(count, WINDOWS, size)
    vibration = np.sqrt(squares.max(axis=2))
    weights = signals.shape[2] - rotor - motor
    angles = late[:, :, rotor : rotor + weights]
    ends = angles[:, ::size]
    rate = np.diff(ends, axis=1) / (size * step)
    steady = np.arange(size) * step
    inside = angles[:, :-1].reshape(count, WINDOWS, size, weights)
    apart = inside - ends[:, :-1, None] - rate[:, :, None] * steady[:, None]
    speed = np.full((count, WINDOWS), job.speed)
    if motor:
        speed = late[:, 1:, -1].reshape(count, WINDOWS, size).mean(axis=2)
    return (speed, vibration, -rate, np.ptp(apart, axis=2)), size * step
