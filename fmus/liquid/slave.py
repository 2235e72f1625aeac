"""The liquid balancer of Dubovik 2006 as a unit."""

from __future__ import annotations

from ...models import cubic
from ...models.liquid import Liquid
from ..python.signals import cubic_of
from ..python.slave import Slave
from .variables import LIQUID


class LiquidBalancer(Slave):
    """Chamber, float and liquid: the acceleration of the chamber's centre in, force out."""

    unit = LIQUID

    def parameters(self) -> None:
        self.liquid = Liquid(**self.parameter_values())
        self.carried = 0.0 if self.flag("inertia_as_force") else self.liquid.added_mass
        self.sent = self.liquid.added_mass - self.carried

    def begin(self) -> None:
        self.memory = []

    def step(self, step: float) -> None:
        self._set_outputs(step)

    def outputs(self) -> None:
        self._set_outputs(0.0)

    def _set_outputs(self, t: float) -> None:
        """Outputs with the input signals taken t after the start of the step."""
        layout, real = self.layout, self.real
        *signal, x, y = real[layout.inputs]
        motion = cubic.at(cubic_of(signal), t)
        force = [-self.sent * a if self.sent else 0j for a in motion]
        clearance = self.liquid.clearance(complex(x, y))
        if clearance < 0.0:
            self.warn_once(
                "clearance",
                f"bending {abs(complex(x, y)):g} m exceeds the gap {self.liquid.gap:g} m: the float"
                " touches the chamber and the model is invalid",
                self.time + t,
            )
        real[layout.computed] = [
            *(part for f in force for part in (f.real, f.imag)),
            self.carried,
            self.liquid.liquid_mass,
            clearance,
        ]
