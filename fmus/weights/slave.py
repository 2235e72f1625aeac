"""The balancer with balls, rollers or pendulums, Filimonikhina 2017 (4), as a unit."""

from __future__ import annotations

import cmath
from collections.abc import Sequence

from ...models.contact import motion
from ...models.contact.pulse import discharge
from ...models.contact.track import Track
from ...models.weights import Weights, advance, alignment, reaction
from ..python.signals import at, hermite, orders
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
        # one weight meets nobody: point weights on a centred track keep their shorter way
        self.plain = not (self.track.eventful or self.track.offset)
        self.carried = 0.0 if self.flag("inertia_as_force") else self.model.added_mass
        self.sent = self.model.added_mass - self.carried

    def begin(self) -> None:
        start = self.layout.index["weight[1].angle0"]
        self.memory = self.real[start : start + 2 * self.sizes.weights]
        if not self.plain:  # contacts, and impulse owed and pulse given as xi, eta each
            angles, speeds = self.memory[: self.sizes.weights], self.memory[self.sizes.weights :]
            self.memory += motion.first_contacts(self.track, angles, speeds) + [0.0] * 4

    def step(self, step: float) -> None:
        *signal, angle, speed, spin_up = self.real[self.layout.inputs]
        cubic = orders(signal)
        end, end_slope = at(cubic, step)
        speed_end = speed + spin_up * step
        angle_end = angle
        if self.sizes.frame == "fixed":
            angle_end += step * (speed + 0.5 * spin_up * step)
            end, end_slope = _rotating(end, end_slope, angle_end, speed_end)
            cubic = hermite(*_rotating(*cubic[:2], angle, speed), end, end_slope, step)
        count = self.sizes.weights
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
        if self.sizes.frame == "fixed":
            acceleration, slope = _rotating(acceleration, slope, angle, speed)
        self._put(acceleration, slope, angle, speed, spin_up)

    def observe(self) -> None:
        angles = self.memory[: self.sizes.weights]
        moment = motion.static_moment(self.track, angles)
        state = self.memory[: 2 * self.sizes.weights]
        self.real[self.layout.observed] = [*state, moment.real, moment.imag, alignment(angles)]

    def _meet(self, cubic: Sequence[complex], speed: float, spin_up: float, step: float) -> None:
        """One step of weights that may touch, stick or run off centre."""
        n, memory = self.sizes.weights, self.memory
        state = memory[:n], memory[n : 2 * n], memory[2 * n : 3 * n]
        moved = motion.advance(self.track, *state, cubic, speed, spin_up, step)
        owed, pulse = complex(*memory[-4:-2]), complex(*memory[-2:])
        turn = step * (speed + 0.5 * spin_up * step)
        owed, pulse = discharge(owed, pulse, moved.impulse, turn, step)
        impulses = [owed.real, owed.imag, pulse.real, pulse.imag]
        self.memory = [*moved.angles, *moved.speeds, *moved.contacts, *impulses]

    def _put(
        self, acceleration: complex, slope: complex, angle: float, speed: float, spin_up: float
    ) -> None:
        """Computed outputs; acceleration and slope in the rotor frame."""
        count = self.sizes.weights
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
            force, force_slope = motion.reaction(
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
