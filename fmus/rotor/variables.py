"""Variables of the rotor on its supports: those of its kind, planes, drive, motion."""

from __future__ import annotations

import re

from ..unit import Unit
from ..variables import Variable, output, parameter, plain_input, signal_inputs, signal_names
from .parameters import PARAMETERS, RotorSizes

_FORCE = ("N", "N/s", "N/s2", "N/s3")


def station(j: int, stations: int) -> str:
    """Prefix of a station's variables; a single station has none."""
    return f"station[{j}]." if stations > 1 else ""


def variables(sizes: RotorSizes) -> list[Variable]:
    """Parameters of the kind, motion at the start, drive, forces on the planes and their answer."""
    stations, planes, axes = sizes.stations, sizes.planes, sizes.axes
    own = PARAMETERS[sizes.kind](sizes)
    forces = [f"plane[{i}].F_{axis}" for i in range(1, planes + 1) for axis in axes]
    carried = [f"plane[{i}].added_mass" for i in range(1, planes + 1)]
    parameters = [*own, *_initial(stations)]
    names = tuple(v.name for v in parameters)
    drive = (*carried, "speed", "acceleration")
    # whether a force along one axis bears on the slope along the other
    crossed = sizes.kind == "two_support" or sizes.frame == "rotor"
    text = "Mass of the balancers on this plane that the rotor carries; it keeps it over a step"
    return [
        *parameters,
        *(plain_input(name, 0.0, "kg", text, minimum=0.0) for name in carried),
        plain_input("speed", 300.0, "rad/s", "At the start of the step"),
        plain_input("acceleration", 0.0, "rad/s2", "Angular, over the step"),
        *signal_inputs(forces, _FORCE, "Force on the plane"),
        *_planes(axes, planes, forces, drive, names, crossed),
        *_observed(stations, planes, own),
    ]


def _initial(stations: int) -> list[Variable]:
    initial = [parameter("angle0", 0.0, "rad", "Angle of the rotor at the start")]
    for what, unit, text in (("", "m", "Displacement"), ("v", "m/s", "Velocity")):
        initial += [
            parameter(
                f"{station(j, stations)}{what}{axis}0",
                0.0,
                unit,
                f"{text} at the start",
                quantity=text,
            )
            for j in range(1, stations + 1)
            for axis in "xy"
        ]
    return initial


def _planes(
    axes: tuple[str, str],
    planes: int,
    forces: list[str],
    drive: tuple[str, ...],
    begins: tuple[str, ...],
    crossed: bool,
) -> list[Variable]:
    """Accelerations of the planes and their slopes."""
    accelerations = [f"plane[{i}].a_{axis}" for i in range(1, planes + 1) for axis in axes]
    text = "Acceleration of the plane"
    # the mass is the same along both axes: a force acts along its own axis at once, along the
    # other one in the slope only, through gyroscopic or (in the rotor) anisotropic damping
    own = {a: tuple(forces[k % 2 :: 2]) for k, a in enumerate(accelerations)}
    return [
        *(output(a, "m/s2", text, depends=(*drive, *own[a]), begins=begins) for a in accelerations),
        *(
            output(
                f"der({a})",
                "m/s3",
                f"Exact slope of {a}",
                depends=(
                    *drive,
                    *(forces if crossed else own[a]),
                    *signal_names(own[a], 2)[planes:],
                ),
                begins=begins,
                derivative_of=a,
            )
            for a in accelerations
        ),
    ]


def _observed(stations: int, planes: int, own: list[Variable]) -> list[Variable]:
    """Outputs for people and records, computed when they are read."""
    # lengths along the shaft: where a plane is between the stations, and what line bending is from
    shaft = tuple(v.name for v in own if v.name == "span" or v.name.endswith("].z"))
    supports = tuple(v.name for v in own if re.fullmatch(r"support\[.\]\.position", v.name))
    placed = any(v.name == "plane[1].position" for v in own)
    places = [f"{station(j, stations)}{axis}" for j in range(1, stations + 1) for axis in "xy"]
    starts = tuple(f"{place}0" for place in places)
    observed = [output("angle", "rad", "Angle turned", begins=("angle0",), observed=True)]
    observed += [_displacement(place, "Displacement", (f"{place}0",)) for place in places]
    for place in places:
        prefix, axis = place[:-1], place[-1]
        observed.append(
            output(
                f"{prefix}v{axis}",
                "m/s",
                "Velocity",
                begins=(f"{prefix}v{axis}0",),
                derivative_of=place,
                observed=True,
            )
        )
    for i in range(1, planes + 1):
        for axis in "xy":
            begins = tuple(start for start in starts if start.endswith(f"{axis}0"))
            begins += (*shaft, f"plane[{i}].position") if placed else ()
            observed.append(
                _displacement(f"plane[{i}].{axis}", "Displacement of the plane", begins)
            )
    begins = (*starts, *(shaft if supports else ()), *supports)
    return [*observed, _displacement("bending", "Largest bending of the shaft", begins)]


def _displacement(name: str, description: str, begins: tuple[str, ...]) -> Variable:
    return output(name, "m", description, begins=begins, observed=True, quantity="Displacement")


ROTOR = Unit(
    name="RotorOnSupports",
    folder="rotor",
    summary="Linear rotor with n stations and p planes; exact step at constant speed.",
    sizes=RotorSizes,
    variables=variables,
)
