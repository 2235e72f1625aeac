"""Runs of many starts in C, seen in windows at their ends."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ...models.arrays import Array
from ..master.names import displacements, weight
from ..result.sag import sag_of
from .kinds import WINDOWS, Seen
from .starts import Job, holders

if TYPE_CHECKING:
    from numpy.typing import NDArray

_PER_TURN = 16  # points of a revolution
_CHUNK = 8  # runs at a time: some MB
_WINDOW = 0.06  # of the time at the speed that a window takes
_FEWEST = 6.0  # revolutions of a window


def squared_distances(job: Job) -> tuple[Array, list[str]]:
    """Largest squared distance of a station (r, t) at evenly spread times [m^2]; failures.

    It is counted from the sag, as a vibration is.
    """
    from ...fmus.composite.batch import BatchRuns
    from ..master.one_file import composition

    rotor = displacements(len(job.scene.rotor.points))
    motor = ["motor.speed"] if job.scene.operation.motor else []
    points = math.ceil(_turns(job) * _PER_TURN)
    runs = BatchRuns(composition(job.scene), list(job.columns), [*rotor, *motor], points)
    signals, reasons = runs(job.values, np.full(len(job.values), job.seconds))
    _subtract_sag(job, signals, rotor, bool(motor))
    return _squares(signals[:, :, : len(rotor)]), reasons


def run(job: Job) -> tuple[Seen, NDArray[np.object_], Array]:
    """All runs of a job in windows.

    Returns:
        Windows; why a run has failed, else empty; largest distance of each run [m].
    """
    from ...fmus.composite.batch import BatchRuns  # compiles where it has to
    from ..master.one_file import composition

    scene = job.scene
    rotor = displacements(len(scene.rotor.points))
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
        _subtract_sag(job, signals, rotor, bool(motor))
        squares = _squares(signals[:, :, : len(rotor)])
        parts.append(_windows(signals, squares, job, len(rotor), bool(motor)))
        largest.append(np.sqrt(squares.max(axis=1)))
        reasons += failed
    arrays = [np.concatenate(each) for each in zip(*(a for a, _ in parts), strict=True)]
    seen = Seen(arrays[0], arrays[1], arrays[2], arrays[3], parts[0][1])
    return seen, np.array(reasons, object), np.concatenate(largest)


def _subtract_sag(job: Job, signals: Array, rotor: Sequence[str], motor: bool) -> None:
    """From the displacements, the first of the signals (r, t, s), in place."""
    if not job.scene.operation.gravity:
        return
    time = np.linspace(0.0, job.seconds, signals.shape[1])
    of_all = None if motor else sag_of(job.scene, time)
    for one in signals:
        sag = of_all or sag_of(job.scene, time, one[:, -1])
        for place, name in enumerate(rotor):
            one[:, place] -= sag[name]


def _turns(job: Job) -> float:
    """Revolutions of a run; where its speed is lower, points lie closer."""
    return job.seconds * job.speed / math.tau


def _squares(displacements: Array) -> Array:
    """Largest squared distance of a station (r, t), of x and y of all (r, t, 2 s)."""
    x, y = (np.moveaxis(displacements[:, :, axis::2], 2, 0) for axis in (0, 1))
    found = x[0] ** 2 + y[0] ** 2
    for station in range(1, len(x)):
        np.maximum(found, x[station] ** 2 + y[station] ** 2, out=found)
    return found


def _windows(
    signals: Array, squares: Array, job: Job, rotor: int, motor: bool
) -> tuple[tuple[Array, ...], float]:
    count, points = len(signals), signals.shape[1] - 1
    step = job.seconds / points
    turn = math.tau / job.speed
    size = max(_FEWEST * turn, job.window or _WINDOW * job.settled) / step
    size = min(int(size), points // WINDOWS)
    late = signals[:, -(WINDOWS * size) - 1 :]
    if job.scene.operation.gravity:  # the vibration is about the sag
        squares = _squares(late[:, :, :rotor] - late[:, :, :rotor].mean(axis=1, keepdims=True))
    of_windows = squares[:, -(WINDOWS * size) :].reshape(count, WINDOWS, size)
    vibration = np.sqrt(of_windows.max(axis=2))
    weights = signals.shape[2] - rotor - motor
    # times last: as they lie in memory, the smallest and the largest are found many times as fast
    angles = np.moveaxis(late[:, :, rotor : rotor + weights], 2, 1).copy()
    ends = angles[:, :, ::size]
    rate = np.diff(ends, axis=2) / (size * step)
    apart = angles[:, :, :-1].reshape(count, weights, WINDOWS, size) - ends[:, :, :-1, None]
    apart -= rate[..., None] * (np.arange(size) * step)
    swing = np.ptp(apart, axis=3)
    speed = np.full((count, WINDOWS), job.speed)
    if motor:
        speed = late[:, 1:, -1].reshape(count, WINDOWS, size).mean(axis=2)
    return (speed, vibration, -_by_window(rate), _by_window(swing)), size * step


def _by_window(values: Array) -> Array:
    """Of weights and windows (r, k, j) as (r, j, k)."""
    return np.ascontiguousarray(np.moveaxis(values, 1, 2))
