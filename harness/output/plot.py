"""Pictures drawn by matplotlib; every one is written by `save`.

Figures are made without pyplot, so that neither a display nor a global state is touched.
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, overload

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.patheffects import AbstractPathEffect, withStroke
from matplotlib.ticker import MaxNLocator

from ..errors import UserError
from ..units import in_words, shown_in
from .files import picture_format, write_whole
from .labels import BesidePoint, place_texts
from .panels import Field, Line, Panel, Panels, PlotAxis
from .ticks import logarithmic
from .words import printable

_PREFIXES = ((1.0, "m"), (1e-3, "mm"), (1e-6, "µm"), (1e-9, "nm"))
_STYLES: dict[str, dict[str, Any]] = {
    "solid": {"ls": "-"},
    "dashed": {"ls": "--"},
    "dotted": {"ls": ":"},
    "dots": {"ls": "", "marker": ".", "ms": 2.5},
    "marks": {"ls": "", "marker": "o", "ms": 5.0},
    "crosses": {"ls": "", "marker": "x", "ms": 7.0, "mew": 2.0},
}
_VIEW = {"elev": 22.0, "azim": -62.0}  # degrees, from where space is looked at
_MOST_WITHIN, _MOST_BESIDE = 6, 12  # entries of a legend, within the axes and beside them
_WHITE = "#FFFFFF"  # is lost on light colours
_RESOLUTION = 150  # dots an inch
_RIM = 0.95  # of a polar panel's radius: the label of a circle beyond it would stand on the rim


@dataclass(frozen=True)
class Drawing:
    """A figure of matplotlib that shows itself in a notebook."""

    figure: Figure

    def save(self, path: str | Path) -> Path:
        """Write it, as `save`."""
        return save(self.figure, Path(path))

    def _repr_png_(self) -> bytes:
        return as_png(self.figure)


@overload
def save(figure: Figure, path: Path) -> Path: ...


@overload
def save(figure: Figure, path: None) -> Drawing: ...


def save(figure: Figure, path: Path | None) -> Path | Drawing:
    """Write a figure, completely or not at all; without a path, as a `Drawing`.

    Raises:
        UserError: the format is unknown, the file cannot be written, or the numbers not drawn.
    """
    if path is None:
        return Drawing(figure)
    harmless(figure)
    _relabel(figure)
    place_texts(figure)
    kind = picture_format(path)
    with write_whole(path, "wb") as stream:
        try:
            figure.savefig(stream, format=kind, dpi=_RESOLUTION)
        except (ValueError, OverflowError) as error:  # of axes near the largest number
            raise UserError(
                f"{path}: numbers from one end of the axes to the other cannot be drawn: {error}"
            ) from None
    return path


def as_png(figure: Figure) -> bytes:
    """A figure as the bytes of a PNG file."""
    harmless(figure)
    _relabel(figure)
    place_texts(figure)
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=_RESOLUTION)
    return stream.getvalue()


def harmless(figure: Figure) -> None:
    """Have titles shown as they are, and whole: a user's text may hold what looks like formulas."""
    for text in (figure._suptitle, *(axes.title for axes in figure.axes)):  # type: ignore[attr-defined]
        if text is not None:
            text.set_parse_math(False)  # a title's $ is a $
            text.set_text(printable(text.get_text()))
            text.set_wrap("$" not in text.get_text())  # to wrap, Matplotlib parses formulas again


def _relabel(figure: Figure) -> None:
    """Show axes, titles and legends that name an SI unit in the unit that is shown."""
    legends = [*figure.legends, *(each for axes in figure.axes if (each := axes.get_legend()))]
    titles = [figure._suptitle, *(axes.title for axes in figure.axes)]  # type: ignore[attr-defined]
    for text in (*filter(None, titles), *(text for each in legends for text in each.get_texts())):
        text.set_text(in_words(text.get_text()))
    axes_in_space = [axes.zaxis for axes in figure.axes if hasattr(axes, "zaxis")]
    for axis in [*axes_in_space, *(a for axes in figure.axes for a in (axes.xaxis, axes.yaxis))]:
        name, _, symbol = axis.get_label_text().removesuffix("]").rpartition(" [")
        unit, factor = shown_in(symbol, name)
        if factor != 1.0:
            axis.set_label_text(f"{name} [{unit}]")
            if axis.get_scale() == "linear":
                low, high = sorted(map(float, axis.get_view_interval()))
                ticks = MaxNLocator(8).tick_values(factor * low, factor * high)
                axis.set_ticks([tick / factor for tick in ticks if low <= tick / factor <= high])
            axis.set_major_formatter(partial(_times, factor))


def _times(factor: float, value: float, _place: int | None) -> str:
    return f"{value * factor:.4g}"


def metres(largest: float) -> tuple[float, str]:
    """Factor and unit in which a length reads well."""
    return readable(largest, _PREFIXES)


