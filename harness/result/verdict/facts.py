"""Rulings from what is known before the run is looked at: no run can change them."""

from __future__ import annotations

import math

import numpy as np

from ....models.readable import readable_apart, rounded
from ....models.supports import Slider
from ...units import in_both
from .case import MARGIN, OFFSETS_TELL, SAFE, Case, Ruling
from .known import SURELY_BEYOND, Known
from .outcome import Outcome
from .steady import BALANCED, size_of
from .words import millimetres, percent
from .words import seconds as in_words


def from_facts(known: Known) -> Ruling | None:
    """What no run can change."""
    if known.exceeds_capacity:
        return _over_capacity(known)
    heavy = too_heavy(known, known.alone)
    if heavy is not None:
        return heavy
    if known.is_out_of_reach:
        assert known.reach is not None
        return Ruling(
            Outcome.OUT_OF_REACH,
            "the weights' planes cannot undo this unbalance: at least "
            f"{percent(known.least / known.alone)} of the vibration is left",
        )
    if known.left_by_offsets > OFFSETS_TELL * known.limit:
        return off_centre(known)
    if known.growth is None or known.growth.state == "stable":
        return None
    here = in_both(known.speed, "rad/s")
    if known.growth.state == "neutral":
        below = f"growth below {known.growth.error:.1g} 1/s"
        if known.is_damped:
            return Ruling(
                Outcome.UNDECIDED,
                f"stability undecided at this speed, {here}: {below}, too slow to move the weights",
            )
        return Ruling(
            Outcome.NEUTRAL,
            f"neutral at this speed, {here}: no damping brings the machine to a steady motion "
            f"({below})",
        )
    return unstable(known)


def too_heavy(known: Known, alone: float) -> Ruling | None:
    """That weights hold too much wherever they stand.

    Args:
        alone: vibration that what they leave is compared with [m].
    """
    if known.left_by_too_much <= SURELY_BEYOND * BALANCED * alone:
        return None
    assert known.reach is not None
    needed, least = readable_apart(known.reach.needed, known.reach.least)
    return Ruling(
        Outcome.TOO_HEAVY,
        f"{needed} to balance, the weights hold at least {least} wherever they stand: at "
        f"least {percent(known.left_by_too_much / alone)} of the vibration is left",
    )


def unstable(known: Known) -> Ruling | None:
    """That a deviation from balance grows, which no other position of balance saves."""
    if not known.is_unstable:
        return None
    if known.speed < known.critical:
        gather = "go to the heavy side" if known.alone else "gather on one side"
        return Ruling(
            Outcome.BELOW_CRITICAL,
            f"below the critical speed, {in_both(known.critical, 'rad/s')}: the weights {gather}",
        )
    if known.others_are_stable:  # the weights leave this one
        return None
    assert known.growth is not None
    return Ruling(
        Outcome.UNSTABLE,
        f"unstable at this speed, {in_both(known.speed, 'rad/s')}: a deviation from balance grows "
        f"by {rounded(known.growth.rate, 2)} 1/s",
    )


def off_centre(known: Known) -> Ruling:
    """Weights that bring the centre of their track to rest, or rest on lobes, not the rotor."""
    if known.lobes:
        aside = f", and off centre by {millimetres(known.off_centre)}" * bool(known.off_centre)
        return Ruling(
            Outcome.NOT_ROUND,
            f"the race is not round (lobes of up to {millimetres(known.lobes)}{aside}): in balance "
            f"{percent(known.left_by_offsets / known.alone)} of the vibration is left",
        )
    return Ruling(
        Outcome.OFF_CENTRE,
        f"the weights' track is off centre by {millimetres(known.off_centre)}: in balance "
        f"{percent(known.left_by_offsets / known.alone)} of the vibration is left",
    )


def rule_linear(case: Case) -> Ruling:
    """Of a machine without weights, which has one steady motion at every speed."""
    known = case.known
    steady = known.response(np.asarray(known.assembly.rotor.unbalance, complex))
    size = size_of(steady)
    constant, share = known.time_constant, size / known.alone
    if case.now is not None and math.isfinite(constant):
        away = size_of(case.now.synchronous - steady) + case.now.rest
    else:
        away = math.inf
    unsettled = ""
    seconds = None
    if away > 0.5 * known.limit and math.isfinite(away):
        seconds = SAFE * constant * math.log(MARGIN * away / (0.5 * known.limit))
        unsettled = f"; the run has not settled yet, time constant {in_words(constant)}"
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


def _less_above(known: Known) -> float | None:
    """Speed from which on the vibration is less than without the balancers, if one is near."""
    from scipy.optimize import brentq

    def excess(speed: float) -> float:
        other = Known(known.scene, known.time, speed)
        loaded = other.response(np.asarray(other.assembly.rotor.unbalance, complex))
        return size_of(loaded) - other.alone

    speeds = known.speed * np.geomspace(1.0, 3.0, 24)
    try:
        signs = [excess(w) for w in speeds]
        for low, high, a, b in zip(speeds[:-1], speeds[1:], signs[:-1], signs[1:], strict=True):
            if a > 0.0 >= b:
                return float(brentq(excess, low, high))
    except (ValueError, ArithmeticError):
        return None
    return None


def over_capacity_at_any_speed(known: Known) -> Ruling | None:
    """That the weights hold too little, where what is needed does not depend on the speed as it
    does with a track off centre."""
    return _over_capacity(known) if known.exceeds_capacity and not known.off_centre else None


def over_capacity_off_centre(known: Known) -> Ruling | None:
    """The same of a disc with its track off centre, where the rest is more than rigid friction of
    the supports can hold.

    With the track's centre at rest the disc circles by the offset; a slider with the limit F then
    pulls with 4 F/pi at the rotor's frequency, F/pi (4 sqrt 2) along both axes, at most.
    """
    if not known.exceeds_capacity or len(known.assembly.rotor.unbalance) > 1:
        return None
    beside = [one for one in known.assembly.rotor.beside if isinstance(one, Slider)]
    if len(beside) < len(known.assembly.rotor.beside):
        return None  # stops, cubic springs
    assert known.reach is not None
    limits = [one.limit for one in (*known.loaded.sliders, *beside)]
    held = 4.0 / math.pi * sum(limits) / known.speed**2
    return _over_capacity(known) if known.reach.needed - held > known.reach.capacity else None


def _over_capacity(known: Known) -> Ruling:
    assert known.reach is not None
    needed, capacity = readable_apart(known.reach.needed, known.reach.capacity)
    aside = f" with the track off centre by {millimetres(known.off_centre)}"
    return Ruling(
        Outcome.OVER_CAPACITY,
        f"capacity exceeded: {needed} to balance{aside * bool(known.off_centre)}, the weights "
        f"hold at most {capacity}",
    )
