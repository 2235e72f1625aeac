"""From a run to its verdict: its last plateau, each one before, the passages, and a look ahead."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ....models.arrays import Array
from ....models.harmonic_balance import NoResponse
from ...master.merged import SHORT
from ...master.names import stations
from ...scene import Scene
from ...scene.balancer import WeightBalancer
from ...scene.grade import moments, residual_unbalance
from ..sag import from_sag, sag_of
from ..velocity import VELOCITY
from .ahead import look_ahead
from .known import BALANCED, Known
from .outcome import Outcome
from .passages import passages
from .ran import Ran
from .ruling import DOUBT, Case, Ruling, rule
from .seen import Mask, Record, seen
from .stretches import SHORTEST, Stretch, driven, motor_angle, prescribed
from .verdict import Verdict

if TYPE_CHECKING:
    from ..result import Result

MOST_REVOLUTIONS = 1e6  # that are advised
TIME_CONSTANTS_AT_LEAST = 3.0  # that a transient far from balance takes: to 5 %
_SPARE = 2.0  # revolutions that are advised on top
_OPEN = (Outcome.NOT_SETTLED, Outcome.CANNOT_TELL)


def judge(result: Result, scene: Scene) -> Verdict:
    """The verdict on a scene's run."""
    called = _called(scene)
    prefixes = [f"rotor.{prefix}" for prefix in stations(len(scene.rotor.stations))]
    missing = [
        f"{p}{axis}" for p in prefixes for axis in "xy" if f"{p}{axis}" not in result.signals
    ]
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
    run = _Run(ran, called)
    stretches = run.stretches
    plateaus = [s for s in stretches if s.steady and s.speed and s.revolutions >= SHORTEST]
    last = stretches[-1]
    judged = last if last.steady and (last.speed or not plateaus) else None
    judged = judged or (plateaus[-1] if plateaus and not last.speed else last)
    verdict = run.judge(judged)
    verdict = _with_least(run.looked_ahead(verdict, judged), scene, judged)
    if len(stretches) == 1:
        return verdict
    each = tuple((p.begin, p.end, verdict if p is judged else run.judge(p)) for p in plateaus)
    return replace(
        verdict, plateaus=each, passages=passages(scene, run.stretches, run.time, run.size)
    )


def _with_least(verdict: Verdict, scene: Scene, stretch: Stretch) -> Verdict:
    """A verdict on a transient of unknown length, with the least that it takes."""
    if scene.operation.motor and verdict.outcome is Outcome.SPEED_CHANGES and verdict.remedy:
        return replace(verdict, remedy="run longer, until the motor keeps its speed")
    says_how_long = verdict.revolutions is not None or "keep this speed" in verdict.reason
    if verdict.outcome is not Outcome.NOT_SETTLED or verdict.remedy or says_how_long:
        return verdict
    if verdict.growth is None or verdict.growth >= 0.0:
        return verdict
    wait = TIME_CONSTANTS_AT_LEAST / -verdict.growth
    turned = scene.profile().angle(stretch.end) / math.tau
    turned += wait * (verdict.speed or 0.0) / math.tau
    remedy = f"it takes at least {math.ceil(min(turned, MOST_REVOLUTIONS))} revolutions"
    if turned > MOST_REVOLUTIONS:
        remedy = "it takes more than a million revolutions: check drag and damping"
    return replace(verdict, remedy=remedy)


def _called(scene: Scene) -> str:
    kinds = {balancer.kind for balancer in scene.balancer}
    several = "weights" if "liquid" not in kinds else "balancers"
    return kinds.pop() if len(kinds) == 1 else several if kinds else ""


