"""From what is known and what a run shows to one outcome with its reason."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ....models.arrays import Array, Complex
from ...scene.balancer import WeightBalancer
from ...units import brief, in_both, readable_unbalance
from .known import Known
from .outcome import Outcome
from .seen import STUCK, Mask, Record, Vibration, Weights

AGREES = 0.5  # of the limit: what the vibration seen may differ by from that of the unbalance left
NEAR = 0.35  # rad from the balanced motion up to which its time constant holds
MARGIN, SAFE = (
    3.0,
    1.3,
)  # of a deviation, and of a time: what small motions may exceed their rule by
FEWEST_TIME_CONSTANTS = 5.0  # of a run that shows a steady motion
STAYS = 3.0  # time constants for which a vibration below the limit has to have stayed there
DRAGGED = 0.2  # of the rate at which gravity drags weights: they turn by so much, or faster
MANY_TIME_CONSTANTS = 20.0  # of a run that would have settled by then
CREEP = 0.1  # rad within ten time constants: a weight that turns by less rests
STEADY_RATE = 0.02  # of its speed: by which that of a weight left behind may still change
STEADY_SIZE = 0.1  # of a vibration: what it may change by between two windows
BESIDE = 0.3  # of a natural frequency: how far beside it weights are captured by it
MOST_REVOLUTIONS = 1e6  # that are advised
SLOW_PULL = 0.3  # of the unbalance's pull: what other frequencies may shake weights by
DOUBT = "; how long the weights need is not known"  # a longer run may tell
OFFSETS_TELL = 1.3  # of the limit: the motion that an offset leaves is known so well
SWING = 0.02  # rad: smaller swings by gravity are no reason


@dataclass(frozen=True)
class Ruling:
    """An outcome with its reason.

    Attributes:
        outcome: what it is.
        reason: why, without full stop.
        seconds: further time at this speed after which the rotor is balanced [s]; None: not known.
        left_behind: speed in space of the weights that are [rad/s], and the nearest natural
            frequency [rad/s].
    """

    outcome: Outcome
    reason: str = ""
    seconds: float | None = None
    left_behind: tuple[float, float] | None = None


@dataclass(frozen=True, eq=False)
class Case:
    """All that a ruling looks at.

    Attributes:
        known: facts at this speed.
        record: since the last change of speed or unbalance.
        called: what the balancers are called.
        together: whether identical weights share one angle, which the run cannot part.
        now, before: vibration in the last window and in the one before; None: too short.
        weights: what they do in both windows together; None: not recorded, or too short.
    """

    known: Known
    record: Record
    called: str
    together: bool
    now: Vibration | None
    before: Vibration | None
    weights: Weights | None

    @property
    def gravity(self) -> float:
        """Across the axis [m/s^2]."""
        return self.known.scene.operation.gravity

    @cached_property
    def falls(self) -> tuple[float, float]:
        """Largest swing of a weight by gravity [rad], and rate at which it drags one back [rad/s].

        A weight swings by g/(kappa R w sqrt(w^2 + d^2)) and falls behind at the rate
        g^2/(2 w (kappa R)^2 (w^2 + d^2)), see equations.md.
        """
        table, w = self.known.table, self.known.speed
        fall, square = self.gravity / table.kappa_radius, w * w + table.damping_rate**2
        swing, drift = fall / (w * np.sqrt(square)), fall**2 / (2.0 * w * square)
        return float(swing.max()), float(drift.max())

    @property
    def shift(self) -> float:
        """About how far gravity drags weights out of balance [rad]; 0 without gravity."""
        drift = self.falls[1]
        return drift * min(self.known.time_constant, 1e300) if drift else 0.0

    @property
    def is_moved_by_gravity(self) -> bool:
        """Whether gravity swings or shifts weights by more than `SWING`."""
        return max(self.falls[0], self.shift) > SWING


def rule(case: Case) -> Ruling:
    """The outcome at the end of a plateau."""
    found = _from_facts(case.known)
    if found is not None:
        return _with_left_behind(found, case)
    if not len(case.known.table.angle):
        return _linear(case)
    if case.now is None or case.before is None:
        return _short(case)
    if case.weights is None:
        return Ruling(Outcome.CANNOT_TELL, "the angles of the weights were not recorded")
    left = float(case.known.sizes(case.weights.angles)[0])
    for step in (_stuck, _balanced, _together, _turning, _settling, _dragged, _resting):
        found = step(case, case.now, case.weights, left)
        if found is not None:
            return found
    return _undecided(case, case.weights)


def _with_left_behind(found: Ruling, case: Case) -> Ruling:
    """A ruling from facts, with the weights that are left behind beside it."""
    if case.now is None or case.weights is None or not len(case.known.table.angle):
        return found
    behind = _turning(case, case.now, case.weights, 0.0)
    if behind is None or behind.outcome is not Outcome.ANOTHER_MOTION:
        return found
    where = behind.reason.removeprefix("another steady motion: ")
    return replace(found, reason=f"{found.reason}; {where}", left_behind=behind.left_behind)


def _from_facts(known: Known) -> Ruling | None:
    """What no run can change."""
    if known.exceeds_capacity:
        assert known.reach is not None
        return Ruling(
            Outcome.OVER_CAPACITY,
            f"capacity exceeded: {readable_unbalance(known.reach.needed)} to balance, the weights "
            f"hold at most {readable_unbalance(known.reach.capacity)}",
        )
    if known.is_out_of_reach:
        assert known.reach is not None
        return Ruling(
            Outcome.OUT_OF_REACH,
            "the weights' planes cannot undo this unbalance: at least "
            f"{percent(known.least / known.alone)} of the vibration is left",
        )
    if known.left_by_offsets > OFFSETS_TELL * known.limit:
        return _off_centre(known)
    if known.growth is None or known.growth.state == "stable":
        return None
    here = in_both(known.speed, "rad/s")
    if known.growth.state == "neutral":
        return Ruling(
            Outcome.NEUTRAL,
            f"neutral at this speed, {here}: no damping brings the machine to a steady motion "
            f"(growth below {known.growth.error:.1g} 1/s)",
        )
    if known.speed < known.critical:
        return Ruling(
            Outcome.BELOW_CRITICAL,
            f"below the critical speed, {in_both(known.critical, 'rad/s')}: the weights go to the "
            "heavy side",
        )
    return Ruling(
        Outcome.UNSTABLE,
        f"unstable at this speed, {here}: a deviation from balance grows by "
        f"{brief(known.growth.rate)} 1/s",
    )


def _off_centre(known: Known) -> Ruling:
    """Weights that bring the centre of their track to rest, and not the rotor."""
    return Ruling(
        Outcome.OFF_CENTRE,
        f"the weights' track is off centre by {millimetres(known.off_centre)}: in balance "
        f"{percent(known.left_by_offsets / known.alone)} of the vibration is left",
    )


def _linear(case: Case) -> Ruling:
    """Of a machine without weights, which has one steady motion at every speed."""
    known = case.known
    steady = known.response(np.asarray(known.assembly.rotor.unbalance, complex))
    size = float(np.sqrt(_half_axes(steady)).max())
    constant, share = known.time_constant, size / known.alone
    if case.now is not None and math.isfinite(constant):
        away = float(np.sqrt(_half_axes(case.now.synchronous - steady)).max()) + case.now.rest
    else:
        away = math.inf
    unsettled = ""
    seconds = None
    if away > 0.5 * known.limit and math.isfinite(away):
        seconds = SAFE * constant * math.log(MARGIN * away / (0.5 * known.limit))
        unsettled = f"; the run has not settled yet, time constant {brief(constant)} s"
    elif not math.isfinite(away):
        unsettled = "; the run is too short to show it"
    settled_at = f"{percent(share)} of the vibration without {case.called}{unsettled}"
    if share <= known.limit / known.alone:
        if unsettled:
            reason = f"not settled yet: the steady motion has {settled_at}"
            return Ruling(Outcome.NOT_SETTLED, reason, seconds)
        return Ruling(Outcome.BALANCED)
    if share < 1.0:
        return Ruling(Outcome.LOWERED, f"the steady motion has {settled_at}", seconds)
    where = _less_above(known)
    beyond = f"below w_* = {in_both(where, 'rad/s')}, from which on" if where else "here"
    return Ruling(
        Outcome.RAISED,
        f"{beyond} {case.called} {'lowers' if where else 'does not lower'} the vibration: the "
        f"steady motion has {settled_at}",
        seconds,
    )


def _half_axes(motion: Complex) -> Array:
    """Squares of the half axes (n,) of ellipses (2, n)."""
    x, y = motion
    return 0.5 * (np.abs(x) ** 2 + np.abs(y) ** 2 + np.abs(x**2 + y**2))


def _less_above(known: Known) -> float | None:
    """Speed from which on the vibration is less than without the balancers, if one is near."""
    from scipy.optimize import brentq

    def excess(speed: float) -> float:
        other = Known(known.scene, known.time, speed)
        loaded = other.response(np.asarray(other.assembly.rotor.unbalance, complex))
        return float(np.sqrt(_half_axes(loaded)).max()) - other.alone

    speeds = known.speed * np.geomspace(1.0, 3.0, 24)
    try:
        signs = [excess(w) for w in speeds]
        for low, high, a, b in zip(speeds[:-1], speeds[1:], signs[:-1], signs[1:], strict=True):
            if a > 0.0 >= b:
                return float(brentq(excess, low, high))
    except (ValueError, ArithmeticError):
        return None
    return None


def _short(case: Case) -> Ruling:
    """A run that shows too little since the last change."""
    turned = case.record.revolutions
    return Ruling(
        Outcome.NOT_SETTLED,
        f"{unsettled(case)}: {turned:.2g} revolutions show too little{DOUBT}",
    )


def unsettled(case: Case) -> str:
    """How a reason of a run that has not settled begins."""
    begin, constant = float(case.record.time[0]), case.known.time_constant
    since = f" since the change at {begin:.3g} s" if begin > 0.0 else ""
    rule = f", time constant {brief(constant)} s" if math.isfinite(constant) else ""
    return f"not settled yet{since}{rule}"


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


def _stuck(case: Case, now: Vibration, weights: Weights, left: float) -> Ruling | None:
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


def _balanced(case: Case, now: Vibration, weights: Weights, left: float) -> Ruling | None:
    """Balanced, or kept from it by nothing but the swing in gravity."""
    known = case.known
    still = now.largest <= AGREES * known.limit  # whatever its frequency
    if max(left, now.size) > known.limit or not (still or now.known):
        return None
    if not (still or _agrees(case, now, weights)):
        return None
    if weights.turning.any():
        return None
    if not _has_stayed(case) and left + _potential(case, weights) > known.limit:
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


def _rests(case: Case, weights: Weights) -> bool:
    """Whether weights have turned so little in the record that they rest."""
    return bool((np.abs(weights.rates) * case.record.seconds <= CREEP).all())


def _together(case: Case, _now: Vibration, _weights: Weights, _left: float) -> Ruling | None:
    if not case.together:
        return None
    return Ruling(
        Outcome.TOGETHER, "identical weights share one angle, and this run cannot part them"
    )


def _turning(case: Case, now: Vibration, weights: Weights, _left: float) -> Ruling | None:
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
    who = _named(case, behind)
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
    if case.record.seconds > MANY_TIME_CONSTANTS * max(case.known.time_constant, 1.0 / decay.min()):
        return Ruling(
            Outcome.CANNOT_TELL,
            f"{turn}, and this neither settles nor repeats",
            left_behind=(mean, nearest),
        )
    return Ruling(
        Outcome.NOT_SETTLED,
        f"{unsettled(case)}: {turn}{DOUBT}",
        left_behind=(mean, nearest),
    )


def _named(case: Case, which: Mask) -> str:
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


def _settling(case: Case, now: Vibration, weights: Weights, left: float) -> Ruling | None:
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


def _dragged(case: Case, _now: Vibration, weights: Weights, _left: float) -> Ruling | None:
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


def _resting(case: Case, now: Vibration, weights: Weights, _left: float) -> Ruling | None:
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
        return _off_centre(known)
    leaves = difference_growth(known.assembly, known.speed, weights.angles)
    if (leaves > 1e-6 * known.speed).any():
        return Ruling(
            Outcome.CANNOT_TELL, "the weights rest where they cannot stay, and will leave it"
        )
    return Ruling(
        Outcome.ANOTHER_MOTION,
        "another steady motion than the balanced one: the weights rest elsewhere in the rotor",
    )


def _undecided(case: Case, weights: Weights) -> Ruling:
    """Weights that move, far from balance."""
    constant = case.known.time_constant
    if case.record.seconds > MANY_TIME_CONSTANTS * constant:
        return Ruling(
            Outcome.CANNOT_TELL,
            f"after {brief(case.record.seconds / constant)} time constants the motion neither "
            "settles nor repeats",
        )
    fastest = float(np.abs(weights.rates).max())
    return Ruling(
        Outcome.NOT_SETTLED,
        f"{unsettled(case)}: the weights still turn by up to {fastest:.2g} rad/s in the rotor"
        f"{DOUBT}",
    )


def percent(share: float) -> str:
    """A share as people read it."""
    value = 100.0 * share
    return "below 0.01 %" if 0.0 <= value < 0.01 else f"{brief(value)} %"


def millimetres(size: float) -> str:
    """A vibration [m] as people read it."""
    value = 1e3 * size
    return "below 0.0001 mm" if value < 1e-4 else f"{brief(value)} mm"
