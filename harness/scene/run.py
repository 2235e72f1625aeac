"""The [operation], [coupling] and [run] tables of a scene."""

from __future__ import annotations

from cmath import rect
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

from ...models.assembly import SpeedProfile, Start
from ...models.constants import DEFAULT_TOLERANCE
from .nested import Nested
from .quantities import (
    SI,
    Angle,
    NotNegative,
    Positive,
    Real,
    Table,
    Text,
    Whole,
    refusal,
    refuse_unless_one,
)

if TYPE_CHECKING:
    from ...models.motor import Drive, MotorDriven

UNCORRECTED = ("jacobi", "gauss-seidel", "compensated")  # schemes that take one pass
STEPS = ("steps_per_rev", "tolerance")  # one or the other
DRIVES = ("speed", "run_up", "profile", "motor")  # one of them
MOST_CORNERS = 1000  # of a profile; the text of a one-file FMU holds them all
LOOSEST_TOLERANCE = 0.1
TIGHTEST_TOLERANCE = 1e-13  # below, runs at two tolerances differ by nothing: no error is seen
DEFAULT_STEPS = 40  # per revolution: 1e-6 on the two-ball scene with cubic signals
FEWEST_STEPS = 4  # per revolution: fewer do not resolve one
FEWEST_REVOLUTIONS = 1e-9  # a step's square must stay a number


Speed = Annotated[Real, SI("rad/s")]
Torque = Annotated[Real, SI("N m")]


class RunUp(Table):
    """Speed that rises linearly and then stays."""

    start: Annotated[NotNegative, Field(alias="from"), SI("rad/s")]
    """Speed at the start."""
    to: Annotated[Positive, SI("rad/s")]
    """Speed at the end of the rise, and from then on."""
    seconds: Annotated[Positive, SI("s")]
    """Duration of the rise."""


Corner = tuple[Annotated[NotNegative, SI("s")], Annotated[NotNegative, SI("rad/s")]]


class Motor(Table):
    """A motor of limited power, whose torque depends on the speed."""

    inertia: Annotated[Positive, SI("kg m^2")]
    """Of all that turns, unbalance included, about the rotor's centre; without its balancers."""
    stall_torque: Annotated[Positive | None, SI("N m")] = None
    """At standstill; falls in a straight line to 0 at `no_load_speed`."""
    no_load_speed: Annotated[Positive | None, SI("rad/s")] = None
    """Where the torque is 0; with `stall_torque`, or instead of both `table`."""
    table: tuple[tuple[Speed, Torque], ...] = ()
    """Points `[speed, torque]` (rad/s, N m) joined by lines; the last torque is at most 0."""
    start: Annotated[NotNegative, Field(alias="from"), SI("rad/s")] = 0.0
    """Speed at the start."""

    @model_validator(mode="after")
    def _one_of_both(self) -> Motor:
        line = (self.stall_torque, self.no_load_speed)
        if bool(self.table) == (None not in line) or (self.table and line != (None, None)):
            raise refusal(
                "table", "give either table, or stall_torque (N m) and no_load_speed (rad/s)"
            )
        speeds = [speed for speed, _ in self.table]
        if self.table and (len(speeds) < 2 or any(b <= a for a, b in pairwise(speeds))):
            raise refusal("table", "must have two points or more, their speeds ascending")
        if self.table and not (self.table[-1][1] <= 0.0 < self.top_speed):
            raise refusal(
                "table",
                "some torque must be above 0, and the last at most 0, at a speed above 0 rad/s",
            )
        return self

    @property
    def points(self) -> tuple[tuple[float, float], ...]:
        """Of the characteristic: speeds and torques [rad/s, N m]."""
        return self.table or ((0.0, self.stall_torque or 0.0), (self.no_load_speed or 0.0, 0.0))

    @property
    def top_speed(self) -> float:
        """Largest speed at which the motor does not brake [rad/s]."""
        return self.build().top_speed

    def build(self) -> Drive:
        """For the models."""
        from ...models.motor import Drive  # few scenes have one

        speeds, torques = zip(*self.points, strict=True)
        return Drive(self.inertia, speeds, torques)


