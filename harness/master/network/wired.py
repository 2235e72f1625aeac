"""From connections between units of any origin to their wiring: what fits, and in what form."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ...errors import UnitError
from ...scene.unit import split_port
from ..foreign.abilities import CUBIC, HELD, LINEAR, abilities, kind_of, variable_of
from ..foreign.measures import Incompatible, conversion, measured, measures
from ..names import derivatives
from .wiring import Copied, Inlet, Wire, Wiring

if TYPE_CHECKING:
    from fmpy.model_description import ModelVariable


def wired(units: Mapping[str, Any], wires: Sequence[Wire]) -> Wiring:
    """The wiring of loaded units.

    Raises:
        UnitError: a variable is missing, is no output or input, or types or units of measurement
            do not fit.
    """
    found = Wiring(inlets={name: [] for name in units}, copied={name: [] for name in units})
    by_target: dict[str, list[tuple[str, float]]] = {}
    for wire in wires:
        if _goes_with_value(wire, wires):
            _checked(*_ends(units, wire), wire)
            continue
        source_unit, source = split_port(wire.source)
        target_unit, target = split_port(wire.target)
        sender, taker, *_ = ends = _ends(units, wire)
        gives, takes = _checked(*ends, wire)
        factor = wire.factor * _scale(sender, taker, gives, takes, wire)
        if kind_of(gives.type) == kind_of(takes.type) == "real":
            by_target.setdefault(wire.target, []).append((wire.source, factor))
            continue
        _refuse_scaled(gives, takes, factor, wire)
        if any(one.target == target for one in found.copied[target_unit]):
            raise UnitError(f"{wire.where}.add: {wire.target}: inputs of type Real alone take sums")
        found.copied[target_unit].append(Copied(source_unit, source, target, factor))
    found.signals = list(dict.fromkeys(s for terms in by_target.values() for s, _ in terms))
    place = {signal: k for k, signal in enumerate(found.signals)}
    found.has_slope = [_has_slope(units, signal) for signal in found.signals]
    found.depends = {name: abilities(u.description).depends for name, u in units.items()}
    for port, terms in by_target.items():
        unit, variable = split_port(port)
        own = [split_port(s)[1] for s in found.signals if split_port(s)[0] == unit]
        sums = [(place[source], factor) for source, factor in terms]
        takes_order, by_call = _takes(units[unit], variable)
        direct = _depends(found.depends[unit], own, variable)
        shows = {
            out for out, inputs in found.depends[unit].items() if inputs and variable in inputs
        }
        found.inlets[unit].append(Inlet(variable, sums, takes_order, by_call, direct, shows))
    found.is_direct = [
        any(found.acts(inlet, signal) for inlet in found.inlets[split_port(signal)[0]])
        for signal in found.signals
    ]
    return found


def _goes_with_value(wire: Wire, wires: Sequence[Wire]) -> bool:
    """Whether a connection is that of a derivative whose value is connected too.

    The derivative of an input is taken from where its value is.

    Raises:
        UnitError: it comes from somewhere else.
    """
    value, order = _slope_of(wire.target)
    of_value = [other for other in wires if order and other.target == value]
    if not of_value:
        return False
    source = _slope_of(wire.source)
    if any((other.source, order, other.factor) == (*source, wire.factor) for other in of_value):
        return True
    slope = "{}.der({}" + (f",{order})" if order > 1 else ")")
    wanted = [
        slope.format(*split_port(other.source)) + (f" times {other.factor:g}") * (other.factor != 1)
        for other in of_value
    ]
    raise UnitError(
        f'{wire.where}.to = "{wire.target}": is the derivative of {value}, which '
        f"{' and '.join(other.source for other in of_value)} feeds: it can come from "
        f"{' and '.join(wanted)} alone; leave out this connection, or that of {value}"
    )


def _slope_of(port: str) -> tuple[str, int]:
    """What a port is a derivative of, and of which order: `F` and 2 of `der(F,2)`; 0: of none."""
    unit, name = split_port(port)
    found = re.fullmatch(r"der\((.*?)(?:,\s*(\d+))?\)", name)
    return (f"{unit}.{found[1]}", int(found[2] or 1)) if found else (port, 0)


def _ends(units: Mapping[str, Any], wire: Wire) -> tuple[Any, Any, str, str]:
    """Both units of a wire, and the variables."""
    (sender, source), (taker, target) = split_port(wire.source), split_port(wire.target)
    return units[sender], units[taker], source, target


def _checked(
    sender: Any, taker: Any, source: str, target: str, wire: Wire
) -> tuple[ModelVariable, ModelVariable]:
    """Both variables of a wire, once they can be connected."""
    gives = variable_of(sender, source, f'{wire.where}.from = "{wire.source}"')
    takes = variable_of(taker, target, f'{wire.where}.to = "{wire.target}"')
    if gives.causality != "output":
        raise UnitError(
            f'{wire.where}.from = "{wire.source}": is of causality {gives.causality} in '
            f"{sender.path.name}: only outputs feed inputs{_list_of(sender, 'output')}"
        )
    if takes.causality != "input":
        raise UnitError(
            f'{wire.where}.to = "{wire.target}": is of causality {takes.causality} in '
            f"{taker.path.name}: only inputs are fed{_list_of(taker, 'input')}"
        )
    for port, variable in ((wire.source, gives), (wire.target, takes)):
        if variable.dimensions or kind_of(variable.type) in ("text", "other"):
            what = "an array" if variable.dimensions else f"of type {variable.type}"
            raise UnitError(
                f"{wire.where}: {port} is {what}: numbers and Booleans alone are connected"
            )
    kinds = kind_of(gives.type), kind_of(takes.type)
    if kinds[0] != kinds[1] and kinds != ("integer", "real"):
        raise UnitError(
            f"{wire.where}: {wire.source} is of type {gives.type}, {wire.target} of type "
            f"{takes.type}: types must be the same (an integer may feed a real input)"
        )
    return gives, takes


def _list_of(unit: Any, causality: str) -> str:
    names = [n for n, v in unit.variables.items() if v.causality == causality and "der(" not in n]
    return f"; {causality}s: {', '.join(names[:8])}" + (" ..." if len(names) > 8 else "")


def _scale(
    sender: Any, taker: Any, gives: ModelVariable, takes: ModelVariable, wire: Wire
) -> float:
    """What converts units of measurement."""
    names = measured(gives), measured(takes)
    defined = [measures(u.description).get(n) for u, n in zip((sender, taker), names, strict=True)]
    try:
        return conversion(names[0], names[1], (defined[0], defined[1]))
    except Incompatible as error:
        raise UnitError(
            f"{wire.where}: {wire.source} is in {names[0]}, {wire.target} in {names[1]}: {error}; "
            "connect what measures the same"
        ) from error


def _refuse_scaled(gives: ModelVariable, takes: ModelVariable, factor: float, wire: Wire) -> None:
    if factor != 1.0 and kind_of(takes.type) != "real":
        raise UnitError(
            f"{wire.where}.factor: {wire.source} is of type {gives.type}, which is not multiplied"
        )


def _has_slope(units: Mapping[str, Any], signal: str) -> bool:
    unit, variable = split_port(signal)
    port = units[unit].variables.get(f"der({variable})")
    by_port = port is not None and port.causality == "output"
    by_call = hasattr(units[unit], "derivatives")  # our own units have ports instead
    return by_port or (by_call and abilities(units[unit].description).gives_derivatives)


def _takes(unit: Any, variable: str) -> tuple[int, bool]:
    """Order of what an input can be given over a step, and whether by FMI's function."""
    slots = derivatives(variable, 3)[1:]
    ports = [name in unit.variables and unit.variables[name].causality == "input" for name in slots]
    if all(ports):
        return CUBIC, False
    if ports[0]:
        return LINEAR, False
    by_call = hasattr(unit, "set_derivatives") and abilities(unit.description).takes_derivatives
    return (CUBIC, True) if by_call else (HELD, False)


def _depends(
    depends: Mapping[str, frozenset[str] | None], outputs: Sequence[str], variable: str
) -> bool | None:
    """Whether one of the outputs depends directly on an input; None where that is not declared.

    Without outputs that are connected, whether one of any does.
    """
    own = [depends.get(output) for output in outputs or depends]
    if any(each is not None and variable in each for each in own):
        return True
    return None if None in own else False
