"""Rulings on machines whose steady vibration no formula gives, by runs with balancers and without.

Such are rigid sliders, dampers with a free stroke, and stops or cubic springs that the motion
reaches.  What the weights leave there is seen, not computed, and a motion is one that lasts.
"""

from __future__ import annotations

import math

import numpy as np

from ....models.arrays import Array, Complex
from ....models.harmonic_balance import NoResponse
from ...scene import Scene
from .balance import CREEP
from .case import STEADY_SIZE, Case, Ruling
from .elsewhere import turning
from .facts import over_capacity_at_any_speed
from .known import Known
from .outcome import Outcome
from .passages import motion_without_balancers
from .record import Mask, Record
from .seen import window_of
from .steady import BALANCED
from .words import percent

LASTS, FEWEST = 0.5, 20.0  # of the record, and revolutions at least, that a motion has to last
GROWS = 1.05  # times the largest vibration of the third quarter of the record: it grows
REACHED = 0.02  # of a vibration: that of a steady motion changes by less between two windows


def vibration_without(known: Known, record: Record, wanted: bool) -> tuple[float | None, str]:
    """Vibration of the rotor without balancers [m], and why no formula gives it.

    Then by a run, if that is wanted; None: that does not give it either.
    """
    try:
        return known.alone, ""
    except NoResponse as error:
        return alone_by_run(known.scene, record) if wanted else None, str(error)


def about_mean(motion: Complex, record: Record) -> Array:
    """Largest distance of a station (n, T) from its mean in the last window, (T,) [m]: supports
    with friction hold a rotor off centre, which is no vibration."""
    return _about(motion, windows(record, record.time)[0])


def _about(motion: Complex, shown: Mask) -> Array:
    return np.asarray(np.abs(motion - motion[:, shown].mean(axis=1, keepdims=True)).max(axis=0))


def alone_by_run(scene: Scene, record: Record) -> float | None:
    """Vibration of the rotor without balancers at the end of a plateau [m], by a run of its own.

    None: it has not settled there, or that run cannot be completed.
    """
    found = motion_without_balancers(scene)
    if found is None:
        return None
    time, motion = found
    late, early = windows(record, time)
    if not (late.any() and early.any()):
        return None
    now, before = (float(_about(motion, w)[w].max()) for w in (late, early))
    return now if abs(now - before) <= STEADY_SIZE * max(now, before) else None


def windows(record: Record, time: Array) -> tuple[Mask, Mask]:
    """Which times (T,) are in the last window of a plateau, and in the one before."""
    left = (record.angle[-1] - record.angle) / math.tau  # revolutions to the end, falling
    one, two = (
        float(np.interp(-turns, -left, record.time))
        for turns in (window_of(record), 2.0 * window_of(record))
    )
    end = float(record.time[-1])
    return (time >= one) & (time <= end), (time >= two) & (time < one)


def rule_by_run(case: Case, alone: float, vibration: Array) -> Ruling:
    """The outcome at the end of a plateau by what is seen.

    Args:
        alone: vibration without balancers [m].
        vibration: largest distance of a station from its mean at every time of the record (T,) [m].
    """
    too_little = over_capacity_at_any_speed(case.known)
    if too_little is not None:
        return too_little
    if case.now is None or case.before is None or case.weights is None:
        turned = f"{case.record.revolutions:.2g} revolutions"
        return Ruling(Outcome.NOT_SETTLED, f"not settled yet: {turned} show too little")
    behind = turning(case, case.now, case.weights, 0.0)
    if behind is not None:
        return behind
    limit, angle = BALANCED * alone, case.record.angle
    above = np.flatnonzero(vibration > limit)
    since = angle[above[-1]] if len(above) else angle[0]
    lasted = (angle[-1] - since) / math.tau
    rests = bool((np.abs(case.weights.rates) * case.record.seconds <= CREEP).all())
    quarters = angle[0] + (angle[-1] - angle[0]) * np.array([0.5, 0.75])
    third, fourth = (angle >= quarters[0]) & (angle < quarters[1]), angle >= quarters[1]
    grows = vibration[fourth].max() > GROWS * vibration[third].max(initial=0.0)
    if lasted >= max(FEWEST, LASTS * case.record.revolutions) and (rests or not grows):
        return Ruling(Outcome.BALANCED)
    if lasted > 0.0:
        return Ruling(
            Outcome.CANNOT_TELL,
            "the vibration is below the limit now; whether it stays there is not known, as no "
            "formula covers these supports",
        )
    late = [float(vibration[shown].max()) for shown in windows(case.record, case.record.time)]
    steady = abs(late[0] - late[1]) <= REACHED * max(late)
    if steady and rests and case.record.revolutions >= FEWEST:
        return Ruling(
            Outcome.ANOTHER_MOTION,
            "another steady motion than the balanced one: the weights rest in the rotor, which "
            f"vibrates by {percent(late[0] / alone)} of what it does without",
        )
    return Ruling(
        Outcome.CANNOT_TELL, "the motion has not settled, and no formula tells how it will"
    )
