"""Rows of the rig's check that compare sweeps through the resonances, up and down."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ..scene import Scene
from .rig_data import SOURCE, Curve, at, response, swept
from .row import Row, Rows

FITTED_DRAG = {"balls.drag": 3.75e-2}  # N s/m, from the hysteresis of the sweeps of 1 and 3 washers
SWEPT = (1200.0, 2700.0)  # rpm: all four resonances
RISING = (1200.0, 1700.0)  # rpm: on the way up balance is gained by then, or too late for a row
FIRST = (1300.0, 1560.0)  # rpm: the first of them
PEAK, HELPING = 0.15, 0.05  # of its amplitude, of the speeds between which balls help
GRID = np.arange(1220.0, 2661.0, 20.0)  # rpm, on which sweeps with and without balls are compared
IN_A_ROW = 3  # of them: better for so long is no chance
LEFT_OUT = 2  # washers: on their way down the rig itself repeats to a fifth


def sweep_rows(scene: Scene, rows: Rows, falling: bool) -> Iterator[Row]:
    """The first resonance with balls, and the speed at which balance is gained or lost."""
    scene = scene.replace(FITTED_DRAG)
    way, ends = ("down", SWEPT) if falling else ("up", RISING)
    washers = [number for number in range(5) if not (falling and number == LEFT_OUT)]
    ours = swept(scene, washers, *ends, falling)
    plain = swept(scene.without_balancers(), (3, 4), *ends, falling)
    for number, curve in ours.items():
        rig = response(number, 2, falling=falling, run=1)
        label = f"first resonance with balls on the way {way}, washers: {number} [mm]"
        source = f"{SOURCE}; drag fitted to these rows"
        yield rows.number(label, first_peak(rig), first_peak(curve), PEAK, source)
    speed_of, name = (lost, "lost") if falling else (gained, "gained")
    for number in plain:
        expected = speed_of(*(response(number, balls, falling=falling) for balls in (2, 0)))
        label = f"speed at which balance is {name}, {number} washers [rpm]"
        yield rows.number(label, expected, speed_of(ours[number], plain[number]), HELPING, SOURCE)


def first_peak(curve: Curve) -> float:
    speeds, amplitude = curve
    return float(amplitude[(speeds > FIRST[0]) & (speeds < FIRST[1])].max())


def _better(balls: Curve, plain: Curve) -> NDArray[np.bool_]:
    """Where on `GRID`, up to the curves' end, the rig vibrates less with balls than without."""
    grid = GRID[balls[0].max() > GRID]
    return at(balls, grid, 20.0) < at(plain, grid, 20.0)


def gained(balls: Curve, plain: Curve) -> float:
    """Lowest speed from which balls help, a while at least; NaN: none."""
    lasting = np.lib.stride_tricks.sliding_window_view(_better(balls, plain), IN_A_ROW).all(axis=1)
    return GRID[np.argmax(lasting)] if lasting.any() else math.nan


def lost(balls: Curve, plain: Curve) -> float:
    """Highest speed at which balls do not help; NaN: none."""
    worse = GRID[~_better(balls, plain)]
    return worse[-1] if len(worse) else math.nan