class UnbalanceChange(Table):
    """A step of the rotor's unbalance during a run: laundry that moves, a blade that breaks."""

    time: Annotated[Positive, SI("s")]
    """When it happens; times must not fall from one change to the next."""
    amount: Annotated[NotNegative, SI("kg m")]
    """Static moment from then on."""
    angle: Angle = 0.0
    """Its direction in the rotor."""
    number: Annotated[Whole, Field(ge=1)] = 1
    """Which of `rotor.unbalances` changes, from 1; of a planar rotor its only one."""


class Operation(Table):
    """How the rotor is driven: at a constant speed, by a run-up, a profile or a motor; gravity."""

    speed: Annotated[Positive | None, SI("rad/s")] = None
    """Constant speed; this, `run_up`, `profile` or `motor`."""
    run_up: Nested[RunUp] | None = None
    """A speed that rises; this, `speed`, `profile` or `motor`."""
    profile: Annotated[tuple[Corner, ...], Field(max_length=MOST_CORNERS)] = ()
    """Corners `[time, speed]` (s, rad/s) joined by lines, from 0 s on, or the name of a CSV file
    with a measured speed; this, `speed`, `run_up` or `motor`."""
    motor: Nested[Motor] | None = None
    """A speed that the torques make; this, `speed`, `run_up` or `profile`."""
    unbalance_changes: Annotated[
        tuple[Nested[UnbalanceChange], ...], Field(max_length=MOST_CORNERS)
    ] = ()
    """Steps of the rotor's unbalance during the run; not with a motor."""
    gravity: Annotated[NotNegative, SI("m/s^2")] = 0.0
    """Across the axis: 9.81 for a horizontal rotor, 0 for a vertical one."""
    gravity_angle: Annotated[Angle | None, SI("rad")] = None
    """Direction of gravity in fixed axes; default: downwards, -pi/2."""

    @model_validator(mode="after")
    def _fits_together(self) -> Operation:
        refuse_unless_one(self, DRIVES)
        times, speeds = zip(*self.profile, strict=True) if self.profile else ((), ())
        if self.profile and (times[0] != 0.0 or any(b <= a for a, b in pairwise(times))):
            raise refusal("profile", "times must ascend from 0 s on")
        if self.profile and (len(times) < 2 or not max(speeds) > 0.0):
            raise refusal("profile", "must have two corners or more, one of them above 0 rad/s")
        if any(b.time < a.time for a, b in pairwise(self.unbalance_changes)):
            raise refusal("unbalance_changes", "times must not fall from one change to the next")
        if self.unbalance_changes and self.motor:
            raise refusal(
                "unbalance_changes", "not with a motor: give speed, run_up or a profile instead"
            )
        return self

    @property
    def field(self) -> complex:
        """Gravity gx + i gy [m/s^2]."""
        if self.gravity_angle is None:
            return complex(0.0, 0.0 - self.gravity)
        return rect(self.gravity, self.gravity_angle)

    @property
    def start_speed(self) -> float:
        """At time 0 [rad/s]."""
        return self.motor.start if self.motor else self.speeds().speed(0.0)

    def drive(self) -> SpeedProfile | MotorDriven:
        """The speed against time, or the motor that makes it."""
        if self.motor is None:
            return self.speeds()
        from ...models.motor import MotorDriven

        return MotorDriven(self.motor.build(), self.motor.start)

    def speeds(self) -> SpeedProfile:
        """Speed against time; of a motor its no-load speed, which scales and steps go by."""
        if self.motor is not None:
            return SpeedProfile.constant(self.motor.top_speed)
        if self.run_up is not None:
            return SpeedProfile.run_up(self.run_up.start, self.run_up.to, self.run_up.seconds)
        if self.profile:
            times, speeds = zip(*self.profile, strict=True)
            return SpeedProfile(times, speeds)
        assert self.speed is not None
        return SpeedProfile.constant(self.speed)


def whole_choice(value: object) -> object:
    """Keep true and 1.0 from passing as 1."""
    if type(value) is not int:
        raise ValueError("must be one of 0 (held), 1 (linear), 3 (cubic Hermite)")
    return value


