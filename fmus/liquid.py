"""The liquid balancer of Dubovik 2006 as a unit."""

from __future__ import annotations

from ..models.liquid import Liquid
from .signals import FRAMES, at, orders
from .slave import Unit
from .variables import Variable, output, parameter, plain_input, signal_inputs, signal_names

_MOTION = ("m/s2", "m/s3", "m/s4", "m/s5")
_LIQUID = ("chamber_radius", "height", "density")


class LiquidBalancer(Unit):
    """Chamber, float and liquid: the acceleration of the chamber's centre in, force out."""

    frame = "rotor"

    @classmethod
    def variables(cls) -> list[Variable]:
        xi, eta = FRAMES[cls.frame]
        a = (f"a_{xi}", f"a_{eta}")
        force = (f"F_{xi}", f"F_{eta}")
        slope = signal_names(a, 2)[2:]
        sizes = (*_LIQUID, "inertia_as_force")
        return [
            parameter("chamber_radius", 0.05, "m", "Radius r1", minimum=0.0, above=True),
            parameter(
                "float_radius", 0.04, "m", "Radius r2, less than r1", minimum=0.0, above=True
            ),
            parameter("height", 0.02, "m", "Height h of the chamber", minimum=0.0, above=True),
            parameter("density", 1000.0, "kg/m3", "Of the liquid", minimum=0.0, above=True),
            parameter("inertia_as_force", False, "", "True: r m2 acts in F and added_mass is zero"),
            *signal_inputs(a, _MOTION, "Acceleration of the chamber's centre"),
            plain_input("x", 0.0, "m", "Displacement of the chamber's centre, for the clearance"),
            plain_input("y", 0.0, "m", "Displacement of the chamber's centre, for the clearance"),
            *(
                output(f, "N", "Force on the rotor", depends=(a[i],), begins=sizes, kind="fixed")
                for i, f in enumerate(force)
            ),
            *(
                output(
                    f"der({f})",
                    "N/s",
                    f"Exact slope of {f}",
                    depends=(slope[i],),
                    begins=sizes,
                    kind="fixed",
                    derivative_of=f,
                )
                for i, f in enumerate(force)
            ),
            output(
                "added_mass",
                "kg",
                "Mass r m2 to be carried by the rotor",
                variability="discrete",
                begins=sizes,
            ),
            output(
                "liquid_mass",
                "kg",
                "Mass m2 of the liquid",
                variability="discrete",
                begins=(*_LIQUID, "float_radius"),
            ),
            output(
                "clearance",
                "m",
                "Gap r1 - r2 minus bending; the model is valid while it is positive",
                depends=("x", "y"),
                begins=("chamber_radius", "float_radius"),
            ),
        ]

    def parameters(self) -> None:
        self.liquid = Liquid(*self.real[:4])
        self.carried = 0.0 if self.flag("inertia_as_force") else self.liquid.added_mass
        self.sent = self.liquid.added_mass - self.carried

    def begin(self) -> None:
        self.memory = []

    def step(self, step: float) -> None:
        self._put(step)

    def outputs(self) -> None:
        self._put(0.0)

    def _put(self, t: float) -> None:
        """Outputs with the input signals taken t after the start of the step."""
        layout, real = self.layout, self.real
        *signal, x, y = real[layout.inputs]
        acceleration, slope = at(orders(signal), t)
        if self.sent:
            force, force_slope = -self.sent * acceleration, -self.sent * slope
        else:
            force = force_slope = 0j
        clearance = self.liquid.clearance(complex(x, y))
        if clearance < 0.0:
            self.warn_once(
                "clearance",
                f"bending {abs(complex(x, y)):g} m exceeds the gap {self.liquid.gap:g} m: the float"
                " touches the chamber and the model is invalid",
                self.time + t,
            )
        real[layout.computed] = [
            force.real,
            force.imag,
            force_slope.real,
            force_slope.imag,
            self.carried,
            self.liquid.liquid_mass,
            clearance,
        ]
