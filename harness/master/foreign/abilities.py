"""What a unit of any origin can, as its model description says."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ...errors import UnitError
from ...scene.messages import did_you_mean

if TYPE_CHECKING:  # of which the lowest FMPy has other names
    from fmpy.model_description import ModelDescription, ModelVariable

REALS = ("Real", "Float64", "Float32")
INTEGERS = (
    *("Integer", "Enumeration", "Int8", "UInt8", "Int16", "UInt16"),
    *("Int32", "UInt32", "Int64", "UInt64"),
)
CUBIC, LINEAR, HELD = 3, 1, 0


@dataclass(frozen=True)
class Abilities:
    """What the master may ask of a unit.

    Attributes:
        restores_state: it can be rolled back.
        varies_step: its steps may differ in length.
        fixed_step: a length [s] of which each step must be a multiple; 0: any.
        takes_derivatives: of inputs, by FMI 2's fmi2SetRealInputDerivatives.
        gives_derivatives: of outputs, by fmi2GetRealOutputDerivatives or fmi3GetOutputDerivatives.
        only_once: in a process.
        needs_tool: it calls a program on this machine.
        depends: by output, the inputs on which it depends at the same instant; None: not declared.
        first_step: step that the unit suggests [s]; 0: none.
    """

    restores_state: bool
    varies_step: bool
    fixed_step: float
    takes_derivatives: bool
    gives_derivatives: bool
    only_once: bool
    needs_tool: bool
    depends: Mapping[str, frozenset[str] | None]
    first_step: float


def abilities(description: ModelDescription) -> Abilities:
    """Of a unit for co-simulation, by what it declares."""
    kind, old = description.coSimulation, description.fmiVersion.startswith("2.")
    depends: dict[str, frozenset[str] | None] = {
        one.variable.name: None
        if one.dependencies is None
        else frozenset(v.name for v in one.dependencies)
        for one in description.outputs
    }
    experiment = description.defaultExperiment
    return Abilities(
        restores_state=bool(kind.canGetAndSetFMUstate),
        varies_step=bool(kind.canHandleVariableCommunicationStepSize),
        fixed_step=float(kind.fixedInternalStepSize or 0.0),
        takes_derivatives=old and bool(kind.canInterpolateInputs),
        gives_derivatives=int(kind.maxOutputDerivativeOrder or 0) > 0,
        only_once=bool(kind.canBeInstantiatedOnlyOncePerProcess),
        needs_tool=bool(kind.needsExecutionTool),
        depends=depends,
        first_step=float((experiment and experiment.stepSize) or 0.0),
    )


def variable_of(unit: Any, name: str, where: str) -> ModelVariable:
    """A variable of a unit.

    Raises:
        UnitError: there is none; says which are near.
    """
    if name in unit.variables:
        return unit.variables[name]
    known = [n for n in unit.variables if not n.startswith("der(")]
    shown = ", ".join(known[:12]) + (" ..." if len(known) > 12 else "")
    raise UnitError(
        f"{where}: {unit.path.name} has no variable {name!r}{did_you_mean(name, known)}; it has: "
        f"{shown}"
    )


def check_start(unit: Any, start: Mapping[str, Any]) -> None:
    """Refuse start values that the unit does not have, or of another type.

    Raises:
        UnitError: so it is.
    """
    for name, value in start.items():
        variable = variable_of(unit, name, f"{unit.name}.{name}: start")
        allowed = {
            "real": not isinstance(value, (bool, str)),
            "integer": isinstance(value, int) and not isinstance(value, bool),
            "boolean": isinstance(value, bool),
            "text": isinstance(value, str),
        }
        if not allowed.get(kind_of(variable.type), False) or variable.dimensions:
            raise UnitError(
                f"{unit.name}.start: {name} = {value!r}: is of type {variable.type}"
                f"{' (array)' if variable.dimensions else ''} in {unit.path.name}"
            )
        if variable.causality in ("output", "independent") and variable.initial != "exact":
            raise UnitError(
                f"{unit.name}.start: {name}: is an {variable.causality} of {unit.path.name}, "
                "and cannot be set; parameters and inputs can"
            )


def kind_of(variable_type: str) -> str:
    """Real, integer, boolean, text or other: what is converted into what."""
    if variable_type in REALS:
        return "real"
    if variable_type in INTEGERS:
        return "integer"
    return {"Boolean": "boolean", "String": "text"}.get(variable_type, "other")
