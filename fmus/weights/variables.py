"""Variables of the balancer with balls, rollers or pendulums."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..unit import Sizes, Unit, count, option
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
    torque_outputs,
)

_CARRIED = ("mass", "inertia_as_force")
_FORCE = (
    "mass", "track_radius", "kappa", "drag", "weight_radius", "restitution", "track_mobility",
    "rolling_resistance", "track_offset_xi", "track_offset_eta", "inertia_as_force",
)  # fmt: skip
_TORQUE = "Torque of the weights on the rotor about the plane's centre"
_START = "in the rotor at the start"
_OWN = {"mass": "mass", "drag": "drag", "radius": "weight_radius"}


@dataclass(frozen=True)
class WeightSizes(Sizes):
    """Sizes of a ball balancer.

    Attributes:
        weights: their number.
        unequal: 1: each has a mass, drag and radius of its own.
        lobes: kinds of lobes of a race that is not round.
    """

    weights: int = count(2)
    unequal: int = option()
    lobes: int = count(0)


def variables(sizes: WeightSizes) -> list[Variable]:
    """Parameters, the weights' start, the track's acceleration, the force on the rotor."""
    a = [f"a_{axis}" for axis in sizes.axes]
    force = [f"F_{axis}" for axis in sizes.axes]
    numbers = range(1, sizes.weights + 1)
    angles = tuple(f"weight[{k}].angle0" for k in numbers)
    speeds = tuple(f"weight[{k}].speed0" for k in numbers)
    begins = (*_FORCE, *angles, *speeds)
    ratios = [
        parameter(f"weight[{k}].{what}_ratio", 1.0, "1", f"Ratio of its {what} to {all_of}",
                  minimum=0.0, above=what != "drag", native=True)
        for what, all_of in _OWN.items() for k in numbers if sizes.unequal
    ]  # fmt: skip
    lobes = [v for k in range(1, sizes.lobes + 1) for v in _lobe(f"race[{k}]")]
    begins += tuple(v.name for v in (*ratios, *lobes))
    masses = tuple(r.name for r in ratios if r.name.endswith("mass_ratio"))
    # seen in the rotor's axes the force does not depend on the rotor's angle
    drive = (*(() if sizes.frame == "rotor" else ("angle",)), "speed", SPIN[0])
    values, slopes = (*a, *drive), (*a, *(f"der({name})" for name in a), *drive)
    slopes = (*slopes, SPIN[1])
    return [
        *_parameters(),
        *(
            parameter(name, 2 * math.pi * k / sizes.weights, "rad", f"Angle of the weight {_START}")
            for k, name in enumerate(angles)
        ),
        *(parameter(name, 0.0, "rad/s", f"Speed of the weight {_START}") for name in speeds),
        *ratios,
        *lobes,
        *signal_inputs(a, "acceleration", "Acceleration of the track's centre"),
        plain_input("angle", 0.0, "rad", "Angle of the rotor at the start of the step"),
        *spin_inputs(),
        *signal_outputs(
            force, "force", "Force on the rotor", [values] * 2, [slopes] * 2, begins=begins
        ),
        output(
            "added_mass", "kg", "Mass N m to be carried by the rotor", begins=(*_CARRIED, *masses)
        ),
        *_observed(angles, speeds, (*masses, *(v.name for v in lobes))),
        *torque_outputs(values, slopes, begins, _TORQUE),
    ]


def _lobe(name: str) -> list[Variable]:
    """What says one kind of lobes of a race."""
    return [
        parameter(f"{name}.lobes", 2.0, "1", "Number n of lobes around the race: 2 an oval",
                  minimum=1.0, native=True),
        not_negative(f"{name}.amplitude", 0.0, "m", "Amplitude: half of the peak-to-valley",
                     native=True),
        parameter(f"{name}.angle", 0.0, "rad", "Angle of a lobe in the rotor", native=True),
    ]  # fmt: skip


def _parameters() -> list[Variable]:
    """What is common to all weights."""
    return [
        positive("mass", 0.01, "kg", "Mass m of each weight"),
        positive("track_radius", 0.05, "m", "Radius R of the circle of the weights' centres"),
        parameter(
            "kappa",
            1.4,
            "1",
            "Inertia factor of a weight: 7/5 ball, 3/2 roller, 1 pendulum",
            minimum=1.0,
        ),
        not_negative("drag", 0.05, "N.s/m", "Viscous drag coefficient b of each weight"),
        *_of_contacts(),
        *(
            parameter(
                f"track_offset_{axis}",
                0.0,
                "m",
                f"Offset of the track's centre along {axis}, in the rotor",
                native=True,
            )
            for axis in ("xi", "eta")
        ),
        not_negative(
            "shortest_stopped_step",
            0.0,
            "s",
            "Shortest step that ends at a contact, with stop_at_contact",
            native=True,
        ),
        parameter("inertia_as_force", False, "", "True: N m acts in F and added_mass is zero"),
        parameter(
            "stop_at_contact",
            False,
            "",
            "True: a step ends where weights meet, part, stick or slide",
            native=True,
        ),
    ]


def _of_contacts() -> list[Variable]:
    """What weights that touch, and that stick, have."""
    return [
        not_negative(
            "weight_radius", 0.0, "m", "Radius of each weight; 0: point weights", native=True
        ),
        parameter(
            "restitution",
            0.0,
            "1",
            "Coefficient of restitution of a collision of two weights, 0 to 1",
            minimum=0.0,
            maximum=1.0,
            native=True,
        ),
        not_negative(
            "track_mobility",
            0.0,
            "1/kg",
            "Velocity of the plane for a unit impulse on it, with all masses that it carries; 0: a"
            " track that is held while weights collide",
            native=True,
        ),
        not_negative(
            "rolling_resistance",
            0.0,
            "1",
            "Rolling resistance of a weight over its load; 0: none",
            native=True,
        ),
    ]


def _observed(
    angles: tuple[str, ...], speeds: tuple[str, ...], masses: tuple[str, ...]
) -> list[Variable]:
    """Outputs for people and records, computed when they are read."""
    moment = "Static moment of the weights, sum of m (e + R e^{i theta}), in the rotor"
    spread = "Alignment |sum of e^{2 i theta}|/N: 0 evenly spread, 1 in line"
    return [
        *(observed(angle[:-1], "rad", "Angle of the weight", (angle,)) for angle in angles),
        *(
            observed(speed[:-1], "rad/s", "Speed of the weight", (speed,), derivative_of=angle[:-1])
            for angle, speed in zip(angles, speeds, strict=True)
        ),
        *(
            observed(f"moment_{axis}", "kg.m", moment,
                     ("mass", "track_radius", f"track_offset_{axis}", *masses, *angles))
            for axis in ("xi", "eta")
        ),
        observed("spread", "1", spread, angles),
    ]  # fmt: skip


BALLS = Unit(
    name="BallBalancer",
    summary="N weights on one track: the acceleration of the track's centre in, force out.",
    sizes=WeightSizes,
    variables=variables,
)
