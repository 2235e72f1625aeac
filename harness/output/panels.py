"""A picture as data: panels of lines and fields over labelled axes, drawn by `plot`.

Who makes one knows no drawing library, and what draws it knows no feature.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from ...models.arrays import Array

# Okabe and Ito's colours, told apart by colour-blind people and in grey
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
GREY = "#767676"
Style = Literal["solid", "dashed", "dotted", "dots", "marks", "crosses"]  # of a line


def colour(number: int) -> str:
    """The colour of the line so numbered, from 0; they repeat."""
    return COLOURS[number % len(COLOURS)]


def style(number: int) -> Style:
    """The style of the line so numbered, from 0: another one each time the colours repeat."""
    styles: tuple[Style, ...] = ("solid", "dashed", "dotted")
    return styles[number // len(COLOURS) % len(styles)]


@dataclass(frozen=True)
class PlotAxis:
    """What an axis, or a field's colour, says.

    Attributes:
        unit: of measurement; empty where there is none.
        ticks: that are shown; by default the library's choice.
        log: drawn logarithmically.
        limits: shown from and to; by default all there is.
    """

    name: str
    unit: str = ""
    ticks: Sequence[float] | None = None
    log: bool = False
    limits: tuple[float, float] | None = None

    @property
    def label(self) -> str:
        """Name and unit."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name


@dataclass(frozen=True, eq=False)
class Line:
    """A line, or points.

    Attributes:
        points: (m,) an axis: two, or three in space; angle [rad] and radius in a polar panel.  NaN
            interrupts the line.
        label: in the legend; empty: not in it.
        style: of the line; `dots` are small points, `marks` large ones and
            `crosses` crosses, without a line.
        texts: beside the points, one each.
    """

    points: tuple[Array, ...]
    label: str = ""
    colour: str = COLOURS[0]
    style: Style = "solid"
    width: float = 1.3
    texts: tuple[str, ...] = ()
    text_colour: str = "#000000"


@dataclass(frozen=True, eq=False)
class Field:
    """Values (k, m) over x (m,) and y (k,) as colours; NaN is left empty."""

    x: Array
    y: Array
    values: Array
    quantity: PlotAxis


@dataclass(frozen=True, eq=False)
class Panel:
    """Lines and at most one field over two axes, over three in space, or over angle and radius.

    Attributes:
        equal: lengths along both axes are shown alike (of three: the last two).
        beside: the legend stands beside the panel, since its lines are everywhere.
    """

    axes: tuple[PlotAxis, ...]
    lines: Sequence[Line] = ()
    field: Field | None = None
    title: str = ""
    kind: Literal["plane", "polar", "space"] = "plane"
    equal: bool = False
    beside: bool = False


@dataclass(frozen=True, eq=False)
class Panels:
    """Panels under a title.

    Attributes:
        columns: panels side by side.
        height: of a row [inch].
        width: of a column [inch].
    """

    title: str
    panels: Sequence[Panel]
    columns: int = 1
    height: float = 3.2
    width: float = 9.0


def unbroken(angle: Any) -> Array:
    """An angle [deg], 0 to 360; NaN where the line to the next point would cross the edge."""
    turned = np.mod(np.asarray(angle, float), 360.0)
    over = np.abs(np.diff(turned, append=turned[-1:])) > 180.0
    return np.where(over, np.nan, turned)
