"""From a run to its verdict: its last plateau, each one before, the passages, and a look ahead."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache, partial
from typing import TYPE_CHECKING

from ....models.readable import rounded
from ...master.names import OF_STOPS, displacements
from ...scene import Scene
from .ahead import look_ahead
from .case import DOUBT
from .known import Known
from .lasting import ALIKE_SPEED
from .outcome import Outcome
from .passages import passages
from .plateau import MOST_REVOLUTIONS, SPARE, Run
from .ran import Ran
from .steady import BALANCED
from .stretches import SHORTEST, Stretch
from .verdict import Stopped, Verdict
from .words import millimetres, seconds

if TYPE_CHECKING:
    from ..result import Result

TIME_CONSTANTS_AT_LEAST = 3.0  # that a transient far from balance takes: to 5 %
ALIKE = 1.2  # times a vibration: so near another one is the same to a reader
_OPEN = (Outcome.NOT_SETTLED, Outcome.CANNOT_TELL)
_UNSETTLED = (*_OPEN, Outcome.ANOTHER_MOTION)


def judge(result: Result, scene: Scene) -> Verdict:
    """The verdict on a scene's run."""
    called = _called(scene)
    names = displacements(len(scene.rotor.points))
    missing = [name for name in names if name not in result.signals]
    if scene.operation.motor and "motor.speed" not in result.signals:
        missing.append("motor.speed")
    if scene.guests:
        return Verdict(called, reason=f"the equations of {', '.join(scene.guests)} are not known")
    if missing:
        return Verdict(called, reason=f"{', '.join(missing)} not recorded")
    ran = Ran(
        scene, result.time, result.signals, result.velocity, result.events, result.passes,
        bool(result.calls),
    )  # fmt: skip
    run = Run(ran, called)
    stretches = run.stretches
    plateaus = [s for s in stretches if s.steady and s.speed and s.revolutions >= SHORTEST]
    last = stretches[-1]
    judged = last if last.steady and (last.speed or not plateaus) else None
    judged = judged or (plateaus[-1] if plateaus and not last.speed else last)
    verdict = run.judge(judged)
    verdict = _with_least(_looked_ahead(run, verdict, judged), scene, judged)
    thin = [
        float(values.max()) for name, values in result.signals.items() if name.endswith(".thinness")
    ]
    verdict = replace(verdict, thinness=max(thin, default=None), stops=_stopped(result, scene))
    if len(stretches) == 1:
        return verdict
    each = tuple((p.begin, p.end, verdict if p is judged else run.judge(p)) for p in plateaus)
    return replace(
        verdict, plateaus=each, passages=passages(scene, run.stretches, run.time, run.size)
    )


def _judged(called: str, ran: Ran) -> tuple[Run, Verdict]:
    """A run with the verdict on its last stretch."""
    run = Run(ran, called)
    return run, run.judge(run.stretches[-1])


def _are_alike(one: Verdict, other: Verdict) -> bool:
    """Whether two runs show the same, so that smaller errors of steps would not change it.

    A motion that never settles amplifies every error, however small: in every run its weights are
    elsewhere and its vibration at a moment is another one, but its weights are as fast.
    """
    if one.outcome is not other.outcome or one.outcome not in _UNSETTLED:
        return False
    turn = [v.left_behind[0] if v.left_behind else v.speed or 0.0 for v in (one, other)]
    return abs(turn[0] - turn[1]) <= ALIKE_SPEED * abs(one.speed or 0.0)


