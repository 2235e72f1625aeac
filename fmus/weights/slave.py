"""The balancer with balls, rollers or pendulums, Filimonikhina 2017 (4), as a unit."""

from __future__ import annotations

import cmath
from collections.abc import Sequence
from typing import NamedTuple

from ...models import cubic, quintic, quintic_weights
from ...models.contact import motion
from ...models.contact.centre import Instant, shifted
from ...models.contact.pulse import discharge
from ...models.contact.torque import torque
from ...models.contact.track import Track
from ...models.spin import drift
from ...models.weights import Weights, alignment
from ..python.signals import derivatives_at, orders
from ..python.slave import Slave
from .variables import BALLS, WeightSizes


class _Now(NamedTuple):
    """The rotor's motion at one time.

    Attributes:
        motion: acceleration of the plane's centre in the rotor frame, its slope and, with signals
            of order 5, its second derivative [m/s^2, m/s^3, ...].
        angle, speed, spin_up, change, curvature: of the rotor, each the next one's integral.
    """

    motion: tuple[complex, ...]
    angle: float
    speed: float
    spin_up: float
    change: float
    curvature: float


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
        quintic = self.sizes.order == 5
        if quintic and self.track.eventful:
            raise ValueError(
                "order = 5: only point weights have such signals; "
                "weight_radius and rolling_resistance must be 0"
            )
        # one weight meets nobody
        self.plain = quintic or not (self.track.eventful or self.track.offset)
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
        track = orders(signal)
        if self.sizes.frame == "fixed":
            start = _rotating(track[: len(now.motion)], angle, speed, spin_up)
            track = (*start, *_joined(start, now.motion, step))
        rates = (first, second, third)
        if self.sizes.order == 5:
            angles, speeds, _ = self._state()
            track = shifted(track, self.track.offset, speed, spin_up, rates)
            angles, speeds = quintic_weights.advance(
                self.model, angles, speeds, track, spin_up, step, rates
            )
            self.memory = [*angles, *speeds, step]
            self._put(now)
            return
        moved = motion.advance(self.track, *self._state(), track, speed, spin_up, step, rates)
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
        seen = Instant(now.motion[0], now.motion[1], now.speed, now.spin_up)
        return torque(self.track, *self._state(), seen, now.change, self._force(now))

    def _at(self, time: float) -> _Now:
        """The rotor's motion so long after the inputs were set."""
        *signal, angle, speed, spin_up, first, second, third = self.real[self.layout.inputs]
        seen = derivatives_at(orders(signal), time)
        gone, faster, more, change = drift((first, second, third), time)
        angle += time * (speed + 0.5 * spin_up * time) + gone
        speed += spin_up * time + faster
        spin_up += more
        if self.sizes.frame == "fixed":
            seen = _rotating(seen, angle, speed, spin_up)
        return _Now(seen, angle, speed, spin_up, change, second + time * third)

    def _state(self) -> tuple[list[float], list[float], list[float]]:
        """Angles, speeds and contacts of the weights; no contacts where there can be none."""
        n, memory = self.sizes.weights, self.memory
        return memory[:n], memory[n : 2 * n], [] if self.plain else memory[2 * n : 3 * n]

    def _force(self, now: _Now) -> tuple[complex, complex]:
        """Residual force of the weights and its slope, rotor frame, without pulses."""
        return motion.reaction(
            self.track,
            *self._state(),
            now.motion[0],
            now.motion[1],
            now.speed,
            now.spin_up,
            now.change,
        )

    def _put(self, now: _Now) -> None:
        """Computed outputs."""
        force: tuple[complex, ...] = self._force(now)
        if len(now.motion) == 3:
            second = motion.reaction_second(
                self.track, *self._state()[:2], now.motion, now.speed, now[3:]
            )
            force = (*force, second)
        if not self.plain:
            force = (force[0] + complex(*self.memory[-3:-1]), *force[1:])
        if self.sent:
            force = tuple(f - self.sent * a for f, a in zip(force, now.motion, strict=True))
        if self.sizes.frame == "fixed":
            force = _rotating(force, -now.angle, -now.speed, -now.spin_up)
        parts = [part for f in force for part in (f.real, f.imag)]
        self.real[self.layout.computed] = [*parts, self.carried]


def _rotating(
    vector: Sequence[complex], angle: float, speed: float, spin_up: float
) -> tuple[complex, ...]:
    """A vector, its slope and its second derivative, if it comes with one, in axes that turn.

    Those of the rotor, or with the negative angle, speed and acceleration the fixed ones.
    """
    turn = cmath.rect(1.0, -angle)
    value, slope = vector[:2]
    seen = value * turn, (slope - 1j * speed * value) * turn
    if len(vector) == 2:
        return seen
    return *seen, (vector[2] - 2j * speed * slope - complex(speed * speed, spin_up) * value) * turn


def _joined(start: Sequence[complex], end: Sequence[complex], step: float) -> tuple[complex, ...]:
    """What of a signal over a step follows from its two ends, as derivatives at its start."""
    if len(start) == 2:
        return cubic.hermite(start[0], start[1], end[0], end[1], step)
    return quintic.hermite(start, end, step)
