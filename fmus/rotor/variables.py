"""Variables of the rotor on its supports: those of its kind, planes, drive, motion."""

from __future__ import annotations

import re

from ..unit import Unit
from ..variables import (
    SPIN,
    Variable,
    derivative,
    observed,
    parameter,
    plain_input,
    signal_inputs,
    signal_outputs,
    spin_inputs,
    torque_outputs,
)
from .parameters import PARAMETERS
from .restraints import friction, restraints
from .sizes import RotorSizes


def station(j: int, stations: int) -> str:
    """Prefix of a station's variables; a single station has none."""
    return f"station[{j}]." if stations > 1 else ""


def variables(sizes: RotorSizes) -> list[Variable]:
    """Parameters of the kind, motion at the start, drive, forces on the planes and their answer."""
    stations, planes, axes = sizes.stations, sizes.planes, sizes.axes
    of_kind = PARAMETERS[sizes.kind](sizes)
    forces = [f"plane[{i}].F_{axis}" for i in range(1, planes + 1) for axis in axes]
    carried = [f"plane[{i}].added_mass" for i in range(1, planes + 1)]
    supports = [*restraints(sizes), *friction(sizes)]
    parameters = [*of_kind, *_gravity(), *supports, *_initial(stations)]
    names = tuple(v.name for v in parameters)
    drive = (*carried, "speed", SPIN[0])
    changing = (*carried, "speed", *SPIN[:2])
    accelerations = [f"plane[{i}].a_{axis}" for i in range(1, planes + 1) for axis in axes]
    # the mass is the same along both axes: a force acts along its own axis at once, along the
    # other one in the slope only, through gyroscopic or (in the rotor) anisotropic damping
    along = [forces[axis::2] for axis in range(2)]
    crossed = sizes.kind in ("two_support", "matrices") or sizes.frame == "rotor"
    at_once = [(*drive, *own) for own in along]
    in_slope = [
        (*changing, *(forces if crossed else own), *(f"der({name})" for name in own))
        for own in along
    ]
    slopes = [derivative(name, 1) for name in forces]
    text = "Mass of the balancers on this plane that the rotor carries over the step"
    return [
        *parameters,
        *(plain_input(name, 0.0, "kg", text, minimum=0.0) for name in carried),
        *spin_inputs(),
        *signal_inputs(forces, "force", "Force on the plane"),
        *signal_outputs(
            accelerations, "acceleration", "Acceleration of the plane, less gravity",
            at_once * planes, in_slope * planes, begins=names,
        ),
        *_observed(stations, planes, of_kind),
        *_friction_forces(sizes),
        *_stop_forces(sizes),
        *_forces(sizes, of_kind),
        *torque_outputs(
            (*drive, *forces), (*changing, *forces, *slopes), names,
            "Torque of unbalance and internal damping on the shaft",
        ),
    ]  # fmt: skip


def _gravity() -> list[Variable]:
    text = "Gravity across the axis; a horizontal rotor has -9.81 along y"
    return [parameter(f"gravity_{axis}", 0.0, "m/s2", text) for axis in "xy"]


def _initial(stations: int) -> list[Variable]:
    return [
        parameter("angle0", 0.0, "rad", "Angle of the rotor at the start"),
        *(
            parameter(f"{station(j, stations)}{what}{axis}0", 0.0, unit,
                      f"{text} of the rotor along {axis} at the start", quantity=text)
            for what, unit, text in (("", "m", "Displacement"), ("v", "m/s", "Velocity"))
            for j in range(1, stations + 1)
            for axis in "xy"
        ),
    ]  # fmt: skip


