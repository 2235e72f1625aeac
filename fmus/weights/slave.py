"""The balancer with balls, rollers or pendulums, Filimonikhina 2017 (4), as a unit."""

from __future__ import annotations

import cmath
from typing import NamedTuple

from ...models.contact import motion
from ...models.contact.pulse import discharge
from ...models.contact.track import Track
from ...models.cubic import at, hermite
from ...models.spin import drift
from ...models.weights import Weights, alignment
from ..python.signals import orders
from ..python.slave import Slave
from .variables import BALLS, WeightSizes


class _Now(NamedTuple):
    """The rotor's motion at one time.

    Attributes:
        acceleration, slope: of the plane's centre, rotor frame [m/s^2, m/s^3].
        angle, speed, spin_up, change: of the rotor, each the next one's integral.
    """

    acceleration: complex
    slope: complex
    angle: float
    speed: float
    spin_up: float
    change: float


class BallBalancer(Slave):
    """N equal weights on one track: the acceleration of the track's centre in, force out.

    Its `memory` is the weights' angles and speeds in the rotor; where they may touch, stick or run
    off centre, then whether each touches the next, and impulse owed and pulse given as xi, eta;
    last, how long ago the inputs were set.
    """

    unit = BALLS
    sizes: WeightSizes

    def parameters(self) -> None:
        given = self.parameter_values()
        if self.flag("stop_at_contact"):
            raise ValueError(
                "stop_at_contact = True: must be False, a step of a Python unit cannot end early"
            )
        radius, size = given["track_radius"], given["weight_radius"]
        self.model = Weights(
            self.sizes.weights, given["mass"], radius, given["drag"], given["kappa"]
        )
        if size >= radius:
            raise ValueError(
                f"weight_radius = {size!r} m: such weights do not fit on a track of radius "
                f"{radius!r} m, which must be larger"
            )
        offset = complex(given["track_offset_xi"], given["track_offset_eta"])
        self.track = Track(
            self.model, size, given["restitution"], given["rolling_resistance"], offset
        )
        # one weight meets nobody
        self.plain = not (self.track.eventful or self.track.offset)
        self.carried = 0.0 if self.flag("inertia_as_force") else self.model.added_mass
        self.sent = self.model.added_mass - self.carried

    def begin(self) -> None:
        start = self.layout.index["weight[1].angle0"]
        self.memory = self.real[start : start + 2 * self.sizes.weights]
        if not self.plain:  # contacts, and impulse owed and pulse given as xi, eta each
            self.memory += motion.first_contacts(self.track, *self._state()[:2]) + [0.0] * 4
        self.memory += [0.0]

    def step(self, step: float) -> None:
        now = self._at(step)
        *signal, angle, speed, spin_up, first, second, third = self.real[self.layout.inputs]
        cubic = orders(signal)
        if self.sizes.frame == "fixed":
            start = _rotating(*cubic[:2], angle, speed)
            cubic = (*start, *hermite(*start, now.acceleration, now.slope, step))
        rates = (first, second, third)
        moved = motion.advance(self.track, *self._state(), cubic, speed, spin_up, step, rates)
        memory = [*moved.angles, *moved.speeds, *moved.contacts]
        if not self.plain:
            owed, pulse = complex(*self.memory[-5:-3]), complex(*self.memory[-3:-1])
            turn = step * (speed + 0.5 * spin_up * step) + drift(rates, step).angle
            owed, pulse = discharge(owed, pulse, moved.impulse, turn, step)
            memory += [owed.real, owed.imag, pulse.real, pulse.imag]
        self.memory = [*memory, step]
        self._put(now)

    def outputs(self) -> None:
        self.memory = [*self.memory[:-1], 0.0]
        self._put(self._at(0.0))

    def observe(self) -> None:
        angles, speeds, _ = self._state()
        moment = motion.static_moment(self.track, angles)
        others = moment.real, moment.imag, alignment(angles)
        self.real[self.layout.observed] = [*angles, *speeds, *others, *self._torque()]

    def _torque(self) -> tuple[float, float]:
        """Torque on the rotor and its slope."""
        now = self._at(self.memory[-1])
        force = self._force(now)
        return motion.torque(
            self.track, *self._state(), now[:2], force, now.speed, now.spin_up, now.change
        )

    def _at(self, time: float) -> _Now:
        """The rotor's motion so long after the inputs were set."""
        *signal, angle, speed, spin_up, first, second, third = self.real[self.layout.inputs]
        acceleration, slope = at(orders(signal), time)
        gone, faster, more, change = drift((first, second, third), time)
        angle += time * (speed + 0.5 * spin_up * time) + gone
        speed += spin_up * time + faster
        if self.sizes.frame == "fixed":
            acceleration, slope = _rotating(acceleration, slope, angle, speed)
        return _Now(acceleration, slope, angle, speed, spin_up + more, change)

    def _state(self) -> tuple[list[float], list[float], list[float]]:
        """Angles, speeds and contacts of the weights; no contacts where there can be none."""
        n, memory = self.sizes.weights, self.memory
        return memory[:n], memory[n : 2 * n], [] if self.plain else memory[2 * n : 3 * n]

    def _force(self, now: _Now) -> tuple[complex, complex]:
        """Residual force of the weights and its slope, rotor frame, without pulses."""
        return motion.reaction(
            self.track, *self._state(), now.acceleration, now.slope, now.speed, now.spin_up,
            now.change,
        )  # fmt: skip

    def _put(self, now: _Now) -> None:
        """Computed outputs."""
        force, force_slope = self._force(now)
        if not self.plain:
            force += complex(*self.memory[-3:-1])
        if self.sent:
            force -= self.sent * now.acceleration
            force_slope -= self.sent * now.slope
        if self.sizes.frame == "fixed":
            turn = cmath.rect(1.0, now.angle)
            force, force_slope = force * turn, (force_slope + 1j * now.speed * force) * turn
        self.real[self.layout.computed] = [
            force.real,
            force.imag,
            force_slope.real,
            force_slope.imag,
            self.carried,
        ]


def _rotating(
    value: complex, slope: complex, angle: float, speed: float
) -> tuple[complex, complex]:
    """A vector and its slope seen in axes that turn with the rotor."""
    turn = cmath.rect(1.0, -angle)
    return value * turn, (slope - 1j * speed * value) * turn
