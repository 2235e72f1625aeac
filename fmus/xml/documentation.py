"""What stands in an FMU's documentation folder: equations, variables, licences."""

from __future__ import annotations

from html import escape

from markdown_it import MarkdownIt

from ..unit import SizedUnit
from ..variables import Variable

_HEAD = (
    '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{name}</title><style>'
    "body{{font-family:sans-serif;max-width:60em;margin:2em auto;padding:0 1em}}"
    "table{{border-collapse:collapse}}td,th{{border:1px solid #bbb;padding:.2em .6em;"
    "text-align:left}}code,pre{{background:#f4f4f4}}pre{{padding:.6em}}</style></head><body>\n"
)

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


def html(unit: SizedUnit, name: str, equations: str) -> bytes:
    """documentation/index.html.

    Args:
        unit: with its sizes.
        name: of the model.
        equations: the unit's README, Markdown.
    """
    options = ", ".join(f"{key} = {value}" for key, value in unit.options.items())
    built = f"{unit.name}, built with {escape(options)}."
    parts = [
        _HEAD.format(name=escape(name)),
        MarkdownIt("commonmark").enable("table").render(equations),
        f"<h2>Signals</h2>\n<p>{escape(_SIGNALS)}</p>\n" * _has_signals(unit),
        f"<h2>Variables</h2>\n<p>{escape(name)}: {built}</p>\n",
    ]
    for causality in ("parameter", "input", "output"):
        rows = [_row(v) for v in unit.layout.variables if v.causality == causality]
        parts.append(
            f"<h3>{causality.capitalize()}s</h3>\n<table><tr><th>Name</th><th>Unit</th>"
            f"<th>Start</th><th>Allowed</th><th>Meaning</th></tr>\n{''.join(rows)}</table>\n"
        )
    return ("".join(parts) + "</body></html>\n").encode()


def _has_signals(unit: SizedUnit) -> bool:
    """Whether it takes cubics; a composite keeps them inside."""
    return any(v.causality == "input" and v.derivative_of for v in unit.layout.variables)


def _row(variable: Variable) -> str:
    start = "" if variable.start is None else f"{variable.start!r}"
    allowed = variable.allowed
    if variable.boolean:
        start, allowed = start.lower(), "true, false"
    elif variable.causality == "output":
        allowed = ""
    cells = [variable.unit, start, allowed, variable.description]
    return (
        f"<tr><td><code>{escape(variable.name)}</code></td>"
        + "".join(f"<td>{escape(cell)}</td>" for cell in cells)
        + "</tr>\n"
    )
