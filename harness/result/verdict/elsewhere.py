"""Rulings on weights that are held, turn or rest where they do not balance the rotor."""

from __future__ import annotations

import math

import numpy as np

from ...scene.balancer import WeightBalancer
from ...units import in_both
from .balance import CREEP
from .case import (
    DOUBT,
    FEWEST_TIME_CONSTANTS,
    MANY_TIME_CONSTANTS,
    OFFSETS_TELL,
    STEADY_SIZE,
    Case,
    Ruling,
    unsettled,
)
from .facts import off_centre
from .lasting import lasting, named
from .outcome import Outcome
from .record import Mask
from .seen import STUCK, Vibration, Weights

DRAGGED = 0.2  # of the rate at which gravity drags weights: they turn by so much, or faster
STEADY_RATE = 0.02  # of its speed: by which that of a weight left behind may still change
BESIDE = 0.3  # of a natural frequency: how far beside it weights are captured by it


def stuck(case: Case, now: Vibration, weights: Weights, left: float) -> Ruling | None:
    """Weights that rolling resistance holds."""
    names, record = [], case.record
    assert record.weights is not None
    last, first = record.weights[record.since(1.0)], 0
    for one in case.known.scene.balancer:
        if not isinstance(one, WeightBalancer):
            continue
        mine = last[:, first : first + one.count]
        first += one.count
        if one.can_stick and bool((np.ptp(mine, axis=0) <= STUCK).all()):
            names.append(one.label)
    if not names or max(left, now.size) <= case.known.limit:
        return None
    return Ruling(Outcome.STUCK, f"{', '.join(names)} stuck: rolling resistance holds them")


def together(case: Case, _now: Vibration, _weights: Weights, _left: float) -> Ruling | None:
    if not case.together:
        return None
    return Ruling(
        Outcome.TOGETHER, "identical weights share one angle, and this run cannot part them"
    )


def turning(case: Case, now: Vibration, weights: Weights, _left: float) -> Ruling | None:
    """Weights that turn slower, or faster, than the rotor."""
    if not weights.turning.any():
        return None
    before = case.before
    assert before is not None
    behind = weights.turning
    speeds = case.known.speed + weights.rates[behind]
    mean = float(np.mean(speeds))
    natural = case.known.natural
    nearest = float(natural[np.abs(natural - abs(mean)).argmin()]) if len(natural) else 0.0
    who = named(case, behind)
    turn = (
        f"{who} turn at {in_both(mean, 'rad/s')}, the rotor at {in_both(case.known.speed, 'rad/s')}"
    )
    decay = case.known.table.damping_rate[behind]
    with np.errstate(divide="ignore", invalid="ignore"):
        later = np.abs(weights.changes[behind]) * np.maximum(
            1.0, FEWEST_TIME_CONSTANTS / (decay * max(case.record.seconds, 1e-300))
        )
    steady = bool((later <= STEADY_RATE * np.abs(case.known.speed)).all())
    alike = abs(now.largest - before.largest) <= STEADY_SIZE * max(now.largest, before.largest)
    if case.gravity and abs(mean) <= 0.02 * case.known.speed and steady:
        return Ruling(
            Outcome.ANOTHER_MOTION,
            f"another steady motion: gravity holds {who} at the bottom of the track",
            left_behind=(mean, nearest),
        )
    if nearest and abs(mean - nearest) <= BESIDE * nearest and steady and alike:
        return Ruling(
            Outcome.ANOTHER_MOTION,
            f"another steady motion: left behind, {turn}; the nearest natural frequency is "
            f"{in_both(nearest, 'rad/s')}",
            left_behind=(mean, nearest),
        )
    slowest = 1.0 / float(decay.min()) if decay.min() else math.inf
    if case.record.seconds > MANY_TIME_CONSTANTS * max(case.known.time_constant, slowest):
        if _stay_beside(case, behind):
            return Ruling(
                Outcome.ANOTHER_MOTION,
                f"another motion, which lasts: left behind, {turn}; the nearest natural frequency "
                f"is {in_both(nearest, 'rad/s')}",
                left_behind=(mean, nearest),
            )
        lasts = lasting(case)
        return lasts or Ruling(
            Outcome.CANNOT_TELL,
            f"{turn}, and this neither settles nor repeats",
            left_behind=(mean, nearest),
        )
    lasts = lasting(case)
    return lasts or Ruling(
        Outcome.NOT_SETTLED,
        f"{unsettled(case)}: {turn}{DOUBT}",
        left_behind=(mean, nearest),
    )


def _stay_beside(case: Case, behind: Mask) -> bool:
    """Whether weights left behind swing about one speed beside a natural frequency, as supports
    that are not alike make them."""
    record, natural = case.record, case.known.natural
    assert record.weights is not None
    if not len(natural):
        return False
    quarters = np.quantile(record.time, [0.5, 0.75, 1.0])
    at = [*np.searchsorted(record.time, quarters[:-1]).tolist(), len(record.time) - 1]
    turned = np.diff(record.weights[at][:, behind], axis=0)
    speeds = record.speed + turned / np.diff(record.time[at])[:, None]
    drift = np.abs(speeds[1] - speeds[0]).max()
    off = np.abs(natural[:, None, None] - np.abs(speeds)).min(axis=0)
    near = bool((off <= BESIDE * np.abs(speeds)).all())
    return near and bool(drift <= STEADY_RATE * abs(record.speed))


def dragged(case: Case, _now: Vibration, weights: Weights, _left: float) -> Ruling | None:
    """Weights that gravity drags round the track faster than balance draws them back."""
    rate, constant = case.falls[1], case.known.time_constant
    if not case.is_moved_by_gravity:
        return None
    waited = case.record.seconds >= FEWEST_TIME_CONSTANTS * constant
    falling = float(-weights.rates.min()) >= DRAGGED * rate
    if not (case.shift > 1.0 or (waited and falling)):
        return None
    return Ruling(
        Outcome.GRAVITY_SWING,
        "gravity swings the weights in every revolution and drags them round the track, at "
        f"{rate:.2g} rad/s",
    )


def resting(case: Case, now: Vibration, weights: Weights, _left: float) -> Ruling | None:
    """Weights at rest in the rotor, but not where they balance it."""
    from ....models.linear.together import difference_growth

    known, before = case.known, case.before
    assert before is not None
    constant = known.time_constant
    if not math.isfinite(constant) or case.record.seconds < FEWEST_TIME_CONSTANTS * constant:
        return None
    if (np.abs(weights.rates) * 10.0 * constant > CREEP).any():
        return None
    if abs(now.size - before.size) > STEADY_SIZE * max(now.size, before.size):
        return None
    if case.is_moved_by_gravity:
        return Ruling(
            Outcome.GRAVITY_SWING,
            "gravity swings the weights in every revolution and drags them out of balance",
        )
    if OFFSETS_TELL * known.left_by_offsets > known.limit:
        return off_centre(known)
    leaves = difference_growth(known.assembly, known.speed, weights.angles)
    if (leaves > 1e-6 * known.speed).any():
        return Ruling(
            Outcome.CANNOT_TELL, "the weights rest where they cannot stay, and will leave it"
        )
    return Ruling(
        Outcome.ANOTHER_MOTION,
        "another steady motion than the balanced one: the weights rest elsewhere in the rotor",
    )