def readable(largest: float, units: Sequence[tuple[float, str]]) -> tuple[float, str]:
    """Factor and name of the first of falling units that a value reaches, or of the last."""
    size, unit = next((each for each in units if largest >= each[0]), units[-1])
    return 1.0 / size, unit


def drawn(picture: Panels) -> Figure:
    """A picture as a figure of matplotlib."""
    rows = -(-len(picture.panels) // picture.columns)
    size = (picture.width * picture.columns, 1.0 + picture.height * rows)
    figure = Figure(figsize=size, layout="constrained")
    above: list[Any] = []
    alike = _are_alike(picture)
    for number, panel in enumerate(picture.panels, start=1):
        projection = {"polar": "polar", "space": "3d"}.get(panel.kind)
        shared = {"sharex": above[-picture.columns]} if alike and number > picture.columns else {}
        axes = figure.add_subplot(rows, picture.columns, number, projection=projection, **shared)
        _draw(figure, axes, panel)
        if shared:
            above[-picture.columns].set_xlabel("")
            above[-picture.columns].tick_params(labelbottom=False)
        above.append(axes)
    figure.suptitle(picture.title)
    return figure


def _are_alike(picture: Panels) -> bool:
    """Whether panels that stand below each other share their first axis."""
    across = {(p.kind, p.axes[0].label, p.axes[0].limits) for p in picture.panels}
    if picture.columns == 1:
        return len({(kind, label) for kind, label, _ in across}) == 1
    return len(across) == 1 and all(p.kind == "plane" and p.axes[0].limits for p in picture.panels)


def _draw(figure: Figure, axes: Any, panel: Panel) -> None:
    if panel.field is not None:
        _colours(figure, axes, panel.field)
    for line in panel.lines:
        _line(axes, line, outlined=panel.field is not None)
    for letter, axis in zip("xyz", panel.axes, strict=False):
        if panel.kind != "polar":
            _axis(axes, letter, axis)
    if panel.kind == "polar":
        axes.set_title(panel.title or panel.axes[1].label, fontsize="medium")
        axes.set_rticks([r for r in axes.get_yticks() if r < _RIM * axes.get_rmax()])
    else:
        axes.set_title(panel.title, fontsize="medium")
    if panel.kind == "space":
        axes.view_init(**_VIEW)
        axes.set_box_aspect((1.8, 1.0, 1.0), zoom=1.2)
        axes.locator_params(nbins=5)
    elif panel.equal:
        axes.set_aspect("equal")
    if panel.field is None:
        axes.grid(alpha=0.3)
    if any(line.label for line in panel.lines):
        _legend(figure, axes, panel)


def _legend(figure: Figure, axes: Any, panel: Panel) -> None:
    """Where it hides least: in a corner of space, beside many lines, else among a few."""
    count = sum(bool(line.label) for line in panel.lines)
    look: dict[str, Any] = {"fontsize": "small", "ncols": 1 + count // (2 * _MOST_BESIDE)}
    if panel.kind == "polar":
        figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", **look)
    elif panel.kind == "space":
        axes.legend(loc="upper left", **look)
    elif panel.beside or count > _MOST_WITHIN:
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.03), **look)
    else:
        axes.legend(loc="best", **look)


def _colours(figure: Figure, axes: Any, field: Field) -> None:
    shown = np.ma.masked_invalid(field.values)
    low, high = field.quantity.limits or (float(shown.min()), float(shown.max()))
    norm: Normalize = (LogNorm if field.quantity.log else Normalize)(low, high)
    axes.pcolormesh(field.x, field.y, shown, norm=norm, cmap="viridis", rasterized=True)
    axes.set_facecolor("0.85")
    mappable = ScalarMappable(norm, "viridis")
    figure.colorbar(mappable, ax=axes, pad=0.015, label=field.quantity.label)


def _line(axes: Any, line: Line, outlined: bool = False) -> None:
    """A line and its texts, over a field with an outline that shows them on every colour."""
    look = dict(_STYLES[line.style])
    if outlined and line.colour == _WHITE:
        look["path_effects"] = _outline(line.width + 1.5)
    label = line.label or None
    axes.plot(*line.points, color=line.colour, lw=line.width, label=label, **look)
    for *place, text in zip(*line.points, line.texts, strict=False):
        said = axes.add_artist(BesidePoint(in_words(text), place, line.text_colour))
        if outlined:
            said.set_path_effects(_outline(2.0))


def _outline(width: float) -> list[AbstractPathEffect]:
    return [withStroke(linewidth=width, foreground="#000000")]


def _axis(axes: Any, letter: str, axis: PlotAxis) -> None:
    getattr(axes, f"set_{letter}label")(axis.label)
    if axis.log:
        logarithmic(getattr(axes, f"{letter}axis"))
    if axis.ticks is not None:
        getattr(axes, f"set_{letter}ticks")(axis.ticks)
    if axis.limits is not None:
        getattr(axes, f"set_{letter}lim")(*axis.limits)
