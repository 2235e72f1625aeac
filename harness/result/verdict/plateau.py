"""The verdict at the end of a stretch of a run, with all that is read from the run once."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ....models.arrays import Array
from ....models.harmonic_balance import NoResponse
from ...master.merged import SHORT
from ...master.names import stations
from ...scene.grade import residual_unbalance
from ..sag import complex_motion, from_sag, sag_of
from ..velocity import VELOCITY
from .by_run import about_mean, on_one_side, rule_by_run, vibration_without
from .case import Case, Ruling
from .facts import over_capacity_at_any_speed
from .held import held_at_end, shares_used
from .known import Known
from .lasting import part_sizes
from .outcome import Outcome
from .ran import Ran
from .record import Mask, Record
from .rotor_alone import RotorAlone
from .ruling import rule
from .seen import Vibration, seen
from .stretches import Stretch, driven, motor_angle, prescribed
from .verdict import Verdict
from .words import is_nothing, seconds

MOST_REVOLUTIONS = 1e6  # that are advised
SPARE = 2.0  # revolutions that are advised on top


class Run:
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
        self.motion = complex_motion(self.signals, len(scene.rotor.points))
        self._rotor_alone = RotorAlone(scene, float(self.time[-1]))

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
        until = {name: np.asarray(values)[upto] for name, values in self.ran.signals.items()}
        held = held_at_end(scene, until, self.angle[upto], steady=stretch.steady)
        bare = Verdict(
            self.called,
            vibration,
            self._velocity(upto),
            speed=speed,
            used=shares_used(scene, held) if held else (),
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
            bare = self._with_parts(bare, record, now)
        no_unbalance = not np.any(known.assembly.rotor.unbalance)
        wanted = bool(self.called) and stretch.steady and not no_unbalance
        alone, unknown = vibration_without(known, stretch, self._rotor_alone if wanted else None)
        bare = replace(bare, alone=alone)
        scale = on_one_side(known) if no_unbalance and stretch.steady else alone
        left_open = self._unjudged(bare, stretch, unknown, no_unbalance=no_unbalance and not scale)
        if left_open is not None:
            return left_open
        together = final and any(SHORT in event for event in self.ran.events)
        case = Case(
            known, record, self.called, together, now, before, weights, scale or 0.0, no_unbalance
        )
        by_run = stretch.steady and (bool(unknown) or no_unbalance)
        found = None
        if not stretch.steady:
            found = self._changing(stretch, known)
        elif not by_run:
            try:
                found = rule(case)
            except NoResponse:  # with the weights the motion reaches what no formula covers
                by_run = True
        found = found or self._by_run(case, record)
        after = None
        if found.outcome is Outcome.BALANCED:
            after = _after(record, None if by_run else known, case.limit, size)
        turn = stretch.steady and weights is not None and bool(weights.turning.any())
        if found.left_behind is not None or turn:
            # weights that turn in the rotor hold no unbalance
            bare = replace(bare, used=(), left=None)
        reason = found.reason + self._motor_stays(stretch, found)
        bare = replace(
            bare,
            after=after,
            reason=reason,
            outcome=found.outcome,
            remedy=found.outcome.remedy,
            left_behind=found.left_behind,
            on_one_side=scale if no_unbalance else None,
            left_by_race=known.left_by_offsets or None if known.lobes and not by_run else None,
            growth=known.growth.rate if known.growth else None,
            growth_error=known.growth.error if known.growth else None,
            needed=known.reach.needed if known.reach else None,
            capacity=known.reach.capacity if known.reach else None,
        )
        return self._advised(bare, found, final)

    def _unjudged(
        self, bare: Verdict, stretch: Stretch, unknown: str, *, no_unbalance: bool
    ) -> Verdict | None:
        """What cannot be judged without a look at the weights; None: it can.

        Args:
            unknown: why no formula gives the vibration without balancers.
        """
        if no_unbalance:
            reason = "the rotor has no unbalance" * bool(self.called)
            return replace(bare, outcome=Outcome.NO_UNBALANCE, reason=reason)
        if not self.called:
            return replace(bare, outcome=Outcome.NO_BALANCER)
        if not stretch.steady:
            return None
        if bare.alone is None:
            reason = f"{unknown}; and the rotor alone has settled in no run"
            return replace(bare, outcome=Outcome.NO_RESPONSE, reason=reason)
        if unknown and is_nothing(bare.alone):
            reason = "the supports hold the rotor at rest, also without balancers"
            return replace(bare, outcome=Outcome.NO_RESPONSE, reason=reason)
        return None

    def _with_parts(self, bare: Verdict, record: Record, now: Vibration) -> Verdict:
        """With the vibration told apart by frequency."""
        frequency, other = now.largest_other
        whole = math.inf if bare.vibration is None else bare.vibration
        bare = replace(
            bare,
            synchronous=now.size,
            mean=float(np.hypot(*now.mean).max()),
            # in a window that is longer than the last revolution it may have been more
            other=(frequency, min(other, whole)) if now.others else None,
            other_change=now.changes.get(frequency),
        )
        if not self.scene.rotor.is_free:
            return bare
        # where it is and drifts is no vibration
        rate = None if bare.velocity is None else record.speed * now.size / math.sqrt(2.0)
        return replace(bare, vibration=now.size, velocity=rate, drifts=True)

    def _by_run(self, case: Case, record: Record) -> Ruling:
        motion = self.motion[:, np.isin(self.time, record.time)]
        return rule_by_run(case, about_mean(motion, record), part_sizes(record.time, motion))

    def _changing(self, stretch: Stretch, known: Known) -> Ruling:
        """Of a run that ends while the speed still changes; weights that hold too little do so at
        every speed."""
        way = "rises" if stretch.speed > stretch.start else "falls"
        still = f"the speed still {way} at the end of the run"
        too_little = over_capacity_at_any_speed(known)
        if too_little is not None:
            return replace(too_little, reason=f"{too_little.reason}; {still}")
        return Ruling(Outcome.SPEED_CHANGES, still)

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
            reason = f"{verdict.reason}: keep this speed for {seconds(found.seconds, 3)} more"
            return replace(verdict, reason=reason)
        end = float(self.time[-1]) + found.seconds
        turned = self.scene.profile().angle(end) / math.tau + SPARE
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
        names = [f"rotor.{p}{VELOCITY}" for p in stations(len(self.scene.rotor.points))]
        if names[0] not in self.ran.velocity:
            return None
        return max(float(self.ran.velocity[name][upto][-1]) for name in names)


def _after(record: Record, known: Known | None, limit: float, size: Array) -> float:
    """Time from which on the vibration is below the limit [s]: all of it where that is, else that
    of the unbalance left, where that is known."""
    if known and size[record.since(1.0)].max() > limit and record.weights is not None:
        size = known.sizes(record.weights)
    beyond = np.flatnonzero(size > limit)
    first = int(beyond[-1]) + 1 if len(beyond) else 0
    return float(record.time[min(first, len(record.time) - 1)])
