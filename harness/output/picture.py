"""A picture as data: panels of lines and fields over labelled axes, drawn by a library of choice.

Who makes one knows no drawing library, and what draws it knows no feature.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from ...models.arrays import Array
from ..units import in_words, shown_in
from .files import PAGE

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

# Okabe and Ito's colours, told apart by colour-blind people and in grey
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
GREY = "#767676"


def colour(number: int) -> str:
    """The colour of the line so numbered, from 0; they repeat."""
    return COLOURS[number % len(COLOURS)]


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
        style: of the line; `dots` are small points, `marks` large ones, without a line.
        texts: beside the points, one each.
    """

    points: tuple[Array, ...]
    label: str = ""
    colour: str = COLOURS[0]
    style: Literal["solid", "dashed", "dotted", "dots", "marks"] = "solid"
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
    """

    axes: tuple[PlotAxis, ...]
    lines: Sequence[Line] = ()
    field: Field | None = None
    title: str = ""
    kind: Literal["plane", "polar", "space"] = "plane"
    equal: bool = False


@dataclass(frozen=True, eq=False)
class Picture:
    """Panels under a title; shows itself in a notebook.

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

    def save(self, path: str | Path) -> Path:
        """Write it, completely or not at all; .html can be turned and looked into.

        Raises:
            UserError: the format is unknown, the file cannot be written, or Plotly is missing.
        """
        path = Path(path)
        if path.suffix.lower() == PAGE:
            from .interactive import save_html

            return save_html(self, path)
        from .plot import drawn, save  # matplotlib is loaded only to plot

        return save(drawn(self), path)

    def plotly(self) -> Figure:
        """As a figure of Plotly, for a notebook.

        Raises:
            UserError: Plotly is not installed.
        """
        from .interactive import figure

        return figure(self)

    def _repr_png_(self) -> bytes:
        from .plot import as_png, drawn

        return as_png(drawn(self))


def in_units(picture: Picture) -> Picture:
    """The same with axes and words of SI units in the units that are shown."""
    panels = [_in_units(panel) for panel in picture.panels]
    return replace(picture, title=in_words(picture.title), panels=panels)


def _in_units(panel: Panel) -> Panel:
    units = [shown_in(axis.unit, axis.name) for axis in panel.axes]
    axes = tuple(
        replace(
            axis,
            unit=unit,
            ticks=axis.ticks if axis.ticks is None else [factor * tick for tick in axis.ticks],
            limits=axis.limits and (factor * axis.limits[0], factor * axis.limits[1]),
        )
        for axis, (unit, factor) in zip(panel.axes, units, strict=True)
    )
    factors = [1.0 if panel.kind == "polar" and not k else f for k, (_, f) in enumerate(units)]
    lines = [
        replace(
            line,
            points=tuple(f * p for f, p in zip(factors, line.points, strict=True)),
            label=in_words(line.label),
            texts=tuple(map(in_words, line.texts)),
        )
        for line in panel.lines
    ]
    field = panel.field
    if field is not None:
        field = replace(field, x=factors[0] * field.x, y=factors[1] * field.y)
    return replace(panel, axes=axes, lines=lines, field=field, title=in_words(panel.title))


def unbroken(angle: Any) -> Array:
    """An angle [deg], 0 to 360; NaN where the line to the next point would cross the edge."""
    turned = np.mod(np.asarray(angle, float), 360.0)
    over = np.abs(np.diff(turned, append=turned[-1:])) > 180.0
    return np.where(over, np.nan, turned)
