"""The balancer with balls, rollers or pendulums, Filimonikhina 2017 (4), as a unit."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence

# `track` imports the first three when it needs them; by then the folder may be gone
from ..models import events, resistance, ring  # noqa: F401
from ..models import track as tracks
from ..models.pulse import discharge
from ..models.track import Track
from ..models.weights import Weights, advance, reaction, spread
from .signals import FRAMES, at, hermite, orders
from .slave import Unit
from .variables import Variable, output, parameter, plain_input, signal_inputs, signal_names

_MOTION = ("m/s2", "m/s3", "m/s4", "m/s5")
_OPTIONS = (
    "weight_radius",
    "restitution",
    "rolling_resistance",
    "track_offset_xi",
    "track_offset_eta",
)
_FORCE = ("mass", "track_radius", "kappa", "drag", *_OPTIONS, "inertia_as_force")


class BallBalancer(Unit):
    """N equal weights on one track: the acceleration of the track's centre in, force out."""

    frame = "rotor"
    weights = 2

    @classmethod
    def variables(cls) -> list[Variable]:
        xi, eta = FRAMES[cls.frame]
        a = (f"a_{xi}", f"a_{eta}")
        force = (f"F_{xi}", f"F_{eta}")
        numbers = range(1, cls.weights + 1)
        angles = tuple(f"weight[{k}].angle0" for k in numbers)
        speeds = tuple(f"weight[{k}].speed0" for k in numbers)
        begins = (*_FORCE, *angles, *speeds)
        turning = ("angle", "speed")[cls.frame == "rotor" :]
        values, slopes = signal_names(a, 1), signal_names(a, 2)
        return [
            *_parameters(),
            *(
                parameter(
                    angle, 2 * math.pi * k / cls.weights, "rad", "Angle in the rotor at the start"
                )
                for k, angle in enumerate(angles)
            ),
            *(
                parameter(speed, 0.0, "rad/s", "Speed in the rotor at the start")
                for speed in speeds
            ),
            *signal_inputs(a, _MOTION, "Acceleration of the track's centre"),
            plain_input("angle", 0.0, "rad", "Angle of the rotor at the start of the step"),
            plain_input("speed", 300.0, "rad/s", "Of the rotor, at the start of the step"),
            plain_input("acceleration", 0.0, "rad/s2", "Angular, of the rotor, over the step"),
            *(
                output(
                    f,
                    "N",
                    "Force on the rotor",
                    depends=(*values, *turning, "acceleration"),
                    begins=begins,
                )
                for f in force
            ),
            *(
                output(
                    f"der({f})",
                    "N/s",
                    f"Exact slope of {f}",
                    depends=(*slopes, *turning, "acceleration"),
                    begins=begins,
                    derivative_of=f,
                )
                for f in force
            ),
            output(
                "added_mass",
                "kg",
                "Mass N m to be carried by the rotor",
                variability="discrete",
                begins=("mass", "inertia_as_force"),
            ),
            *_observed(angles, speeds),
        ]

    def parameters(self) -> None:
        mass, radius, kappa, drag, size, restitution, rolling, xi, eta = self.real[:9]
        if self.flag("stop_at_contact"):
            raise ValueError(
                "stop_at_contact = True: must be False, a step of a Python unit cannot end early"
            )
        self.model = Weights(self.weights, mass, radius, drag, kappa)
        if size >= radius:
            raise ValueError(
                f"weight_radius = {size!r} m: such weights do not fit on a track of radius "
                f"{radius!r} m, which must be larger"
            )
        self.track = Track(self.model, size, restitution, rolling, complex(xi, eta))
        # one weight meets nobody: point weights on a centred track keep their shorter way
        self.plain = not (self.track.eventful or self.track.offset)
        self.carried = 0.0 if self.flag("inertia_as_force") else self.model.added_mass
        self.sent = self.model.added_mass - self.carried

    def begin(self) -> None:
        start = self.layout.index["weight[1].angle0"]
        self.memory = self.real[start : start + 2 * self.weights]
        if not self.plain:  # contacts, and impulse owed and pulse given as xi, eta each
            angles, speeds = self.memory[: self.weights], self.memory[self.weights :]
            self.memory += tracks.first_contacts(self.track, angles, speeds) + [0.0] * 4

    def step(self, step: float) -> None:
        *signal, angle, speed, spin_up = self.real[self.layout.inputs]
        cubic = orders(signal)
        end, end_slope = at(cubic, step)
        speed_end = speed + spin_up * step
        angle_end = angle
        if self.frame == "fixed":
            angle_end += step * (speed + 0.5 * spin_up * step)
            end, end_slope = _rotating(end, end_slope, angle_end, speed_end)
            cubic = hermite(*_rotating(*cubic[:2], angle, speed), end, end_slope, step)
        count = self.weights
        if self.plain:
            angles, speeds = advance(
                self.model, self.memory[:count], self.memory[count:], cubic, spin_up, step
            )
            self.memory = angles + speeds
        else:
            self._meet(cubic, speed, spin_up, step)
        self._put(end, end_slope, angle_end, speed_end, spin_up)

    def outputs(self) -> None:
        *signal, angle, speed, spin_up = self.real[self.layout.inputs]
        acceleration, slope = orders(signal)[:2]
        if self.frame == "fixed":
            acceleration, slope = _rotating(acceleration, slope, angle, speed)
        self._put(acceleration, slope, angle, speed, spin_up)

    def observe(self) -> None:
        angles = self.memory[: self.weights]
        moment = tracks.static_moment(self.track, angles)
        motion = self.memory[: 2 * self.weights]
        self.real[self.layout.observed] = [*motion, moment.real, moment.imag, spread(angles)]

    def _meet(self, cubic: Sequence[complex], speed: float, spin_up: float, step: float) -> None:
        """One step of weights that may touch, stick or run off centre."""
        n, memory = self.weights, self.memory
        motion = memory[:n], memory[n : 2 * n], memory[2 * n : 3 * n]
        moved = tracks.advance(self.track, *motion, cubic, speed, spin_up, step)
        owed, pulse = complex(*memory[-4:-2]), complex(*memory[-2:])
        turn = step * (speed + 0.5 * spin_up * step)
        owed, pulse = discharge(owed, pulse, moved.impulse, turn, step)
        impulses = [owed.real, owed.imag, pulse.real, pulse.imag]
        self.memory = [*moved.angles, *moved.speeds, *moved.contacts, *impulses]

    def _put(
        self, acceleration: complex, slope: complex, angle: float, speed: float, spin_up: float
    ) -> None:
        """Computed outputs; acceleration and slope in the rotor frame."""
        count = self.weights
        memory = self.memory
        if self.plain:
            force, force_slope = reaction(
                self.model,
                memory[:count],
                memory[count:],
                acceleration,
                slope,
                speed,
                spin_up,
            )
        else:
            force, force_slope = tracks.reaction(
                self.track,
                memory[:count],
                memory[count : 2 * count],
                memory[2 * count : 3 * count],
                acceleration,
                slope,
                speed,
                spin_up,
            )
            force += complex(*memory[-2:])
        if self.sent:
            force -= self.sent * acceleration
            force_slope -= self.sent * slope
        if self.frame == "fixed":
            turn = cmath.rect(1.0, angle)
            force, force_slope = force * turn, (force_slope + 1j * speed * force) * turn
        self.real[self.layout.computed] = [
            force.real,
            force.imag,
            force_slope.real,
            force_slope.imag,
            self.carried,
        ]


