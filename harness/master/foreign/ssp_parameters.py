"""Parameters of an SSP file: sets in the description or in files, with prefixes and mappings."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ...errors import UnitError
from .abilities import kind_of
from .ssp_structure import Element, Structure, child, children, parsed, real, tag_of


def set_parameter(found: Structure, path: str, value: Any) -> None:
    """A parameter of a system: of the component in whose path it begins, or one fed by it."""
    for name in found.components:
        if path.startswith(f"{name}."):
            found.start.setdefault(name, {})[path[len(name) + 1 :]] = value
            return
    owner, _, connector = path.rpartition(".")
    if connector not in found.systems.get(owner, ()):
        raise UnitError(
            f"{found.path}: parameter {path!r}: is of no component and no connector; components: "
            f"{', '.join(found.components)}"
        )
    for (element, output), (target, variable), factor in found.wires:
        if (element, output) == (owner, connector) and target in found.components:
            scaled = value * factor if isinstance(value, float) else value
            found.start.setdefault(target, {})[variable] = scaled


def bound(found: Structure, owner: Element) -> Iterator[tuple[str, Any]]:
    """Names and values of the parameters that are bound to a system or a component."""
    for binding in children(child(owner, "ParameterBindings")):
        prefix = binding.get("prefix", "")
        if source := binding.get("source"):
            sets = [parsed(found.path, found.folder, source)]
        else:
            sets = list(children(child(binding, "ParameterValues")))
        mapping = child(binding, "ParameterMapping")
        if mapping is not None and mapping.get("source"):
            entries = list(parsed(found.path, found.folder, mapping.get("source", "")))
        else:
            entries = [
                e for m in children(mapping) for e in (m if tag_of(m) != "MappingEntry" else [m])
            ]
        for one in sets:
            for name, value in _values(found, one):
                yield from _mapped(found, prefix + name, value, entries)


def _mapped(
    found: Structure, name: str, value: Any, entries: list[Element]
) -> Iterator[tuple[str, Any]]:
    """A parameter by the names that a mapping gives it; by its own where there is none."""
    own = [e for e in entries if e.get("source") == name]
    if not own:
        yield name, value
    for entry in own:
        change = child(entry, "LinearTransformation")
        if change is not None and isinstance(value, float):
            factor, offset = (
                real(found, change.get(key, default), f"mapping of {name}: {key}")
                for key, default in (("factor", "1"), ("offset", "0"))
            )
            yield entry.get("target", ""), value * factor + offset
        elif len(list(entry)) and change is None:
            raise UnitError(
                f"{found.path}: mapping of {name}: {tag_of(entry[0])} is not supported: linear "
                "ones of real parameters are"
            )
        else:
            yield entry.get("target", ""), value


def _values(found: Structure, parameter_set: Element) -> Iterator[tuple[str, Any]]:
    for parameter in children(child(parameter_set, "Parameters")):
        name = parameter.get("name", "")
        for value in parameter:
            text, tag = value.get("value", ""), tag_of(value)
            kind = kind_of(tag)
            if kind == "real":
                yield name, real(found, text, f"parameter {name}")
            elif kind == "integer":
                whole = real(found, text, f"parameter {name}")
                if whole != round(whole):
                    raise UnitError(f"{found.path}: parameter {name} = {text}: must be whole")
                yield name, int(whole)
            elif kind == "boolean":
                yield name, text in ("true", "1")
            elif kind == "text":
                yield name, text
            elif tag != "Annotations":
                raise UnitError(
                    f"{found.path}: parameter {name}: type {tag} is not supported: numbers, "
                    "Boolean and String are; leave it out, or set it in the FMU"
                )