def _observed(stations: int, planes: int, own: list[Variable]) -> list[Variable]:
    """Outputs for people and records, computed when they are read."""
    # lengths along the shaft: where a plane is between the stations, and what line bending is from
    shaft = tuple(v.name for v in own if v.name == "span" or v.name.endswith("].z"))
    supports = tuple(v.name for v in own if re.fullmatch(r"support\[.\]\.position", v.name))
    placed = any(v.name == "plane[1].position" for v in own)
    places = [f"{station(j, stations)}{axis}" for j in range(1, stations + 1) for axis in "xy"]
    starts = tuple(f"{place}0" for place in places)
    outputs = [observed("angle", "rad", "Angle turned by the rotor", ("angle0",))]
    outputs += [
        _displacement(place, f"Displacement of the rotor along {place[-1]}", (f"{place}0",))
        for place in places
    ]
    for place in places:
        speed = f"{place[:-1]}v{place[-1]}"
        outputs.append(
            observed(
                speed,
                "m/s",
                f"Velocity of the rotor along {place[-1]}",
                (f"{speed}0",),
                derivative_of=place,
            )
        )
    for i in range(1, planes + 1):
        for axis in "xy":
            begins = tuple(start for start in starts if start.endswith(f"{axis}0"))
            begins += (*shaft, f"plane[{i}].position") if placed else ()
            outputs.append(
                _displacement(
                    f"plane[{i}].{axis}", f"Displacement of the plane along {axis}", begins
                )
            )
    begins = (*starts, *(shaft if supports else ()), *supports)
    return [*outputs, _displacement("bending", "Largest bending of the shaft", begins)]


def _friction_forces(sizes: RotorSizes) -> list[Variable]:
    text = "Friction force on the rotor at the end of the step"
    return [
        observed(f"slider[{k}].force_{axis}", "N", text, (
            f"slider[{k}].support",
            *(f"slider_row_{axis}[{k},{j}]" for j in range(1, sizes.stations + 1)
              if sizes.kind == "matrices"),
            *(f"slider[{k}].{of}_{axis}" for of in ("limit", "stiffness", "free_stroke", "centre")),
            *(f"{station(j, sizes.stations)}v{axis}0" for j in range(1, sizes.stations + 1)),
        ))
        for k in range(1, sizes.sliders + 1)
        for axis in "xy"
    ]  # fmt: skip


def _stop_forces(sizes: RotorSizes) -> list[Variable]:
    n = range(1, sizes.stations + 1)
    motion = [f"{station(j, sizes.stations)}{v}{a}0" for v in ("", "v") for j in n for a in "xy"]
    found = []
    for k in range(1, sizes.stops + 1):
        own = [f"stop[{k}].{name}" for name in ("gap", "stiffness", "damping")]
        begins = (*own, *(f"stop_row_{axis}[{k},{j}]" for j in n for axis in "xy"), *motion)
        texts = [
            (f"force_{axis}", "N", f"Force of the stop on the rotor along {axis}") for axis in "xy"
        ]
        texts += [
            ("largest_force", "N", "Largest force of the stop so far"),
            ("touches", "1", "How often the rotor has come to touch the stop"),
        ]
        found += [observed(f"stop[{k}].{name}", unit, text, begins) for name, unit, text in texts]
    return found  # fmt: skip


def _forces(sizes: RotorSizes, own: list[Variable]) -> list[Variable]:
    """On what supports and feet stand on."""
    numbers, motion = range(1, sizes.stations + 1), ("", "v")
    starts = tuple(
        f"{station(j, sizes.stations)}{what}{axis}0" for j in numbers for what in motion
        for axis in "xy"
    )  # fmt: skip
    # all of them: where a station, support or table is decides which motion the force is of
    held = [*friction(sizes), *restraints(sizes)]
    begins = (*(v.name for v in own), *(v.name for v in held), *starts)
    text = "Force of springs, dampers, friction and stops on what it stands on, along {}"
    return [
        observed(f"{name}.force_{axis}", "N", text.format(axis), begins)
        for name in sizes.forces
        for axis in "xy"
    ]


def _displacement(name: str, description: str, begins: tuple[str, ...]) -> Variable:
    return observed(name, "m", description, begins, quantity="Displacement")


ROTOR = Unit(
    name="RotorOnSupports",
    summary="Linear rotor with n stations and p planes; exact step at constant speed.",
    sizes=RotorSizes,
    variables=variables,
)