class _Run:
    """A result with what is read from it once."""

    def __init__(self, ran: Ran, called: str) -> None:
        self.ran, self.scene, self.called = ran, ran.scene, called
        self.time, scene = ran.time, ran.scene
        speeds = ran.signals.get("motor.speed")
        self.signals = from_sag(ran.signals, sag_of(scene, self.time, speeds))
        start = scene.run.initial.angle
        if scene.operation.motor:
            speed = np.asarray(ran.signals["motor.speed"])
            self.angle = start + motor_angle(self.time, speed)
            self.stretches = driven(self.time, speed)
        else:
            self.angle = start + scene.profile().angles_at(self.time)
            self.stretches = prescribed(scene, float(self.time[-1]))
        prefixes = [f"rotor.{prefix}" for prefix in stations(len(scene.rotor.stations))]
        self.motion = np.array(
            [self.signals[f"{p}x"] + 1j * self.signals[f"{p}y"] for p in prefixes]
        )

    @property
    def size(self) -> Array:
        """Largest distance of a station from the sag (T,) [m]."""
        return np.asarray(np.abs(self.motion).max(axis=0))

    def judge(self, stretch: Stretch) -> Verdict:
        """The verdict at the end of a stretch."""
        scene, speed = self.scene, abs(stretch.speed)
        upto = self.time <= stretch.end * (1.0 + 1e-12)
        final = bool(upto.all())
        changes = [c.time for c in scene.operation.unbalance_changes if c.time <= stretch.end]
        begin = max([stretch.begin, *changes])
        shown = upto & (self.time >= begin)
        record = Record(
            scene,
            self.time[shown],
            self.angle[shown],
            speed,
            {name: values[shown] for name, values in self.signals.items()},
            Known(scene, stretch.end, speed).natural.tolist() if speed else (),
        )
        vibration, size = self._sizes(record, upto)
        held = self._held(upto)
        bare = Verdict(
            self.called,
            vibration,
            self._velocity(upto),
            speed=speed,
            used=_used(scene, held) if held else (),
            left=residual_unbalance(scene, held, stretch.end, speed) if held is not None else None,
        )
        if not speed:
            return replace(
                bare, outcome=Outcome.STANDSTILL, reason="the rotor stands still at the end"
            )
        return self._ruled(bare, record, size, stretch, final)

    def _ruled(
        self, bare: Verdict, record: Record, size: Array, stretch: Stretch, final: bool
    ) -> Verdict:
        now, before, weights = seen(record)
        angles = None if record.weights is None else record.weights[-1]
        angles = angles if weights is None else weights.angles
        angles = angles if angles is None or len(angles) else None
        known = Known(self.scene, stretch.end, record.speed, angles)
        if now is not None:
            bare = replace(
                bare,
                synchronous=now.size,
                mean=float(np.hypot(*now.mean).max()),
                other=now.largest_other if now.others else None,
            )
        try:
            bare = replace(bare, alone=known.alone)
        except NoResponse as error:
            return replace(bare, outcome=Outcome.NO_RESPONSE, reason=str(error) * bool(self.called))
        if not known.alone:
            reason = "the rotor has no unbalance" * bool(self.called)
            return replace(bare, outcome=Outcome.NO_UNBALANCE, reason=reason)
        if not self.called:
            return replace(bare, outcome=Outcome.NO_BALANCER)
        together = final and any(SHORT in event for event in self.ran.events)
        case = Case(known, record, self.called, together, now, before, weights)
        try:
            found = rule(case) if stretch.steady else self._changing(stretch, known)
        except NoResponse as error:
            return replace(bare, outcome=Outcome.NO_RESPONSE, reason=str(error))
        after = _after(record, known, size) if found.outcome is Outcome.BALANCED else None
        reason = found.reason + self._motor_stays(stretch, found)
        bare = replace(
            bare,
            after=after,
            reason=reason,
            outcome=found.outcome,
            remedy=found.outcome.remedy,
            left_behind=found.left_behind,
            growth=known.growth.rate if known.growth else None,
            growth_error=known.growth.error if known.growth else None,
            needed=known.reach.needed if known.reach else None,
            capacity=known.reach.capacity if known.reach else None,
        )
        return self._advised(bare, found, final)

    def looked_ahead(self, verdict: Verdict, last: Stretch) -> Verdict:
        """The verdict on a stretch with what a longer run shows, where this one leaves it open."""
        motor = self.scene.operation.motor
        low = (verdict.synchronous or math.inf) <= BALANCED * (verdict.alone or 0.0)
        waits = verdict.outcome in _OPEN and last.steady and (verdict.revolutions is None or low)
        if not (waits or (motor and verdict.outcome is Outcome.SPEED_CHANGES)):
            return verdict
        known = None
        if last.steady:
            known = Known(self.scene, last.end, abs(last.speed))
        found = look_ahead(self.ran, last, known)
        if found is None:
            return verdict
        ahead = _Run(found, self.called)
        later = ahead.judge(ahead.stretches[-1])
        if not last.steady and later.outcome in _OPEN and ahead.stretches[-1].steady:
            later = ahead.looked_ahead(later, ahead.stretches[-1])  # from a speed that is kept
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
                    revolutions=None,
                )
            if verdict.revolutions is not None:
                return verdict
            outcome = Outcome.SPEED_CHANGES if not last.steady else Outcome.NOT_SETTLED
            reason, length = verdict.reason.removesuffix(DOUBT), ahead.first_balanced(later)
            if last.end < float(self.time[-1]):
                seconds = ahead.scene.profile().time_of(math.tau * length) - last.end
                reason += f": keep this speed for {seconds:.3g} s more"
                return replace(verdict, outcome=outcome, reason=reason, remedy="")
            reason += f": set run.revolutions = {length}"
            return replace(verdict, outcome=outcome, reason=reason, revolutions=length, remedy="")
        if later.outcome in _OPEN and verdict.revolutions is not None:
            return verdict
        shown = f"a run of {ahead.scene.revolutions:.4g} revolutions"
        if later.outcome in _OPEN or later.outcome is Outcome.SPEED_CHANGES:
            doubt = f"{verdict.reason.removesuffix(DOUBT)}; {shown} does not show how it ends"
            return replace(verdict, reason=doubt)
        return replace(
            verdict,
            outcome=later.outcome,
            reason=f"{later.reason}, as {shown} shows",
            remedy=later.outcome.remedy,
            left_behind=later.left_behind,
        )

    def first_balanced(self, verdict: Verdict) -> int:
        """Length of a run [revolutions] whose end is already balanced, at most of this one."""
        last = self.stretches[-1]
        turned = self.scene.profile().angle(verdict.after or 0.0) / math.tau
        while True:
            turned = math.ceil(1.1 * turned + _SPARE)
            stop = self.scene.profile().time_of(math.tau * turned)
            if not stop < float(self.time[-1]):
                break
            if stop > last.begin and self.judge(replace(last, end=stop)).balanced:
                return turned
        return math.ceil(self.scene.revolutions)

    def _changing(self, stretch: Stretch, known: Known) -> Ruling:
        """Of a run that ends while the speed still changes."""
        way = "rises" if stretch.speed > stretch.start else "falls"
        return Ruling(Outcome.SPEED_CHANGES, f"the speed still {way} at the end of the run")

    def _motor_stays(self, stretch: Stretch, found: Ruling) -> str:
        """What a motor's speed is beside that without load, where it is far below."""
        motor = self.scene.operation.motor
        if motor is None or not stretch.steady or stretch.speed > 0.9 * motor.top_speed:
            return ""
        if found.outcome is Outcome.BALANCED:
            return ""
        return (
            f"; the motor stays at {stretch.speed:.4g} rad/s of {motor.top_speed:.4g} rad/s "
            "without load"
        )

    def _advised(self, verdict: Verdict, found: Ruling, final: bool) -> Verdict:
        """With the length of run after which the rotor is balanced, where it is known."""
        if found.seconds is None or not math.isfinite(found.seconds):
            return verdict
        if not final:
            reason = f"{verdict.reason}: keep this speed for {found.seconds:.3g} s more"
            return replace(verdict, reason=reason)
        end = float(self.time[-1]) + found.seconds
        turned = self.scene.profile().angle(end) / math.tau + _SPARE
        if not turned <= MOST_REVOLUTIONS:
            remedy = "this takes more than a million revolutions: check drag and damping"
            return replace(verdict, remedy=remedy)
        number = math.ceil(turned)
        reason = f"{verdict.reason}: set run.revolutions = {number}"
        return replace(verdict, revolutions=number, reason=reason)

    def _sizes(self, record: Record, upto: Mask) -> tuple[float, Array]:
        """Vibration in the last revolution, and largest distance at every time of the record."""
        last = upto & (self.angle >= self.angle[upto][-1] - math.tau)
        motion = self.motion
        if self.scene.operation.gravity:
            motion = motion - motion[:, last].mean(axis=1, keepdims=True)
        size = np.abs(motion).max(axis=0)
        return float(size[last].max()), size[np.isin(self.time, record.time)]

    def _velocity(self, upto: Mask) -> float | None:
        names = [f"rotor.{p}{VELOCITY}" for p in stations(len(self.scene.rotor.stations))]
        if names[0] not in self.ran.velocity:
            return None
        return max(float(self.ran.velocity[name][upto][-1]) for name in names)

    def _held(self, upto: Mask) -> dict[str, float] | None:
        """What the weights hold, by its signals [kg m]; None where it is not known."""
        names = moments(self.scene)
        if names is None or any(name not in self.ran.signals for name in names):
            return None
        return {name: float(self.ran.signals[name][upto][-1]) for name in names}


def _after(record: Record, known: Known, size: Array) -> float:
    """Time from which on the vibration is below the limit [s]: all of it where that is, else that
    of the unbalance left."""
    if size[record.since(1.0)].max() > known.limit and record.weights is not None:
        size = known.sizes(record.weights)
    beyond = np.flatnonzero(size > known.limit)
    first = int(beyond[-1]) + 1 if len(beyond) else 0
    return float(record.time[min(first, len(record.time) - 1)])


def _used(scene: Scene, held: Mapping[str, float]) -> tuple[tuple[str, float, float], ...]:
    used = []
    for one in scene.balancer:
        assert isinstance(one, WeightBalancer)
        moment = math.hypot(*(held[f"{one.label}.moment_{axis}"] for axis in ("xi", "eta")))
        used.append((one.label, moment / one.capacity, one.capacity))
    return tuple(used)
