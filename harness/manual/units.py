"""Reference of the units: equations, validity and variables, from their declarations."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby
from pathlib import Path
from typing import Any

from ...fmus.catalogue import CATALOGUE, equations
from ...fmus.composite import variables as composite
from ...fmus.variables import Variable

SIZES: dict[str, list[dict[str, Any]]] = {
    "RotorOnSupports": [
        {},
        {"kind": "two_support", "stations": 2, "unbalances": 1},
        {"kind": "flexible", "stations": 3, "unbalances": 1},
        {"kind": "matrices", "unbalances": 1, "supports": 1, "feet": 1},
        {"sliders": 1},
        {"cubics": 1, "stops": 1},
    ],
}


def page() -> str:
    """Markdown of all units."""
    lines: list[str] = []
    for name, unit in CATALOGUE.items():
        lines.append(_inner(equations(unit)))
        known: set[str] = set()
        for sizes in SIZES.get(name, [{}]):
            shown = [v for v in unit.sized(sizes).layout.variables if v.name not in known]
            known |= {v.name for v in shown}
            built = ", ".join(f"`{key} = {value!r}`" for key, value in sizes.items())
            lines += [f"### Variables of {name}" + (f", also with {built}" if built else ""), ""]
            lines += _rows(shown)
    text = (Path(composite.__file__).parent / "README.md").read_text(encoding="utf-8")
    lines += [_inner(text), "### Variables of a composite", ""]
    lines += [*_rows(composite.own_variables(composite.CompositeSizes()))]
    return "\n".join(lines)


def _inner(markdown: str) -> str:
    """A page as a section: headings one level down, but those of its parts two."""
    return markdown.replace("\n## ", "\n### ").replace("# ", "## ", 1)


def _rows(variables: list[Variable]) -> Iterator[str]:
    seen = [v for v in variables if not v.name.startswith("der(") and ".der(" not in v.name]
    seen.sort(key=lambda v: ("parameter", "input", "output").index(v.causality))
    for causality, each in groupby(seen, lambda v: v.causality):
        yield from (
            "",
            f"| {causality} | unit | start | allowed | meaning |",
            "|---|---|---|---|---|",
        )
        for v in each:
            start = "" if v.start is None or causality == "output" else f"{v.start:g}"
            allowed = "" if causality == "output" else v.allowed
            yield f"| `{v.name}` | {v.unit} | {start} | {allowed} | {v.description} |"
    yield ""
