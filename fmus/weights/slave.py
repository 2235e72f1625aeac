"""The balancer with balls, rollers or pendulums as points, Filimonikhina 2017 (4), as a unit."""

from __future__ import annotations

from typing import NamedTuple

from ...models import cubic
from ...models.steps.weights import advance, reaction
from ...models.weights import Weights, alignment, static_moment
from ..python.signals import Signal, cubic_of, rotating
from ..python.slave import Slave
from .variables import BALLS, WeightSizes


class _Now(NamedTuple):
    """The rotor's motion at one time.

    Attributes:
        motion: acceleration of the plane's centre in the rotor frame, and its slope.
        angle, speed, spin_up: of the rotor.
    """

    motion: Signal
    angle: float
    speed: float
    spin_up: float


class BallBalancer(Slave):
    """N equal weights on one track: the acceleration of the track's centre in, force out.

    Its `memory` is the weights' angles and speeds in the rotor.
    """

    unit = BALLS
    sizes: WeightSizes

    def parameters(self) -> None:
        given = self.parameter_values()
        mass, radius, drag, kappa = (
            given[name] for name in ("mass", "track_radius", "drag", "kappa")
        )
        self.model = Weights(self.sizes.weights, mass, radius, drag, kappa)
        self.carried = 0.0 if self.flag("inertia_as_force") else self.model.added_mass
        self.sent = self.model.added_mass - self.carried

    def begin(self) -> None:
        start = self.layout.index["weight[1].angle0"]
        self.memory = self.real[start : start + 2 * self.sizes.weights]

    def step(self, step: float) -> None:
        start, end = self._at(0.0), self._at(step)
        signal = cubic_of(self.real[self.layout.inputs][:8])
        if self.sizes.frame == "fixed":
            signal = (*start.motion, *cubic.hermite(*start.motion, *end.motion, step))
        angles, speeds = advance(self.model, *self._state(), signal, start.spin_up, step)
        self.memory = [*angles, *speeds]
        self._set_outputs(end)

    def outputs(self) -> None:
        self._set_outputs(self._at(0.0))

    def observe(self) -> None:
        angles, speeds = self._state()
        moment = static_moment(self.model, angles)
        self.real[self.layout.observed] = [
            *angles, *speeds, moment.real, moment.imag, alignment(angles)
        ]  # fmt: skip

    def _at(self, time: float) -> _Now:
        """The rotor's motion so long after the inputs were set."""
        *signal, angle, speed, spin_up, _, _, _ = self.real[self.layout.inputs]
        motion = cubic.at(cubic_of(signal), time)
        angle += time * (speed + 0.5 * spin_up * time)
        speed += spin_up * time
        if self.sizes.frame == "fixed":
            motion = rotating(motion, angle, speed)
        return _Now(motion, angle, speed, spin_up)

    def _state(self) -> tuple[list[float], list[float]]:
        """Angles and speeds of the weights."""
        n = self.sizes.weights
        return self.memory[:n], self.memory[n:]

    def _set_outputs(self, now: _Now) -> None:
        """Computed outputs."""
        force = reaction(self.model, *self._state(), *now.motion, now.speed, now.spin_up)
        if self.sent:
            force = force[0] - self.sent * now.motion[0], force[1] - self.sent * now.motion[1]
        if self.sizes.frame == "fixed":
            force = rotating(force, -now.angle, -now.speed)
        parts = [part for f in force for part in (f.real, f.imag)]
        self.real[self.layout.computed] = [*parts, self.carried]
