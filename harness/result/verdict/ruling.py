"""From what is known and what a run shows to one outcome with its reason."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ....models.readable import brief, rounded
from .balance import balanced, settling
from .case import DOUBT, MANY_TIME_CONSTANTS, Case, Ruling, unsettled
from .elsewhere import dragged, resting, stuck, together, turning
from .facts import from_facts, rule_linear
from .lasting import lasting
from .outcome import Outcome
from .seen import Weights
from .words import show_too_little


def rule(case: Case) -> Ruling:
    """The outcome at the end of a plateau."""
    found = from_facts(case.known)
    if found is not None:
        return _with_left_behind(found, case)
    if not len(case.known.table.angle):
        return rule_linear(case)
    if case.now is None or case.before is None:
        return _short(case)
    if case.weights is None:
        return Ruling(Outcome.CANNOT_TELL, "the angles of the weights were not recorded")
    left = float(case.known.sizes(case.weights.angles)[0])
    for step in (stuck, balanced, together, turning, settling, dragged, resting):
        found = step(case, case.now, case.weights, left)
        if found is not None:
            return _with_left_behind(found, case) if step is together else found
    return _undecided(case, case.weights)


def _with_left_behind(found: Ruling, case: Case) -> Ruling:
    """A ruling that holds wherever the weights are, with those left behind beside it."""
    if case.now is None or case.weights is None or not len(case.known.table.angle):
        return found
    behind = turning(case, case.now, case.weights, 0.0)
    if behind is None or behind.outcome is not Outcome.ANOTHER_MOTION:
        return found
    where = behind.reason.removeprefix("another steady motion: ")
    return replace(found, reason=f"{found.reason}; {where}", left_behind=behind.left_behind)


def _short(case: Case) -> Ruling:
    """A run that shows too little since the last change."""
    little = show_too_little(case.record.revolutions)
    return Ruling(Outcome.NOT_SETTLED, f"{unsettled(case)}: {little}{DOUBT}")


def _undecided(case: Case, weights: Weights) -> Ruling:
    """Weights that move, far from balance."""
    lasts = lasting(case)
    if lasts is not None:
        return lasts
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
        f"{unsettled(case)}: the weights still turn by up to {rounded(fastest, 2)} rad/s in the "
        f"rotor{DOUBT}",
    )
