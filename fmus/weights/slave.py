"""The balancer with balls, rollers or pendulums, Filimonikhina 2017 (4), as a unit."""

from __future__ import annotations

import cmath

from ...models.contact import motion
from ...models.contact.pulse import discharge
from ...models.contact.track import Track
from ...models.cubic import at, hermite
from ...models.weights import Weights, alignment
from ..python.signals import orders
from ..python.slave import Slave
from .variables import BALLS, WeightSizes


class BallBalancer(Slave):
    """N equal weights on one track: the acceleration of the track's centre in, force out.

    Its `memory` is the weights' angles and speeds in the rotor; where they may touch, stick or run
    off centre, then whether each touches the next, and impulse owed and pulse given as xi, eta.
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

    def step(self, step: float) -> None:
        *signal, angle, speed, spin_up = self.real[self.layout.inputs]
        cubic = orders(signal)
        end, end_slope = at(cubic, step)
        speed_end = speed + spin_up * step
        angle_end = angle
        if self.sizes.frame == "fixed":
            angle_end += step * (speed + 0.5 * spin_up * step)
            end, end_slope = _rotating(end, end_slope, angle_end, speed_end)
            start = _rotating(*cubic[:2], angle, speed)
            cubic = (*start, *hermite(*start, end, end_slope, step))
        moved = motion.advance(self.track, *self._state(), cubic, speed, spin_up, step)
        memory = [*moved.angles, *moved.speeds, *moved.contacts]
        if not self.plain:
            owed, pulse = complex(*self.memory[-4:-2]), complex(*self.memory[-2:])
            turn = step * (speed + 0.5 * spin_up * step)
            owed, pulse = discharge(owed, pulse, moved.impulse, turn, step)
            memory += [owed.real, owed.imag, pulse.real, pulse.imag]
        self.memory = memory
        self._put(end, end_slope, angle_end, speed_end, spin_up)

    def outputs(self) -> None:
        *signal, angle, speed, spin_up = self.real[self.layout.inputs]
        acceleration, slope = orders(signal)[:2]
        if self.sizes.frame == "fixed":
            acceleration, slope = _rotating(acceleration, slope, angle, speed)
        self._put(acceleration, slope, angle, speed, spin_up)

    def observe(self) -> None:
        angles, speeds, _ = self._state()
        moment = motion.static_moment(self.track, angles)
        others = moment.real, moment.imag, alignment(angles)
        self.real[self.layout.observed] = [*angles, *speeds, *others]

    def _state(self) -> tuple[list[float], list[float], list[float]]:
        """Angles, speeds and contacts of the weights; no contacts where there can be none."""
        n, memory = self.sizes.weights, self.memory
        return memory[:n], memory[n : 2 * n], memory[2 * n : 3 * n]

    def _put(
        self, acceleration: complex, slope: complex, angle: float, speed: float, spin_up: float
    ) -> None:
        """Computed outputs; acceleration and slope in the rotor frame."""
        force, force_slope = motion.reaction(
            self.track, *self._state(), acceleration, slope, speed, spin_up
        )
        if not self.plain:
            force += complex(*self.memory[-2:])
        if self.sent:
            force -= self.sent * acceleration
            force_slope -= self.sent * slope
        if self.sizes.frame == "fixed":
            turn = cmath.rect(1.0, angle)
            force, force_slope = force * turn, (force_slope + 1j * speed * force) * turn
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
