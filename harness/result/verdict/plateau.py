"""The verdict at the end of a stretch of a run, with all that is read from the run once."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ....models.arrays import Array
from ....models.harmonic_balance import NoResponse
from ...master.merged import SHORT
from ...master.names import stations
from ...scene import Scene
from ...scene.balancer import WeightBalancer
from ...scene.grade import moments, residual_unbalance
from ...units import rounded
from ..sag import from_sag, sag_of
from ..velocity import VELOCITY
from .case import Case, Ruling
from .known import Known
from .outcome import Outcome
from .ran import Ran
from .record import Mask, Record
from .ruling import rule
from .seen import seen
from .stretches import Stretch, driven, motor_angle, prescribed
from .verdict import Verdict

MOST_REVOLUTIONS = 1e6  # that are advised
SPARE = 2.0  # revolutions that are advised on top
TURN_POINTS = 96  # at which the mean over one revolution is taken


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
        prefixes = [f"rotor.{prefix}" for prefix in stations(len(scene.rotor.points))]
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
                other_change=now.changes.get(now.largest_other[0]),
            )
        if now is not None and self.scene.rotor.is_free:  # where it is and drifts is no vibration
            rate = None if bare.velocity is None else record.speed * now.size / math.sqrt(2.0)
            bare = replace(bare, vibration=now.size, velocity=rate, drifts=True)
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
            left_by_race=known.left_by_offsets or None if known.lobes else None,
            growth=known.growth.rate if known.growth else None,
            growth_error=known.growth.error if known.growth else None,
            needed=known.reach.needed if known.reach else None,
            capacity=known.reach.capacity if known.reach else None,
        )
        return self._advised(bare, found, final)

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
            reason = f"{verdict.reason}: keep this speed for {rounded(found.seconds, 3)} s more"
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

    def _held(self, upto: Mask) -> dict[str, float] | None:
        """What the weights hold, by its signals [kg m]; None where it is not known.

        Weights that gravity swings once per revolution hold their mean: what swings with the
        revolution shakes at 0 and twice the rotor's frequency.
        """
        names = moments(self.scene)
        if names is None or any(name not in self.ran.signals for name in names):
            return None
        values = {name: np.asarray(self.ran.signals[name])[upto] for name in names}
        angle = self.angle[upto]
        if not self.scene.operation.gravity or not angle[-1] - angle[0] > math.tau:
            return {name: float(each[-1]) for name, each in values.items()}
        turn = angle[-1] - math.tau * np.linspace(0.0, 1.0, TURN_POINTS, endpoint=False)
        return {name: float(np.interp(turn, angle, each).mean()) for name, each in values.items()}


def _after(record: Record, known: Known, size: Array) -> float:
    """Time from which on the vibration is below the limit [s]: all of it where that is, else that
    of the unbalance left."""
    if size[record.since(1.0)].max() > known.limit and record.weights is not None:
        size = known.sizes(record.weights)
    beyond = np.flatnonzero(size > known.limit)
    first = int(beyond[-1]) + 1 if len(beyond) else 0
    return float(record.time[min(first, len(record.time) - 1)])


def _used(scene: Scene, held: Mapping[str, float]) -> tuple[tuple[str, float, float], ...]:
    """Of each balancer: share of its capacity, and that; without the mass of a track off centre."""
    used = []
    for one in scene.balancer:
        assert isinstance(one, WeightBalancer)
        moment = complex(*(held[f"{one.label}.moment_{axis}"] for axis in ("xi", "eta")))
        about_track = abs(moment - one.device.added_mass * one.offset)
        used.append((one.label, about_track / one.capacity, one.capacity))
    return tuple(used)
