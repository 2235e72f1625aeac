"""Variables of the ring part filled with liquid."""

from __future__ import annotations

from ..unit import Sizes, Unit
from ..variables import (
    SPIN,
    Variable,
    not_negative,
    observed,
    output,
    parameter,
    plain_input,
    positive,
    signal_inputs,
    signal_outputs,
    spin_inputs,
)

_MASS = ("wall_radius", "inner_radius", "height", "density")
_FORCE = (*_MASS, "wave_damping", "viscosity", "inertia_as_force")


def variables(sizes: Sizes) -> list[Variable]:
    """Parameters, the wave's start, acceleration of the ring's centre, force on the rotor."""
    a = [f"a_{axis}" for axis in sizes.axes]
    force = [f"F_{axis}" for axis in sizes.axes]
    waves = [f"{what}_{axis}" for what in ("wave", "wave_speed") for axis in ("xi", "eta")]
    starts = tuple(f"{name}0" for name in waves)
    begins = (*_FORCE, *starts)
    turning = (*(() if sizes.frame == "rotor" else ("angle",)), "speed")
    values = [(name, *turning) for name in a]
    slopes = [(*a, f"der({name})", *turning, SPIN[0]) for name in a]
    return [
        positive("wall_radius", 0.1, "m", "Radius a of the wall"),
        positive("inner_radius", 0.08, "m", "Radius b of the free surface, below a"),
        positive("height", 0.02, "m", "Height h of the ring along the axis"),
        positive("density", 1000.0, "kg/m3", "Density of the liquid"),
        not_negative("wave_damping", 0.0, "1/s", "Damping d of the waves at every speed"),
        not_negative("viscosity", 0.0, "m2/s", "Kinematic viscosity, which damps the waves too"),
        *(
            parameter(name, 0.0, unit, "Wave in the rotor at the start")
            for name, unit in zip(starts, ("m", "m", "m/s", "m/s"), strict=True)
        ),
        parameter("inertia_as_force", False, "", "True: m/(1 + f) acts in F, added_mass is zero"),
        *signal_inputs(a, "acceleration", "Acceleration of the ring's centre"),
        plain_input("angle", 0.0, "rad", "Angle of the rotor at the start of the step"),
        *spin_inputs(),
        *signal_outputs(
            force, "force", "Force on the rotor", values, slopes, begins=begins
        ),
        output(
            "added_mass", "kg", "Mass m/(1 + f) to be carried by the rotor",
            begins=(*_MASS, "inertia_as_force"),
        ),
        output("liquid_mass", "kg", "Mass m of the liquid", begins=_MASS),
        *_observed(waves, starts),
    ]  # fmt: skip


def _observed(waves: list[str], starts: tuple[str, ...]) -> list[Variable]:
    """Outputs for people and records, computed when they are read."""
    place, rate = waves[:2], waves[2:]
    axes = ("xi", "eta")
    return [
        *(observed(n, "m", "Wave y of the liquid in the rotor", (f"{n}0",)) for n in place),
        *(
            observed(n, "m/s", "Speed of the wave in the rotor", (f"{n}0",), derivative_of=of)
            for n, of in zip(rate, place, strict=True)
        ),
        *(
            observed(
                f"moment_{axis}", "kg.m", "Static moment of the liquid about the ring's centre",
                (*_MASS, f"wave_{axis}0"),
            )
            for axis in axes
        ),
        observed(
            "thinness", "1",
            "Part of the layer that the wave takes away where it is thinnest; 1: the wall is dry",
            (*_MASS, *starts[:2]),
        ),
    ]  # fmt: skip


RING = Unit(
    name="RingBalancer",
    summary="A ring part filled with liquid: the acceleration of its centre in, force out.",
    sizes=Sizes,
    variables=variables,
)