def _looked_ahead(run: Run, verdict: Verdict, last: Stretch) -> Verdict:
    """The verdict on a stretch with what a longer run shows, where this one leaves it open."""
    motor = run.scene.operation.motor
    low = (verdict.synchronous or math.inf) <= BALANCED * (verdict.alone or 0.0)
    waits = verdict.outcome in _OPEN and last.steady and (verdict.revolutions is None or low)
    goes_on = motor or run.scene.profile().end  # at a speed that is kept
    if not (waits or (goes_on and verdict.outcome is Outcome.SPEED_CHANGES)):
        return verdict
    known = None
    if last.steady:
        known = Known(run.scene, last.end, abs(last.speed))
    judged = lru_cache(maxsize=2)(partial(_judged, run.called))
    found = look_ahead(
        run.ran, last, known, lambda one, other: _are_alike(judged(one)[1], judged(other)[1]),
        all_turn=verdict.left_behind is None,
    )  # fmt: skip
    if found is None:
        return verdict
    ahead, later = judged(found)
    if not last.steady and later.outcome in _OPEN and ahead.stretches[-1].steady:
        later = _looked_ahead(ahead, later, ahead.stretches[-1])  # from a speed that is kept
        if later.revolutions is not None:
            number = later.revolutions
            reason = f"{verdict.reason}: set run.revolutions = {number}"
            return replace(verdict, reason=reason, revolutions=number, remedy="")
    if later.outcome is Outcome.BALANCED:
        if later.after is not None and later.after <= last.end and last.steady:
            return replace(
                verdict,
                outcome=Outcome.BALANCED,
                after=later.after,
                reason="",
                remedy="",
                revolutions=None,
            )
        if verdict.revolutions is not None:
            return verdict
        outcome = Outcome.SPEED_CHANGES if not last.steady else Outcome.NOT_SETTLED
        reason, length = verdict.reason.removesuffix(DOUBT), _first_balanced(ahead, later)
        reason = "not settled yet" if verdict.outcome is Outcome.CANNOT_TELL else reason
        if last.end < float(run.time[-1]):
            further = ahead.scene.profile().time_of(math.tau * length) - last.end
            reason += f": keep this speed for {seconds(further, 3)} more"
            return replace(verdict, outcome=outcome, reason=reason, remedy="")
        reason += f": set run.revolutions = {length}"
        return replace(verdict, outcome=outcome, reason=reason, revolutions=length, remedy="")
    if later.outcome in _OPEN and verdict.revolutions is not None:
        return verdict
    shown = f"a run of {rounded(ahead.scene.revolutions)} revolutions"
    if later.outcome in _OPEN or later.outcome is Outcome.SPEED_CHANGES:
        doubt = f"{verdict.reason.removesuffix(DOUBT)}; {shown} does not show how it ends"
        return replace(verdict, reason=doubt)
    return replace(
        verdict,
        outcome=later.outcome,
        reason=f"{later.reason}, as {shown} shows{_then(later, verdict)}",
        remedy=later.outcome.remedy,
        left_behind=later.left_behind,
        used=verdict.used if later.left_behind is None else (),
        left=verdict.left if later.left_behind is None else None,
    )


def _then(later: Verdict, verdict: Verdict) -> str:
    """The vibration that a longer run ends with, where it is another one."""
    if later.vibration is None or verdict.vibration is None:
        return ""
    low, high = sorted((later.vibration, verdict.vibration))
    return f": the vibration is then {millimetres(later.vibration)}" if high > ALIKE * low else ""


def _first_balanced(run: Run, verdict: Verdict) -> int:
    """Length of a run [revolutions] whose end is already balanced, at most of this one."""
    last = run.stretches[-1]
    turned = run.scene.profile().angle(verdict.after or 0.0) / math.tau
    while True:
        turned = math.ceil(1.1 * turned + SPARE)
        stop = run.scene.profile().time_of(math.tau * turned)
        if not stop < float(run.time[-1]):
            break
        if stop > last.begin and run.judge(replace(last, end=stop)).balanced:
            return turned
    return math.ceil(run.scene.revolutions)


def _with_least(verdict: Verdict, scene: Scene, stretch: Stretch) -> Verdict:
    """A verdict on a transient of unknown length, with the least that it takes."""
    if scene.operation.motor and verdict.outcome is Outcome.SPEED_CHANGES and verdict.remedy:
        return replace(verdict, remedy="run longer, until the motor keeps its speed")
    says_how_long = verdict.revolutions is not None or "keep this speed" in verdict.reason
    if verdict.outcome is not Outcome.NOT_SETTLED or verdict.remedy or says_how_long:
        return verdict
    if verdict.growth is None or verdict.growth >= 0.0 or verdict.left_behind is not None:
        return verdict
    wait = TIME_CONSTANTS_AT_LEAST / -verdict.growth
    turned = scene.profile().angle(stretch.end) / math.tau
    turned += wait * (verdict.speed or 0.0) / math.tau
    remedy = f"it takes at least {math.ceil(min(turned, MOST_REVOLUTIONS))} revolutions"
    if turned > MOST_REVOLUTIONS:
        remedy = "it takes more than a million revolutions: check drag and damping"
    return replace(verdict, remedy=remedy)


def _stopped(result: Result, scene: Scene) -> tuple[Stopped, ...]:
    """What the run makes of every stop; none where that was not recorded."""
    found = []
    for k, stop in enumerate(scene.rotor.stops, start=1):
        force, touches = (f"rotor.stop[{k}].{what}" for what in OF_STOPS)
        if force in result.signals and touches in result.signals:
            count, most = int(result[touches][-1]), float(result[force][-1])
            before = result.counts_before.get(touches)
            before = before if before is None else int(before)
            found.append(Stopped(stop.called, count, most, before))
    return tuple(found)


def _called(scene: Scene) -> str:
    kinds = {balancer.kind for balancer in scene.balancer}
    several = "balancers" if kinds & {"liquid", "ring"} else "weights"
    return kinds.pop() if len(kinds) == 1 else several if kinds else ""
