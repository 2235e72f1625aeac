"""What stands in an FMU's documentation folder: equations, variables, licences."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from markdown_it import MarkdownIt

from ..unit import SizedUnit
from ..variables import Variable
from .types import DISPLAY_UNITS

_HEAD = (
    '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{name}</title><style>'
    "body{{font-family:sans-serif;max-width:60em;margin:2em auto;padding:0 1em}}"
    "table{{border-collapse:collapse}}td,th{{border:1px solid #bbb;padding:.2em .6em;"
    "text-align:left}}code,pre{{background:#f4f4f4}}pre{{padding:.6em}}</style></head><body>\n"
)

_ENGINEERING = {**DISPLAY_UNITS, "kg.m": ("g mm", 1e6), "N/m": ("N/mm", 1e-3)}

_SIGNALS = """xi and eta are axes that turn with the rotor; seen in them a vector a of the fixed
axes is a e^{-i beta}, with beta the rotor's angle. An input signal is a cubic over the
communication step: its value and its derivatives of order 1 to 3 at the start of the step.
Connect only the value and it is held. Outputs belong to the end of the step and come
with their exact slope."""

_MIT = """Permission is hereby granted, free of charge, to any person obtaining a copy
of this software and associated documentation files (the "Software"), to deal
in the Software without restriction, including without limitation the rights
to use, copy, modify, merge, publish, distribute, sublicense, and/or sell
copies of the Software, and to permit persons to whom the Software is
furnished to do so, subject to the following conditions:

The above copyright notice and this permission notice shall be included in all
copies or substantial portions of the Software.

THE SOFTWARE IS PROVIDED "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR
IMPLIED, INCLUDING BUT NOT LIMITED TO THE WARRANTIES OF MERCHANTABILITY,
FITNESS FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT. IN NO EVENT SHALL THE
AUTHORS OR COPYRIGHT HOLDERS BE LIABLE FOR ANY CLAIM, DAMAGES OR OTHER
LIABILITY, WHETHER IN AN ACTION OF CONTRACT, TORT OR OTHERWISE, ARISING FROM,
OUT OF OR IN CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER DEALINGS IN THE
SOFTWARE.
"""

LICENCE = f"""autobalancer: MIT License

Copyright (c) 2026 the autobalancer authors

{_MIT}"""

PYTHONFMU_LICENCE = f"""
pythonfmu (binaries, and its Python files in resources): MIT License

Copyright (c) 2019-2020 NTNU - Department of Ocean Operations and Civil Engineering
Copyright (c) 2019-2020 Safran SA

{_MIT}"""


def html(unit: SizedUnit, name: str, machine: str, equations: Sequence[str]) -> bytes:
    """documentation/index.html.

    Args:
        unit: with its sizes.
        name: of the model.
        machine: what comes first, HTML; a page of a machine has its variables before the equations.
        equations: READMEs of the unit and its parts, Markdown.
    """
    options = ", ".join(f"{key} = {value}" for key, value in unit.options.items())
    built = f"{unit.name}, built with {escape(options)}."
    markdown = MarkdownIt("commonmark").enable("table")
    texts = [markdown.render(text) for text in equations]
    texts += [f"<h2>Signals</h2>\n<p>{escape(_SIGNALS)}</p>\n" * _has_signals(unit)]
    head = _HEAD.format(name=escape(name))
    parts = [head, machine, *([] if machine else texts)]
    parts.append("<h2>Variables</h2>\n" + f"<p>{escape(name)}: {built}</p>\n" * (not machine))
    for causality in ("parameter", "input", "output"):
        rows = [_row(unit.label(v.name), v) for v in unit.shown if v.causality == causality]
        parts.append(
            f"<h3>{causality.capitalize()}s</h3>\n<table><tr><th>Name</th><th>Unit</th>"
            f"<th>Start</th><th>That is</th><th>Allowed</th><th>Meaning</th></tr>\n{''.join(rows)}"
            "</table>\n"
        )
    return "".join([*parts, *(texts if machine else []), "</body></html>\n"]).encode()


def _has_signals(unit: SizedUnit) -> bool:
    """Whether it takes cubics; a composite keeps them inside."""
    return any(v.causality == "input" and v.derivative_of for v in unit.layout.variables)


def _engineering(variable: Variable) -> str:
    """Start value in the unit that drawings have."""
    if not variable.start or variable.unit not in _ENGINEERING:
        return ""
    unit, factor = _ENGINEERING[variable.unit]
    return f"{factor * variable.start:.4g} {unit}"


def _row(name: str, variable: Variable) -> str:
    start = "" if variable.start is None else f"{variable.start!r}"
    allowed = variable.allowed
    if variable.boolean:
        start, allowed = start.lower(), "true, false"
    elif variable.causality == "output":
        allowed = ""
    cells = [variable.unit, start, _engineering(variable), allowed, variable.description]
    return (
        f"<tr><td><code>{escape(name)}</code></td>"
        + "".join(f"<td>{escape(cell)}</td>" for cell in cells)
        + "</tr>\n"
    )