def _parameters() -> list[Variable]:
    """What is common to all weights."""
    return [
        parameter("mass", 0.01, "kg", "Of each weight m", minimum=0.0, above=True),
        parameter("track_radius", 0.05, "m", "Of the weights' centres R", minimum=0.0, above=True),
        parameter("kappa", 1.4, "1", "7/5 ball, 3/2 roller, 1 pendulum", minimum=1.0),
        parameter("drag", 0.05, "N.s/m", "Viscous, of each weight, b", minimum=0.0),
        parameter("weight_radius", 0.0, "m", "Of each weight; 0: point weights", minimum=0.0),
        parameter("restitution", 0.0, "1", "Of two weights, rotor held: 0 to 1", minimum=0.0),
        parameter("rolling_resistance", 0.0, "1", "Resistance over load; 0: none", minimum=0.0),
        parameter("track_offset_xi", 0.0, "m", "Of the track's centre, in the rotor"),
        parameter("track_offset_eta", 0.0, "m", "Of the track's centre, in the rotor"),
        parameter("inertia_as_force", False, "", "True: N m acts in F and added_mass is zero"),
        parameter("stop_at_contact", False, "", "True: a step ends behind the first collision"),
    ]


def _observed(angles: tuple[str, ...], speeds: tuple[str, ...]) -> list[Variable]:
    """Outputs for people and records, computed when they are read."""
    observed = [
        *(
            output(angle[:-1], "rad", "Angle in the rotor", begins=(angle,), observed=True)
            for angle in angles
        ),
        *(
            output(
                speed[:-1],
                "rad/s",
                "Speed in the rotor",
                begins=(speed,),
                derivative_of=angle[:-1],
                observed=True,
            )
            for angle, speed in zip(angles, speeds, strict=True)
        ),
    ]
    for axis in ("xi", "eta"):
        moment = ("mass", "track_radius", f"track_offset_{axis}", *angles)
        text = "Sum of m (e + R e^{i theta}), in the rotor"
        observed.append(output(f"moment_{axis}", "kg.m", text, begins=moment, observed=True))
    text = "|sum of e^{2 i theta}|/N: 0 evenly spread, 1 in line"
    return [*observed, output("spread", "1", text, begins=angles, observed=True)]


def _rotating(
    value: complex, slope: complex, angle: float, speed: float
) -> tuple[complex, complex]:
    """A vector and its slope seen in axes that turn with the rotor."""
    turn = cmath.rect(1.0, -angle)
    return value * turn, (slope - 1j * speed * value) * turn
