"""A verdict in words."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from ....models.readable import brief, readable_unbalance, rounded
from ....models.ring import BELIEVED, DRY, WARNED
from ...scene.grade import GRADES
from ...units import in_both
from .outcome import Outcome
from .words import is_nothing, millimetres, percent, times, velocity

if TYPE_CHECKING:
    from .verdict import Passage, Verdict

DECAYS = 0.9  # times what it was one window before: a vibration that decays
MATTERS = 0.1  # of the whole vibration: a smaller part is not stated


def sentences(verdict: Verdict) -> Iterator[str]:
    """What a run comes to, sentence by sentence."""
    if verdict.vibration is None:
        yield f"Not judged: {verdict.reason}."
        return
    said = _vibration(verdict)
    if verdict.balanced:
        yield f"Balanced after {brief(verdict.after or 0.0, 3)} s: v{said}."
    elif verdict.balanced is False:
        yield f"Not balanced: {verdict.reason}. V{said}."
    elif verdict.outcome in (Outcome.UNDECIDED, Outcome.CANNOT_TELL):
        yield f"Cannot tell whether it is balanced: {verdict.reason}. V{said}."
    elif verdict.outcome is Outcome.LOWERED:
        yield f"Vibration lowered: {verdict.reason}. V{said}."
    else:
        yield f"V{said}{f'; not judged: {verdict.reason}' if verdict.reason else ''}."
    yield from _parts(verdict)
    yield from _unbalance(verdict)
    if verdict.left_by_race is not None and verdict.outcome is not Outcome.NOT_ROUND:
        left = millimetres(verdict.left_by_race)
        yield f"The race is not round: in balance it leaves {left}."
    yield from _thinness(verdict)
    yield from _stops(verdict)
    yield from _plateaus(verdict)
    yield from map(_passage, verdict.passages)
    if verdict.remedy:
        yield f"{verdict.remedy[0].upper()}{verdict.remedy[1:]}."


def _thinness(verdict: Verdict) -> Iterator[str]:
    """How far the model of a ring of liquid is to be believed."""
    thin = verdict.thinness or 0.0
    if thin > DRY:
        yield (
            "The wall of the ring was dry in places: the model of small waves is invalid from "
            "there on, and how large the vibration becomes is not known."
        )
    elif thin > WARNED:
        yield (
            f"The wave took {percent(thin)} of the layer of liquid away: more than 30 %, beyond "
            "which waves are too large for the model."
        )
    elif thin > BELIEVED:
        yield (
            f"The wave took {percent(thin)} of the layer of liquid away: the motion beside the "
            "steady one may err by some 10 %."
        )


def _stops(verdict: Verdict) -> Iterator[str]:
    """Which stops were touched, and how hard."""
    touched = [one for one in verdict.stops if one.touches or one.touches_before]
    for one in touched:
        often = times(one.touches, one.touches_before)
        yield f"The {one.place} was touched {often}, with at most {rounded(one.force, 3)} N."
    if verdict.stops and not touched:
        yield "No stop was touched."


def _vibration(verdict: Verdict) -> str:
    assert verdict.vibration is not None
    size = verdict.vibration if verdict.synchronous is None else verdict.synchronous
    mostly_other = _is_mostly_other(verdict)
    said = f"ibration {millimetres(verdict.vibration)}"
    if verdict.velocity is not None:
        said += f" ({velocity(verdict.velocity)})"
    if verdict.balancers and verdict.alone and is_nothing(verdict.alone):
        said += f", without {verdict.balancers} {millimetres(verdict.alone)}"  # no share of nothing
    elif verdict.on_one_side:
        most = verdict.on_one_side
        which = f"with all {verdict.balancers} on one side of a rotor without unbalance"
        said += f", {percent(verdict.vibration / most)} of {_three(most)} {which}"
    elif verdict.balancers and verdict.alone:
        share = percent((size if mostly_other else verdict.vibration) / verdict.alone)
        at = f"; at the rotor's frequency {millimetres(size)}" if mostly_other else ""
        said += f"{at}, {share} of {_three(verdict.alone)} without {verdict.balancers}"
    return said


def _three(size: float) -> str:
    return f"{rounded(1e3 * size, 3)} mm"


def _is_mostly_other(verdict: Verdict) -> bool:
    """Whether the vibration at other frequencies, or a mean, matters beside the rotor's."""
    if verdict.synchronous is None or verdict.vibration is None or is_nothing(verdict.vibration):
        return False
    limit = MATTERS * max(verdict.vibration, 0.05 * (verdict.alone or 0.0))
    return verdict.vibration - verdict.synchronous > limit


