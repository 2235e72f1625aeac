"""Variables that differ in an index alone as arrays of FMI 3.0: `weight.angle` of all weights."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import chain

from ..variables import Layout, Variable

_INDEX = re.compile(r"\[\d+\]")


def arrays(layout: Layout) -> list[tuple[Variable, ...]]:
    """All variables, those of an array together in the order of their index; others alone."""
    rows: dict[str, list[Variable]] = {}
    for v in layout.variables:
        rows.setdefault(_INDEX.sub("", v.name), []).append(v)
    return [tuple(row) for row in rows.values()]


def as_one(row: tuple[Variable, ...]) -> Variable:
    """An array's variable: named without the index, it depends on what any element depends on."""
    if len(row) == 1:
        return row[0]
    return replace(
        row[0],
        name=_INDEX.sub("", row[0].name),
        depends=tuple(chain.from_iterable(v.depends for v in row)),
        begins=tuple(chain.from_iterable(v.begins for v in row)),
    )
