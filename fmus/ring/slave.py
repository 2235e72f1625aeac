"""The ring part filled with liquid as a unit."""

from __future__ import annotations

from ...models import cubic
from ...models.ring import BELIEVED, DRY, WARNED, Ring
from ...models.steps.ring import advance, reaction
from ..python.signals import Signal, cubic_of, rotating
from ..python.slave import Slave
from .variables import RING

_SAID = {
    BELIEVED: "the motion beside the steady one may err by some percent",
    WARNED: "the waves are too large for the model of small waves",
    DRY: "the wall is dry in places and the model of small waves is invalid",
}


class RingBalancer(Slave):
    """Ring and liquid: the acceleration of the ring's centre in, force out.

    Its `memory` is the wave in the rotor, xi and eta, and its rate.
    """

    unit = RING

    def parameters(self) -> None:
        given = self.parameter_values()
        names = ("wall_radius", "inner_radius", "height", "density", "wave_damping", "viscosity")
        self.ring = Ring(*(given[name] for name in names))
        self.carried = 0.0 if self.flag("inertia_as_force") else self.ring.added_mass
        self.sent = self.ring.added_mass - self.carried

    def begin(self) -> None:
        start = self.layout.index["wave_xi0"]
        self.memory = self.real[start : start + 4]

    def step(self, step: float) -> None:
        start, end = self._at(0.0), self._at(step)
        signal = cubic_of(self.real[self.layout.inputs][:8])
        if self.sizes.frame == "fixed":
            signal = (*start[0], *cubic.hermite(*start[0], *end[0], step))
        wave, rate = advance(self.ring, *self._state(), signal, *start[2:], step)
        self.memory = [wave.real, wave.imag, rate.real, rate.imag]
        ratio = self.ring.thinness(wave)
        for limit, said in _SAID.items():
            if ratio > limit:
                self.warn_once(f"thinness {limit}", f"thinness {ratio:.3g}: {said}", self.time)
        self._set_outputs(end)

    def outputs(self) -> None:
        self._set_outputs(self._at(0.0))

    def observe(self) -> None:
        wave, rate = self._state()
        moment = self.ring.wave_inertia * wave
        self.real[self.layout.observed] = [
            wave.real, wave.imag, rate.real, rate.imag, moment.real, moment.imag,
            self.ring.thinness(wave),
        ]  # fmt: skip

    def _at(self, time: float) -> tuple[Signal, float, float, float]:
        """Motion of the centre in the rotor, angle, speed and angular acceleration."""
        *signal, angle, speed, spin_up, _, _, _ = self.real[self.layout.inputs]
        motion = cubic.at(cubic_of(signal), time)
        angle += time * (speed + 0.5 * spin_up * time)
        speed += spin_up * time
        if self.sizes.frame == "fixed":
            motion = rotating(motion, angle, speed)
        return motion, angle, speed, spin_up

    def _state(self) -> tuple[complex, complex]:
        xi, eta, rate_xi, rate_eta = self.memory
        return complex(xi, eta), complex(rate_xi, rate_eta)

    def _set_outputs(self, now: tuple[Signal, float, float, float]) -> None:
        """Computed outputs."""
        motion, angle, speed, spin_up = now
        force = reaction(self.ring, *self._state(), motion, speed, spin_up)
        if self.sent:
            force = force[0] - self.sent * motion[0], force[1] - self.sent * motion[1]
        if self.sizes.frame == "fixed":
            force = rotating(force, -angle, -speed)
        parts = [part for f in force for part in (f.real, f.imag)]
        self.real[self.layout.computed] = [*parts, self.carried, self.ring.liquid_mass]