class Coupling(Table):
    """How the units exchange signals."""

    scheme: Literal["auto", "jacobi", "gauss-seidel", "compensated", "iterated"] = "auto"
    """How separate FMUs guess and correct forces; `auto` looks at the loop gain."""
    tolerance: Annotated[
        Positive | None, Field(ge=TIGHTEST_TOLERANCE, le=LOOSEST_TOLERANCE), SI("")
    ] = None
    """Error the motion may have, of itself; chooses the steps.  This or `steps_per_rev`; default:
    1e-4, unless another scheme, an order or corrections are given."""
    steps_per_rev: Annotated[Whole | None, Field(ge=FEWEST_STEPS, le=1_000_000)] = None
    """Steps of separate FMUs in the fastest revolution; default: 40 where no tolerance is kept.  In
    one piece the machine has its own steps, and rows are at these."""
    order: Annotated[Literal[0, 1, 3], BeforeValidator(whole_choice)] = 3
    """Of the signals of separate FMUs over a step: 0 held, 1 linear, 3 cubic Hermite."""
    corrections: Annotated[Whole | None, Field(ge=0, le=100)] = None
    """Corrector passes of `iterated` of separate FMUs with given steps; default: until the loop has
    converged, with `auto` as few as the loop gain asks for."""
    units: Literal["native", "python"] = "native"
    """Compiled units, or those that run Python: point weights on a track in the centre, supports
    without dry friction, a prescribed speed; several times slower."""

    @property
    def of_separate(self) -> list[str]:
        """Keys that are given and have a meaning for separate FMUs alone."""
        given = {
            "scheme": self.scheme != "auto",
            "order": self.order < 3,
            "steps_per_rev": self.steps_per_rev is not None,
            "corrections": self.corrections is not None,
        }
        return [f"coupling.{key}" for key, is_given in given.items() if is_given]

    @model_validator(mode="before")
    @classmethod
    def _default_steps(cls, values: Any) -> Any:
        if not isinstance(values, dict) or any(values.get(key) is not None for key in STEPS):
            return values
        own = [key for key in ("order", "corrections") if values.get(key) is not None]
        if own or values.get("scheme", "auto") not in ("auto", "iterated"):
            return {**values, "steps_per_rev": DEFAULT_STEPS}
        return {**values, "tolerance": DEFAULT_TOLERANCE}

    @model_validator(mode="after")
    def _fits_together(self) -> Coupling:
        if self.steps_per_rev is not None and self.tolerance is not None:
            raise refusal(
                "steps_per_rev",
                f"give either steps_per_rev or tolerance = {self.tolerance:g}, not both",
            )
        if self.corrections is not None and self.scheme in UNCORRECTED:
            raise refusal(
                "corrections",
                f'scheme = "{self.scheme}" takes one pass: leave corrections out, or take '
                'scheme = "iterated" or "auto"',
            )
        if self.corrections is not None and self.tolerance is not None:
            raise refusal(
                "corrections",
                f"with tolerance = {self.tolerance:g} a step takes as many passes as it needs: "
                "leave corrections out, or give steps_per_rev instead",
            )
        if self.order < 3 and self.scheme == "compensated":
            raise refusal("order", 'must be 3 with scheme = "compensated", which exchanges slopes')
        return self


class Initial(Table):
    """The rotor at the start: every station alike.  Default: at rest, under gravity in the sag."""

    x: Annotated[Real, SI("m")] = 0.0
    """Displacement of every station along x; under gravity from the sag."""
    y: Annotated[Real, SI("m")] = 0.0
    """Displacement of every station along y; under gravity from the sag."""
    vx: Annotated[Real, SI("m/s")] = 0.0
    """Velocity of every station along x."""
    vy: Annotated[Real, SI("m/s")] = 0.0
    """Velocity of every station along y."""
    angle: Angle = 0.0
    """Angle of the rotor."""

    def motion(self) -> Start:
        """The same for the models."""
        return Start(**dict(self))


class Run(Table):
    """How long, from where, and what is recorded."""

    revolutions: Annotated[Real, Field(ge=FEWEST_REVOLUTIONS)] = 20.0
    """Length of the run; with a motor in time, as long as so many take at its no-load speed;
    default of a profile: until its last corner."""
    duration: Annotated[Positive | None, SI("s")] = None
    """Length of the run in time, instead of `revolutions`."""
    record: tuple[Text, ...] | None = None
    """Signals, as `unit.variable`; `[]` records nothing; default: the rotor's `x` and `y`, angles
    and `moment_xi`, `moment_eta` of weights, `clearance` of a liquid."""
    initial: Nested[Initial] = Initial()
    """State of the rotor at the start."""

    @model_validator(mode="after")
    def _one_length(self) -> Run:
        if self.duration is not None and "revolutions" in self.model_fields_set:
            raise refusal(
                "duration", "give either duration (s) or revolutions, not both: both are the length"
            )
        return self
