"""Rulings on machines whose steady vibration no formula gives, by runs with balancers and without.

Such are rigid sliders, dampers with a free stroke, and stops or cubic springs that the motion
reaches.  What the weights leave there is seen, not computed, and a motion is one that lasts.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ....models.arrays import Array, Complex
from ....models.harmonic_balance import NoResponse
from ...units import rounded
from .balance import CREEP
from .case import BALANCED, Case, Ruling
from .elsewhere import turning
from .facts import over_capacity_at_any_speed, over_capacity_off_centre, too_heavy, unstable
from .known import Known
from .lasting import distance, is_steady, lasting, quiet_spells
from .outcome import Outcome
from .record import Record
from .rotor_alone import REACHED, RotorAlone
from .seen import window_of
from .steady import size_of
from .stretches import Stretch
from .words import millimetres, percent, show_too_little

LASTS, FEWEST = 0.5, 20.0  # of the record, and revolutions at least, that a motion has to last
GROWS = 1.05  # times the largest vibration of the third quarter of the record: it grows
SPELLS = 3  # below the limit, after each of which it rose again: so it goes on
APART = 0.3  # of an offset: by which the vibration may differ that it leaves


def vibration_without(
    known: Known, stretch: Stretch, rotor_alone: RotorAlone | None
) -> tuple[float | None, str]:
    """Vibration of the rotor without balancers [m], and why no formula gives it.

    Then by runs of the rotor alone, where these are given; None: they do not give it either.
    """
    try:
        return known.alone, ""
    except NoResponse as error:
        found = None if rotor_alone is None else rotor_alone.vibration(stretch)
        return found, str(error)


def about_mean(motion: Complex, record: Record) -> Array:
    """Largest distance of a station (n, T) from its mean in the last window, (T,) [m]: supports
    with friction hold a rotor off centre, which is no vibration."""
    return distance(record.time, motion, record.since(window_of(record)))


def on_one_side(known: Known) -> float | None:
    """Steady vibration by the weights alone, those of each plane on one side [m]: what balances a
    rotor without unbalance is measured by it.

    None: there are no weights, or it is not known.
    """
    pulls = known.assembly.rotor.planes[known.table.plane] * known.table.moment[:, None]
    if not len(pulls):
        return None
    try:
        return size_of(known.response(pulls.sum(axis=0).astype(complex))) or None
    except NoResponse:
        return None


def rule_by_run(case: Case, vibration: Array, parts: list[float]) -> Ruling:
    """The outcome at the end of a plateau by what is seen.

    Args:
        vibration: largest distance of a station from its mean at every time of the record (T,) [m].
        parts: its largest in parts of the second half, see `part_sizes` [m].
    """
    too_little = over_capacity_at_any_speed(case.known) or over_capacity_off_centre(case.known)
    if too_little is not None:
        return too_little
    if case.measured_by_weights:
        cannot = too_heavy(case.known, case.alone) or unstable(case.known)
        if cannot is not None:
            return cannot
    if case.now is None or case.before is None or case.weights is None:
        little = show_too_little(case.record.revolutions)
        return Ruling(Outcome.NOT_SETTLED, f"not settled yet: {little}")
    behind = turning(case, case.now, case.weights, 0.0)
    if behind is not None:
        return behind
    angle = case.record.angle
    above = np.flatnonzero(vibration > case.limit)
    since = angle[above[-1]] if len(above) else angle[0]
    lasted = (angle[-1] - since) / math.tau
    rests = bool((np.abs(case.weights.rates) * case.record.seconds <= CREEP).all())
    quarters = angle[0] + (angle[-1] - angle[0]) * np.array([0.5, 0.75])
    third, fourth = (angle >= quarters[0]) & (angle < quarters[1]), angle >= quarters[1]
    grows = vibration[fourth].max() > GROWS * vibration[third].max(initial=0.0)
    if lasted >= max(FEWEST, LASTS * case.record.revolutions) and (rests or not grows):
        return Ruling(Outcome.BALANCED)
    spells = quiet_spells(angle, vibration, case.limit)
    motion = lasting(case) if len(spells) >= SPELLS and lasted <= max(spells) else None
    if motion is not None:
        return replace(motion, reason=f"{motion.reason}; {_again(spells)}")
    if lasted > 0.0:
        before = f"; {_again(spells)} before" if spells else ""
        return Ruling(
            Outcome.CANNOT_TELL,
            "the vibration is below the limit now; whether it stays there is not known, as no "
            f"formula covers {_uncovered(case)}{before}",
        )
    long = case.record.revolutions >= FEWEST
    if rests and long and is_steady(parts, REACHED) and min(parts) > case.limit:
        return _at_rest(case, float(np.median(parts)))
    return lasting(case) or Ruling(
        Outcome.CANNOT_TELL,
        f"the motion has not settled, and no formula covers {_uncovered(case)}",
    )


def _again(spells: list[float]) -> str:
    """A vibration that falls below the limit and rises again."""
    times = "once" if len(spells) == 1 else f"{len(spells)} times"
    return (
        f"the vibration fell below {100.0 * BALANCED:g} % of that without {times}, for up to "
        f"{rounded(max(spells))} revolutions, and rose again"
    )


def _uncovered(case: Case) -> str:
    return "a rotor without unbalance" if case.measured_by_weights else "these supports"


def _at_rest(case: Case, size: float) -> Ruling:
    """Weights that rest in the rotor, which vibrates by a size [m]."""
    offset, share = case.known.off_centre, percent(size / case.alone)
    if len(case.known.assembly.rotor.unbalance) == 1 and abs(size - offset) <= APART * offset:
        return Ruling(
            Outcome.OFF_CENTRE,
            f"the weights' track is off centre by {millimetres(offset)}: at rest in the rotor they "
            f"leave {share} of the vibration",
        )
    which = "with all of them on one side" if case.measured_by_weights else "without"
    return Ruling(
        Outcome.ANOTHER_MOTION,
        "another steady motion than the balanced one: the weights rest in the rotor, which "
        f"vibrates by {share} of what it does {which}",
    )
