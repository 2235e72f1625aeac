"""Rulings on weights that have balanced the rotor, or are near enough to it."""

from __future__ import annotations

import math

import numpy as np

from .case import (
    FEWEST_TIME_CONSTANTS,
    MARGIN,
    OFFSETS_TELL,
    SAFE,
    Case,
    Ruling,
    unsettled,
)
from .outcome import Outcome
from .seen import Vibration, Weights
from .words import millimetres

AGREES = 0.5  # of the limit: what the vibration seen may differ by from that of the unbalance left
NEAR = 0.35  # rad from the balanced motion up to which its time constant holds
STAYS = 3.0  # time constants for which a vibration below the limit has to have stayed there
CREEP = 0.1  # rad within ten time constants: a weight that turns by less rests
FEWEST = 20.0  # revolutions that show how weights hardly move
# weights that slow down as 1/t or faster turn in ten times the record further at most by what they
# would in 2.4 times at their present rates
FURTHER, TRIED = 3.0, 21  # times the record, and times within it
SLOWS, CREEPS = 0.8, 1e-3  # times the turn in the quarter of the record before, and rad more
SLOW_PULL = 0.3  # of the unbalance's pull: what other frequencies may shake weights by


def balanced(case: Case, now: Vibration, weights: Weights, left: float) -> Ruling | None:
    """Balanced, or kept from it by nothing but the swing in gravity."""
    known = case.known
    if known.is_unstable:
        return None
    still = now.largest <= AGREES * known.limit  # whatever its frequency
    if max(left, now.size) > known.limit or not (still or now.known):
        return None
    if not (still or _agrees(case, now, weights)):
        return None
    if weights.turning.any():
        return None
    may_leave = not _has_stayed(case) and left + _potential(case, weights) > known.limit
    if may_leave and not _hardly_moves(case, weights):
        return None
    if known.growth is None and not _rests(case, weights):
        return Ruling(
            Outcome.CANNOT_TELL,
            "the vibration is below the limit now; whether it stays there is not known, as the "
            "stability of this machine is not",
        )
    swing = max(
        (a for f, a in now.others.items() if abs(f - 2.0 * known.speed) < 1e-9 * f), default=0
    )
    if case.gravity and swing > known.limit:
        return Ruling(
            Outcome.GRAVITY_SWING,
            f"gravity swings the weights in every revolution: {millimetres(swing)} at twice the "
            "rotor's frequency",
        )
    return Ruling(Outcome.BALANCED)


def _agrees(case: Case, now: Vibration, weights: Weights) -> bool:
    """Whether the synchronous vibration is that of the unbalance that the weights leave."""
    expected = case.known.response(case.known.moments(weights.angles))
    if case.known.scene.operation.motor:  # the angle of the rotor is not known so well
        difference = np.abs(np.abs(expected) - np.abs(now.synchronous))
    else:
        difference = np.abs(expected - now.synchronous)
    return bool(difference.max() <= AGREES * case.known.limit)


def _potential(case: Case, weights: Weights) -> float:
    """Vibration that the weights' present rates can still add [m]."""
    if case.known.growth is None:
        return 0.0
    rate = max(case.known.slow_rate, 1e-300)
    return case.known.size_of_turns(np.minimum(np.abs(weights.rates) / rate, 1.0))


def _has_stayed(case: Case) -> bool:
    """Whether the unbalance left has stayed below the limit for so long that it will."""
    known, record = case.known, case.record
    assert case.before is not None
    assert record.weights is not None
    if record.seconds < FEWEST_TIME_CONSTANTS * known.time_constant:
        return False
    if case.gravity:  # which swings what is left in every revolution
        return case.before.size <= known.limit
    last = record.time >= record.time[-1] - STAYS * known.time_constant
    return bool(known.sizes(record.weights[last]).max() <= known.limit)


def _hardly_moves(case: Case, weights: Weights) -> bool:
    """Whether the weights have stayed near balance, slow down, and leave less than the limit for
    ten times the record.

    Where they hold hardly more than what is to balance, the last of their way takes for ever, and
    what it changes is next to nothing.
    """
    known, record = case.known, case.record
    assert record.weights is not None
    drag = known.table.damping_rate
    if case.gravity or known.growth is None or record.revolutions < FEWEST or not drag.min():
        return False
    if record.seconds * drag.min() < FEWEST_TIME_CONSTANTS:
        return False
    late = record.time >= record.time[0] + 0.5 * record.seconds
    at = np.searchsorted(record.time, record.time[0] + record.seconds * np.array([0.5, 0.75]))
    places = record.weights[[*at, -1]]
    early, now = np.abs(np.diff(places, axis=0))
    share = np.linspace(0.0, FURTHER * record.seconds, TRIED)[:, None]
    ahead = weights.angles + weights.rates * share
    seen = max(float(known.sizes(some).max()) for some in (record.weights[late], ahead))
    return seen <= known.limit and bool((now <= SLOWS * early + CREEPS).all())


def _rests(case: Case, weights: Weights) -> bool:
    """Whether weights have turned so little in the record that they rest."""
    return bool((np.abs(weights.rates) * case.record.seconds <= CREEP).all())


def settling(case: Case, now: Vibration, weights: Weights, left: float) -> Ruling | None:
    """On the way to balance, near enough to it that its time constant holds."""
    known = case.known
    if known.balanced_at is None or known.growth is None:
        return None
    away = np.abs(known.balanced_at - weights.angles)
    rates = np.abs(weights.rates) / max(known.slow_rate, 1e-300)
    others = sum(f * f * a for f, a in now.others.items())
    calm = others <= SLOW_PULL * known.speed**2 * known.alone
    if away.max() > NEAR or rates.max() > 2.0 * NEAR or not calm or case.is_moved_by_gravity:
        return None
    if OFFSETS_TELL * known.left_by_offsets > known.limit:
        return None
    size = known.size_of_turns(away + rates) + now.size + now.rest
    seconds = SAFE * known.time_constant * math.log(max(2.0, MARGIN * size / known.limit))
    return Ruling(
        Outcome.NOT_SETTLED,
        unsettled(case),
        seconds,
    )
