"""Variables of a composite: those of its parts under their names, and those of the coupling."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

from ...models.constants import DEFAULT_TOLERANCE
from ..unit import SizedUnit, Sizes, Unit, count, one_of
from ..variables import Variable, output, parameter, plain_input, signal_inputs

VIBRATION = (
    "Half the largest travel of a station along x or y in the last complete revolution; of a free"
    " machine the amplitude that turns with the rotor"
)
RESIDUAL = "Static unbalance of rotor and weights together, the sum of all planes"
CAPACITY = "Largest share that a balancer uses of the unbalance its weights can supply"
BALANCED = "Whether the vibration is at most `vibration_limit`"
_CORNER_TIME = (
    "Time of a corner of the speed profile since the start, ascending;"
    " 0: neither this corner nor those behind it are used"
)
_CORNER_SPEED = "Speed of the rotor at a corner of the speed profile"


@dataclass(frozen=True)
class CompositeSizes(Sizes):
    """Sizes of a composite's own variables.

    Attributes:
        kind: of the drive: prescribed | motor (of limited power, a part of its own).
        planes: of the rotor's unit.
        corners: of a prescribed speed behind `rise_time`.
        unbalances: changes of the rotor's unbalance while it turns.
    """

    kind: str = one_of("prescribed", "motor")
    planes: int = count(1)
    corners: int = count(0, of=("prescribed",))
    unbalances: int = count(0, of=("prescribed",))


def own_variables(sizes: CompositeSizes) -> list[Variable]:
    """Parameters and results of the coupling, a prescribed drive, and forces from outside."""
    return [
        parameter(
            "coupling.tolerance",
            DEFAULT_TOLERANCE,
            "1",
            "Relative error that the motion may have; above 0",
            minimum=0.0,
            maximum=0.1,
        ),
        parameter(
            "coupling.top_speed",
            0.0,
            "rad/s",
            "Speed of the fastest revolution, where it is above the speed at the start",
            minimum=0.0,
        ),
        parameter(
            "vibration_limit",
            0.0,
            "m",
            "Vibration up to which the machine counts as balanced; 0: it never does",
            minimum=0.0,
            quantity="Displacement",
        ),
        *(_drive(sizes) if sizes.kind == "prescribed" else []),
        *_outer_forces(sizes),
        output("rotor.speed", "rad/s", "Speed of the rotor", observed=True),
        output("coupling.steps", "1", "Steps taken by the machine", observed=True),
        output("coupling.error", "1", "Error that all steps so far may have made", observed=True),
        output("vibration", "m", VIBRATION, observed=True, quantity="Displacement"),
        output("residual_unbalance", "kg.m", RESIDUAL, observed=True),
        output("capacity_used", "1", CAPACITY, observed=True),
        output("balanced", "", BALANCED, observed=True, variability="discrete"),
    ]


def _outer_forces(sizes: CompositeSizes) -> list[Variable]:
    """Forces from outside: all values, then all first derivatives, and so on to the third.

    Derivatives are not declared as such: some tools take them for those of states.
    """
    planes = range(1, sizes.planes + 1)
    names = [f"rotor.plane[{i}].F_{axis}" for i in planes for axis in "xy"]
    text = "Force from outside on the plane, along a fixed axis"
    return [replace(v, derivative_of="", quantity="") for v in signal_inputs(names, "force", text)]


def _drive(sizes: CompositeSizes) -> list[Variable]:
    """A speed that the host prescribes, or that follows a profile by itself."""
    return [
        parameter(
            "rise_time",
            0.0,
            "s",
            "Time for which the rotor speeds up by itself from `speed` by `acceleration`,"
            " both as at the start; 0: they are inputs",
            minimum=0.0,
        ),
        *(
            parameter(f"corner[{k}].{key}", 0.0, unit, text, minimum=0.0)
            for k in range(1, sizes.corners + 1)
            for key, unit, text in (("time", "s", _CORNER_TIME), ("speed", "rad/s", _CORNER_SPEED))
        ),
        *(v for k in range(1, sizes.unbalances + 1) for v in _change(f"unbalance_change[{k}].")),
        plain_input("speed", 300.0, "rad/s", "Speed of the rotor at the start of the step"),
        plain_input(
            "acceleration", 0.0, "rad/s2", "Angular acceleration of the rotor over the step"
        ),
    ]


def _change(prefix: str) -> list[Variable]:
    """A change of the rotor's unbalance."""
    when = "Since the start, not below the one before; 0: not used, nor those behind"
    return [
        parameter(f"{prefix}time", 0.0, "s", when, minimum=0.0),
        parameter(f"{prefix}number", 1.0, "1", "Of the rotor's unbalance that changes",
                  minimum=1.0),
        parameter(f"{prefix}amount", 0.0, "kg.m", "Static moment from then on", minimum=0.0),
        parameter(f"{prefix}angle", 0.0, "rad", "Its direction in the rotor"),
    ]  # fmt: skip


COMPOSITE = Unit(
    name="Composite",
    summary="Rotor on supports and its balancers, coupled.",
    sizes=CompositeSizes,
    variables=own_variables,
)


@cache
def variables(parts: tuple[tuple[str, SizedUnit], ...], sizes: CompositeSizes) -> list[Variable]:
    """All variables: parameters of the parts and the coupling's, inputs, outputs alike.

    Start values are the units' own.
    """
    own = own_variables(sizes)
    ours = [[_of_part(name, v) for v in unit.layout.variables] for name, unit in parts]
    declared = []
    for causality in ("parameter", "output"):
        chosen = [v for part in [*ours, own] for v in part if v.causality == causality]
        declared += [v for v in chosen if not v.boolean]
        if causality == "output":
            declared += [v for v in own if v.boolean]
        if causality == "parameter":
            declared += [v for v in own if v.causality == "input"]
    inputs = tuple(v.name for v in declared if v.causality != "output")
    return [replace(v, begins=inputs) if v.causality == "output" else v for v in declared]


def _of_part(name: str, variable: Variable) -> Variable:
    """A variable under the name of its part; outputs wait until they are read."""
    return replace(
        variable,
        name=_named(name, variable.name),
        description=f"{variable.description} ({name})",
        derivative_of=variable.derivative_of and _named(name, variable.derivative_of),
        depends=(),
        begins=(),
        observed=variable.causality == "output",
    )


def _named(part: str, variable: str) -> str:
    """`part.F_xi`, `der(part.F_xi)`."""
    der = "der(" * variable.startswith("der(")
    return f"{der}{part}.{variable.removeprefix(der)}"
