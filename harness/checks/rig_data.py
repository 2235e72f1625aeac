"""The rig of Rodrigues et al. 2010: what was measured, and the same quantities co-simulated.

Speeds in rpm, amplitudes in mm: the mean over both bearings of the largest sqrt(x^2 + y^2), 0-peak.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...models.arrays import Array
from ..errors import SimulationError
from ..master.names import displacements, station_residuals
from ..result.many import cosimulate_many
from ..result.run import cosimulate
from ..result.sag import complex_motion
from ..scene import Scene
from ..scene.balancer import WeightBalancer
from ..units import RPM

Curve = tuple[Array, Array]  # speeds that rise, amplitudes

SOURCE = "run as one composite, against Rodrigues, Champneys, Friswell, Wilson 2010"
WASHER = 12.4e-6  # kg m
SETTLING = 200  # revolutions: the rotor alone, to 0.1 % at 5000 rpm
RATE, RECORD = 25.0, 0.25  # rpm/s of the measured sweeps, s
WINDOW = 50.0  # rpm either side of a speed: what was measured there is the median
_DATA = Path(__file__).parent / "data" / "rodrigues2010"


@cache
def measured(name: str) -> NDArray[Any]:
    """A table of the rig's data, by its columns."""
    return np.genfromtxt(_DATA / f"{name}.csv", delimiter=",", names=True)


def chosen(name: str, **values: float) -> NDArray[Any]:
    """Rows of a table in which columns have these values."""
    table = measured(name)
    return table[np.all([table[key] == value for key, value in values.items()], axis=0)]


def response(washers: float, balls: int, **values: float) -> Curve:
    """Measured amplitude against speed, both ways together unless `falling` is given."""
    rows = np.sort(
        chosen("response", washers=washers, balls=balls, **values), order="speed_rpm", kind="stable"
    )
    return rows["speed_rpm"], rows["amplitude_mm"]


def at(curve: Curve, speeds: Iterable[float], window: float = WINDOW) -> Array:
    """Medians of a curve around speeds."""
    x, y = curve
    return np.array([np.median(y[np.abs(x - speed) <= window]) for speed in speeds])


def with_washers(scene: Scene, washers: float) -> Scene:
    """The rig's scene with another unbalance."""
    return scene.replace({"rotor.unbalances[1].amount": washers * WASHER})


def bearings(
    scene: Scene, washers: float, speeds: Sequence[float] | Array, revolutions: float = SETTLING
) -> Array:
    """Amplitudes (k, 2) of both bearings at constant speeds, co-simulated as a composite.

    Raises:
        SimulationError: a run has failed.
    """
    names = station_residuals(len(scene.rotor.points))
    names = [names[number - 1] for number in scene.rotor.supports]
    scene = with_washers(scene, washers).replace({"run.revolutions": revolutions})
    found = cosimulate_many(scene, {"speed": RPM * np.asarray(speeds, float)}, results=names)
    for reason in filter(None, found["failure"]):
        raise SimulationError(f"{scene.label}: {reason}")
    return 1e3 * np.column_stack([found[name] for name in names])


def steady(
    scene: Scene, washers: float, speeds: Sequence[float] | Array, revolutions: float = SETTLING
) -> Array:
    """Amplitude (k,) at constant speeds, co-simulated."""
    return bearings(scene, washers, speeds, revolutions).mean(axis=1)


def swept(
    scene: Scene, washers: Sequence[float], low: float, high: float, falling: bool
) -> dict[float, Curve]:
    """Co-simulated sweeps between two speeds at the rig's rate, by number of washers.

    Balls start where the scene has them; on the way down balanced, as far as they can.
    """
    start, end = (high, low) if falling else (low, high)
    profile = [[0.0, start * RPM], [(high - low) / RATE, end * RPM]]
    curves = {}
    for number in washers:
        one = with_washers(scene, number).replace({"operation.profile": profile})
        if falling and scene.balancer:
            half = _balanced_half_angle(one, number)
            one = one.replace({"balls.angles": [math.pi - half, math.pi + half]})
        curves[number] = _recorded(one.replace({"run.revolutions": None}))
    return curves


def _recorded(scene: Scene) -> Curve:
    """Run a scene along its profile, and take records of it as the rig did."""
    count, supports = len(scene.rotor.points), np.array(scene.rotor.supports) - 1
    run = cosimulate(scene, record=displacements(count))
    sizes = np.abs(complex_motion(run.signals, count)[supports])
    begins = RECORD * np.arange(int(run.time[-1] / RECORD * (1.0 + 1e-9)))
    amplitude = np.maximum.reduceat(sizes, np.searchsorted(run.time, begins), axis=1).mean(axis=0)
    speeds = scene.profile().speeds_at(begins + RECORD / 2.0)
    order = np.argsort(speeds)
    return speeds[order] / RPM, 1e3 * amplitude[order]


def _balanced_half_angle(scene: Scene, washers: float) -> float:
    """Of two balls about the light spot: 2 m R cos(half) is the washers' unbalance."""
    (balls,) = scene.balancer
    assert isinstance(balls, WeightBalancer)  # the check has set its drag
    balanced = math.acos(min(1.0, washers * WASHER / (balls.count * balls.device.moment)))
    return max(balanced, 1.01 * balls.half_angle)
