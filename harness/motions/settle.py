"""Runs of a start, each looked at until it has decided on a steady motion."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ...models.harmonic_balance import NoResponse, largest_displacement, unbalance_response
from ...models.stability import growth_rates
from ..result.verdict.by_run import on_one_side
from ..result.verdict.known import Known
from ..scene import Scene
from .batch import run
from .kinds import Found, Kind, classify
from .starts import Job

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ...models.arrays import Array

EXTENDED, MOST_EXTENDED = 5.0, 16.0  # times as long a run that has not decided is run once more
TIME_CONSTANTS = 8.0  # of the balanced motion, which that run lasts at least
LAST = 4.0  # times as long again a run that has not decided then,
LONGEST = 10_000.0  # revolutions, for its points have to fit into memory


def alone(scene: Scene, speed: float) -> float:
    """Vibration without balancers [m]; NaN where it is not known."""
    return float(alone_at(scene, np.array([speed]))[0])


def alone_at(scene: Scene, speeds: Array) -> Array:
    """The same at speeds (k,) [rad/s]; NaN at all of them where it is not known at one."""
    try:
        found = unbalance_response(scene.assembly().rotor, speeds)
    except NoResponse:
        return np.full(len(speeds), np.nan)
    return largest_displacement(found).max(axis=1)


def scale(scene: Scene, speed: float) -> float:
    """Vibration that a balanced one is small against [m]; NaN where it is not known.

    That without balancers; of a rotor without unbalance the one by its weights alone, those of each
    plane on one side.
    """
    bare = alone(scene, speed)
    return bare if bare != 0.0 else on_one_side(Known(scene, 0.0, speed)) or math.nan


def settle(scene: Scene, made: Job) -> tuple[Found, NDArray[np.object_], Array]:
    """Motions of some starts; what has not decided is run again, longer, and twice at most.

    An irregular motion can end in a steady one after a time that nothing tells, and a second
    frequency can grow until weights are left behind: both are looked at longest.  The windows are
    not longer then: the largest vibration of long windows is alike however irregular the motion is.

    Returns:
        Motions; why a run has failed, else empty; largest distance of each run [m].
    """
    bare = scale(scene, made.speed)
    seen, failure, largest = run(made)
    found = classify(seen, bare, made.speed)
    open_ = np.flatnonzero(~found.decided)
    factor, window = _extension(scene, made) if len(open_) else 1.0, 0.0
    most = LONGEST * math.tau / (made.speed * made.settled)
    for longer in (factor, max(factor, min(LAST * factor, most))):
        if not len(open_):
            break
        seen, failure[open_], largest[open_] = run(made.longer(longer, open_, window))
        found.replace(open_, classify(seen, bare, made.speed))
        open_, window = open_[_is_open(found)[open_]], seen.seconds
    return found, failure, largest


def _is_open(found: Found) -> NDArray[np.bool_]:
    """Whether the second of three looks does not decide (r,)."""
    unnamed = np.isin(found.kind, (Kind.UNDECIDED, Kind.IRREGULAR))
    return unnamed | ((found.kind == Kind.TWO_FREQUENCIES) & ~found.calm)


def _extension(scene: Scene, made: Job) -> float:
    """How many times as long the second run is."""
    assembly = scene.assembly()
    try:
        growth = float(growth_rates(assembly, made.speed)[0])
    except (ValueError, ArithmeticError):
        return EXTENDED
    needed = TIME_CONSTANTS / -growth / made.settled if growth < 0.0 else 0.0
    return float(np.clip(needed, EXTENDED, MOST_EXTENDED))
