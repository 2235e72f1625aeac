"""Variables that every kind of rotor shares: planes, drive, motion of the stations."""

from __future__ import annotations

from .variables import Variable, output, parameter, plain_input, signal_inputs, signal_names

_FORCE = ("N", "N/s", "N/s2", "N/s3")


def station(j: int, stations: int) -> str:
    """Prefix of a station's variables; a single station has none."""
    return f"station[{j}]." if stations > 1 else ""


def rotor_variables(
    own: list[Variable], stations: int, planes: int, axes: tuple[str, str], crossed: bool
) -> list[Variable]:
    """All variables of a rotor.

    Args:
        own: parameters of its kind.
        stations, planes: numbers of them.
        axes: names of the axes of the planes' signals.
        crossed: whether a force along one axis bears on the slope along the other.
    """
    forces = [f"plane[{i}].F_{axis}" for i in range(1, planes + 1) for axis in axes]
    carried = [f"plane[{i}].added_mass" for i in range(1, planes + 1)]
    initial = _initial(stations)
    parameters = [*own, *initial]
    names = tuple(v.name for v in parameters)
    drive = (*carried, "speed", "acceleration")
    return [
        *parameters,
        *(
            plain_input(
                name,
                0.0,
                "kg",
                "Mass of the balancers on this plane that the rotor carries",
                variability="discrete",
                minimum=0.0,
            )
            for name in carried
        ),
        plain_input("speed", 300.0, "rad/s", "At the start of the step"),
        plain_input("acceleration", 0.0, "rad/s2", "Angular, over the step"),
        *signal_inputs(forces, _FORCE, "Force on the plane"),
        *_planes(axes, planes, forces, drive, names, crossed),
        *_observed(stations, planes),
    ]


def _initial(stations: int) -> list[Variable]:
    initial = [parameter("angle0", 0.0, "rad", "Angle of the rotor at the start")]
    for what, unit, text in (("", "m", "Displacement"), ("v", "m/s", "Velocity")):
        initial += [
            parameter(f"{station(j, stations)}{what}{axis}0", 0.0, unit, f"{text} at the start")
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


def _observed(stations: int, planes: int) -> list[Variable]:
    """Outputs for people and records, computed when they are read."""
    places = [f"{station(j, stations)}{axis}" for j in range(1, stations + 1) for axis in "xy"]
    starts = tuple(f"{place}0" for place in places)
    observed = [output("angle", "rad", "Angle turned", begins=("angle0",), observed=True)]
    observed += [
        output(place, "m", "Displacement", begins=(f"{place}0",), observed=True) for place in places
    ]
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
            text = "Displacement of the plane"
            observed.append(output(f"plane[{i}].{axis}", "m", text, begins=begins, observed=True))
    text = "Largest bending of the shaft"
    return [*observed, output("bending", "m", text, begins=starts, observed=True)]