def _parts(verdict: Verdict) -> Iterator[str]:
    """The vibration at other frequencies and the mean, where they matter."""
    if verdict.drifts:
        moved = "" if verdict.mean is None else f", by {millimetres(verdict.mean)} now"
        yield (
            f"Nothing holds the machine: it drifts and precesses{moved}, which is no vibration and "
            "not judged."
        )
        return
    if not _is_mostly_other(verdict):
        return
    assert verdict.vibration is not None
    assert verdict.speed is not None
    if verdict.other and verdict.other[1] > MATTERS * verdict.vibration:
        frequency, size = verdict.other
        kind = "a slow precession" if frequency < 0.5 * verdict.speed else "a vibration"
        changes = verdict.other_change if verdict.left_behind is None else None  # it keeps them up
        fades = changes is not None and changes < DECAYS
        decay = ", which decays" if fades else ""
        yield f"Beside it {kind} of {millimetres(size)} at {in_both(frequency, 'rad/s')}{decay}."
    if verdict.mean is not None and verdict.mean > MATTERS * verdict.vibration:
        yield f"Mean displacement {millimetres(verdict.mean)}."


def _unbalance(verdict: Verdict) -> Iterator[str]:
    """What the weights hold, and what is left; of a run whose speed changes only at its end."""
    moment = " at this moment" if verdict.outcome is Outcome.SPEED_CHANGES else ""
    if len(verdict.used) == 1:
        used, most = verdict.used[0][1:]
        yield (
            f"{verdict.balancers.capitalize()} use{moment} {100.0 * used:.0f} % of their capacity "
            f"({readable_unbalance(most)})."
        )
    elif verdict.used:
        parts = (
            f"{name} {100.0 * u:.0f} % of {readable_unbalance(c)}" for name, u, c in verdict.used
        )
        yield f"Capacity in use{moment}: {', '.join(parts)}."
    if verdict.left is not None:
        word = f"left{moment}" if verdict.balancers else "of the rotor"
        yield f"Unbalance {word} {_unbalanced(verdict.left[0])}: {_grade(verdict.left[1])}."


def _unbalanced(value: float) -> str:
    return "below 0.0001 g mm" if value < 1e-10 else readable_unbalance(value)


def _plateaus(verdict: Verdict) -> Iterator[str]:
    """Plateaus before the one that is judged first."""
    for begin, end, one in verdict.plateaus:
        if one.speed is None or (one.speed == verdict.speed and one.after == verdict.after
                                 and one.reason == verdict.reason):  # fmt: skip
            continue
        word = "balanced" if one.balanced else one.reason or "vibration as of the rotor alone"
        size = "" if one.vibration is None else f", vibration {millimetres(one.vibration)}"
        yield (
            f"From {brief(begin, 3)} to {brief(end, 3)} s at {in_both(one.speed, 'rad/s')}: "
            f"{word}{size}."
        )


def _passage(one: Passage) -> str:
    alone = "" if one.alone is None else f" (without balancers {millimetres(one.alone)})"
    return (
        f"From {rounded(one.start)} to {rounded(one.speed)} rad/s within "
        f"{brief(one.end - one.begin, 3)} s: largest vibration {millimetres(one.largest)}{alone}."
    )


def _grade(value: float) -> str:
    """The smallest grade of ISO 21940-11 that permits it."""
    name = next((f"G{grade:g}" for grade in GRADES if value <= grade), "")
    return name or f"above G{GRADES[-1]:g}"
