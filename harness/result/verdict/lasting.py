"""Motions of the weights that neither settle nor repeat, and last."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ....models.arrays import Array, Complex
from ....models.readable import rounded
from ...scene.balancer import WeightBalancer
from ...units import in_both
from .balance import CREEP
from .case import MANY_TIME_CONSTANTS, Case, Ruling
from .outcome import Outcome
from .record import Mask
from .seen import TURNING, weights_of_points

PARTS = 8  # of the second half of a run
FEWEST = 300.0  # revolutions of a run that shows a motion that lasts
ALIKE = 0.2  # of the vibration: what it may rise or fall by over the second half of that run
ALIKE_SPEED = 0.05  # of the rotor's speed: what that of weights may
BEYOND = 1.5  # times the limit: the vibration in every part of the second half


def part_sizes(time: Array, motion: Complex) -> list[float]:
    """Largest distance of a station (n, T) from its mean, in parts of the second half [m]."""
    late = time >= 0.5 * (time[0] + time[-1])
    size = distance(time, motion, late)[late]
    edges = np.linspace(0.5 * (time[0] + time[-1]), time[-1], PARTS + 1)
    part = np.clip(np.searchsorted(edges, time[late], side="right") - 1, 0, PARTS - 1)
    # nothing was recorded in a part where all rests
    return [float(size[part == number].max(initial=0.0)) for number in range(PARTS)]


def distance(time: Array, motion: Complex, shown: Mask) -> Array:
    """Largest distance of a station (n, T) from its mean over the points `shown` (T,), (T,) [m]."""
    share = weights_of_points(time[shown])
    middle = motion[:, shown] @ (share / share.sum() if share.sum() else share)
    return np.asarray(np.abs(motion - middle[:, None]).max(axis=0))


def quiet_spells(angle: Array, vibration: Array, limit: float) -> list[float]:
    """Revolutions for which a vibration (T,) stayed below a limit before it rose again.

    Of spells of one revolution at least that end in the second half of a run.
    """
    above = np.flatnonzero(vibration > limit)
    if not len(above):
        return []
    begins, ends = angle[above[:-1]], angle[above[1:]]
    long = ((ends - begins) >= math.tau) & (ends >= 0.5 * (angle[0] + angle[-1]))
    return [float(spell) for spell in (ends - begins)[long] / math.tau]


def is_steady(parts: Sequence[float], share: float) -> bool:
    """Whether the vibration in parts of the second half of a run neither rises nor falls.

    Args:
        share: of it that both halves of the parts may differ by.
    """
    middle = len(parts) // 2
    early, late = float(np.median(parts[:middle])), float(np.median(parts[middle:]))
    return abs(late - early) <= share * max(early, late)


def lasting(case: Case) -> Ruling | None:
    """Weights that have moved for so long, and shaken the rotor alike, that they go on so."""
    record, known = case.record, case.known
    drag = known.table.damping_rate
    if record.weights is None or record.revolutions < FEWEST or not (len(drag) and drag.min()):
        return None
    slowest = 1.0 / float(drag.min())
    if math.isfinite(known.time_constant):
        slowest = max(slowest, known.time_constant)
    if record.seconds < MANY_TIME_CONSTANTS * slowest:
        return None
    x, y = np.split(record.displacement.T, 2)
    parts = part_sizes(record.time, x + 1j * y)
    if min(parts) <= BEYOND * case.limit or not is_steady(parts, ALIKE):
        return None
    at = record.time[0] + record.seconds * np.array([0.5, 0.75, 1.0])
    places = np.array([[np.interp(t, record.time, one) for t in at] for one in record.weights.T])
    turned = np.diff(places, axis=1)  # (K, 2)
    rates = turned / np.diff(at)
    if (np.abs(rates[:, 1] - rates[:, 0]) > ALIKE_SPEED * known.speed).any():
        return None
    lasts = f"another motion, which has lasted for {rounded(0.5 * record.revolutions)} revolutions"
    turning = np.asarray((np.abs(turned) >= math.tau * TURNING).all(axis=1))
    if not turning.any():
        rests = (np.abs(turned) <= CREEP).all()
        do = "rest where they do not balance it" if rests else "swing in the rotor"
        return Ruling(Outcome.ANOTHER_MOTION, f"{lasts}: the weights {do}")
    mean = known.speed + float(rates[turning].mean())
    nearest = float(min(known.natural, key=lambda one: abs(one - abs(mean)), default=0.0))
    return Ruling(
        Outcome.ANOTHER_MOTION,
        f"{lasts}: {named(case, turning)} turn at {in_both(mean, 'rad/s')}, the rotor at "
        f"{in_both(known.speed, 'rad/s')}",
        left_behind=(mean, nearest),
    )


def named(case: Case, which: Mask) -> str:
    """Names of weights."""
    names, first = [], 0
    for one in case.known.scene.balancer:
        if isinstance(one, WeightBalancer):
            mine = np.flatnonzero(which[first : first + one.count]) + 1
            first += one.count
            if len(mine) == one.count:
                of = "" if one.label == one.kind else f" of {one.label}"
                names.append(f"all {one.kind}{of}" if one.count > 1 else one.label)
            elif len(mine):
                names.append(f"{one.label} {', '.join(map(str, mine.tolist()))}")
    return " and ".join(names)
