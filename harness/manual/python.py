"""Reference of the Python interface, from signatures and docstrings."""

from __future__ import annotations

import importlib
import inspect
import re
from collections.abc import Iterable, Iterator
from dataclasses import is_dataclass
from typing import Any

from autobalancer.scene import Scene
from autobalancer.system import System, UnitRun
from autobalancer.tables import CalledRotor, Run

from ..output.outcome import Outcome
from ..scene.quantities import Table

PACKAGE = "autobalancer"
# used by the commands alone
INTERNAL = {
    "Scene.refuse_friction",
    "Scene.refuse_restraints",
    "Scene.rest_at",
    "Scene.touched_at_rest",
    "Scene.restrained_assembly",
    "Scene.refuse_changes",
    "Scene.refuse_unrest",
    "Scene.refuse_free",
    "Scene.refuse_guests",
    "Scene.refuse_lobes",
    "Scene.rotor_at",
    "Scatter.about",
    "Scatter.importance",
    "Scatter.quantiles",
    "SystemScatter.about",
    "SystemScatter.importance",
    "SystemScatter.quantiles",
    "RunMap.lines",
    "Fit.warnings",
}
CALLED = {
    "Scene": {"run": Run.__call__, "run.many": Run.many, "rotor": CalledRotor.__call__},
    "System": {"run": UnitRun.__call__, "replace": System.replace, "load": System.load},
}
_SECTION = re.compile(r"^(Args|Returns|Raises|Attributes|Yields|Example|Examples):$")


class _Bare(str):
    """An annotation that a signature shows without quotes."""

    __repr__ = str.__str__


def page() -> str:
    """Markdown of all public names."""
    package = importlib.import_module(PACKAGE)
    lines = [*_docstring(inspect.getdoc(package) or "")]
    for name in sorted(package.__all__):
        lines += _entry(name, getattr(package, name), "##")
    return "\n".join(lines) + "\n"


def _entry(name: str, thing: Any, level: str) -> Iterator[str]:
    """A heading, the signature, the docstring; of a class also its public members."""
    yield from (f"{level} {name}", "")
    is_class = inspect.isclass(thing)
    is_error = is_class and issubclass(thing, Exception)
    is_table = is_class and issubclass(thing, Table)
    if is_table:
        thing.model_rebuild()  # else the signature depends on whether the class was used before
    if callable(thing) and not is_error:
        yield from ("```python", _signature(name.split(".")[-1], thing, is_table), "```", "")
    yield from _docstring(inspect.getdoc(thing) or "")
    if is_class:
        yield from _inherited(thing)
    if is_table:
        yield from ("Units and limits: [keys of a scene](scene.md).", "")
    if is_class and issubclass(thing, Outcome) and thing is not Outcome:
        yield from ("It also has the methods of [Outcome](#outcome).", "")
    for key, member in members(thing).items():
        yield from _entry(f"{name}.{key}", member, level + "#")


def _inherited(thing: type) -> Iterator[str]:
    """Attributes that a result has from those it extends."""
    for base in thing.__mro__[1:]:
        if is_dataclass(base) and issubclass(base, Outcome):
            _, head, attributes = inspect.cleandoc(base.__doc__ or "").partition("Attributes:\n")
            entries = list(_docstring(head + attributes))
            yield from ("And of every such result:", "", *entries[3:])


def members(thing: Any) -> dict[str, Any]:
    """Documented methods and properties of a class, without those that its page refers to."""
    if not inspect.isclass(thing) or issubclass(thing, Exception):
        return {}
    if issubclass(thing, Table) and thing is not Scene:
        return {}
    own = [base for base in thing.__mro__ if base.__module__.startswith("autobalancer")]
    found = {key: each for base in reversed(own) for key, each in vars(base).items()}
    found |= CALLED.get(thing.__name__, {})
    inherits = issubclass(thing, Outcome) and thing is not Outcome
    elsewhere = {"model_post_init", *(vars(Outcome) if inherits else ())}
    bare = {key: getattr(each, "__func__", each) for key, each in found.items()}
    return {
        key: each
        for key, each in bare.items()
        if key[0] != "_"
        and key not in elsewhere
        and f"{thing.__name__}.{key}" not in INTERNAL
        and inspect.getdoc(each)
        and (isinstance(each, property) or inspect.isfunction(each))
    }


def _signature(name: str, thing: Any, is_table: bool) -> str:
    """A call with its parameters, one a line where they are many."""
    signature = inspect.signature(thing)
    given = []
    for p in signature.parameters.values():
        typed = p.annotation is not p.empty and not is_table
        given.append(p.replace(annotation=_Bare(p.annotation) if typed else p.empty))
    shown = list(_shown(p for p in given if p.name not in ("self", "cls", "kind")))
    result = signature.return_annotation
    ends = f" -> {result}" if isinstance(result, str) and not inspect.isclass(thing) else ""
    text = f"{name}({', '.join(shown)}){ends}"
    if len(text) > 80:
        text = f"{name}(\n" + "".join(f"    {each},\n" for each in shown) + f"){ends}"
    return re.sub(r"\b(?:autobalancer|collections|pathlib)\.(?:\w+\.)*(?=[A-Z])", "", text)


def _shown(parameters: Iterable[inspect.Parameter]) -> Iterator[str]:
    """Parameters as text, with the * behind which they are given by name alone."""
    named = False
    for p in parameters:
        if p.kind is p.KEYWORD_ONLY and not named:
            yield "*"
        named = named or p.kind in (p.KEYWORD_ONLY, p.VAR_POSITIONAL)
        yield str(p)


def _docstring(text: str) -> Iterator[str]:
    """Paragraphs as they are; of a section every entry as an item."""
    inside = example = False
    for line in text.splitlines():
        begins, ends = line.startswith(">>> ") and not example, example and not line.strip()
        if begins or ends:  # else Markdown takes >>> for a quotation
            yield "```python" if begins else "```"
            example = begins
        if _SECTION.match(line):
            inside = True
            yield from ("", f"**{line}**", "")
        elif inside and re.match(r"    \S", line):
            word, colon, rest = line.strip().partition(":")
            yield f"- `{word}`:{rest}" if colon else f"- {line.strip()}"
        elif inside and line.startswith("     "):
            yield f"  {line.strip()}"
        else:
            inside = inside and not line.strip()
            yield line
    yield from ("```", "") if example else ("",)
