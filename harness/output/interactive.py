"""Pictures as figures of Plotly, to turn and to look into."""

from __future__ import annotations

from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import UserError
from .files import write_whole
from .picture import Line, Panel, Picture, PlotAxis, in_units
from .words import printable

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

_KINDS = {"plane": "xy", "polar": "polar", "space": "scene"}
_DASHES = {"solid": "solid", "dashed": "dash", "dotted": "dot"}
_SIZES = {"dots": 3, "marks": 6}
_SPACE = {"x": 1.8, "y": 1, "z": 1}
_CAMERA = {"eye": {"x": 1.2, "y": -2.6, "z": 1.0}, "center": {"x": 0, "y": 0, "z": -0.12}}
_TITLE = {"font": {"size": 15}, "y": 1.0, "yanchor": "top", "pad": {"t": 12}}
_INCH = 80  # pixels


def save_html(picture: Picture, path: Path) -> Path:
    """Write a page that needs nothing but itself, completely or not at all.

    Raises:
        UserError: Plotly is not installed, or the file cannot be written.
    """
    page = figure(picture).to_html(include_plotlyjs=True)
    with write_whole(path) as stream:
        stream.write(page)
    return path


def refuse_missing() -> None:
    """Refuse what needs Plotly where there is none.

    Raises:
        UserError: with how to install it.
    """
    try:
        import plotly.graph_objects  # noqa: F401
    except ImportError as error:
        raise UserError('this needs Plotly: pip install "autobalancer[plotly]"') from error


def figure(picture: Picture) -> Figure:
    """A picture as a figure of Plotly.

    Raises:
        UserError: Plotly is not installed.
    """
    refuse_missing()
    from plotly.subplots import make_subplots

    picture = in_units(picture)

    rows = -(-len(picture.panels) // picture.columns)
    places = [
        (k // picture.columns + 1, k % picture.columns + 1) for k in range(len(picture.panels))
    ]
    kinds: list[list[Any]] = [[None] * picture.columns for _ in range(rows)]
    for (row, column), panel in zip(places, picture.panels, strict=True):
        kinds[row - 1][column - 1] = {"type": _KINDS[panel.kind]}
    titles = [_text(panel.title) for panel in picture.panels]
    gap = 0.4 / picture.height / rows
    made = make_subplots(
        rows, picture.columns, specs=kinds, subplot_titles=titles, vertical_spacing=gap
    )
    named: set[str] = set()
    for (row, column), panel in zip(places, picture.panels, strict=True):
        if panel.field is not None:
            made.add_trace(_colours(panel), row, column)
        for line in panel.lines:
            made.add_trace(_trace(panel, line, line.label not in named), row, column)
            named.add(line.label)
        _axes(made, panel, row, column)
    made.update_annotations(font_size=12)  # titles of panels
    made.update_layout(
        title={"text": _text(picture.title), **_TITLE},
        template="plotly_white",
        margin={"t": 1.3 * _INCH, "b": _INCH // 2},
        height=_INCH * (1.5 + picture.height * rows),
    )
    return made


def _text(words: str) -> str:
    """What Plotly, too, takes for text alone."""
    return escape(printable(words), quote=False).replace("\n", "<br>")


def _trace(panel: Panel, line: Line, first: bool) -> Any:
    from plotly import graph_objects as go

    style: dict[str, Any] = {"mode": "lines", "line": {"color": line.colour, "width": line.width}}
    if line.style in _SIZES:
        style = {"mode": "markers", "marker": {"color": line.colour, "size": _SIZES[line.style]}}
    else:
        style["line"]["dash"] = _DASHES[line.style]
    if line.texts:
        style |= {"mode": style["mode"] + "+text", "text": [_text(t) for t in line.texts]}
        style |= {"textposition": "top right", "textfont": {"color": line.text_colour}}
    if line.label:
        style |= {"name": _text(line.label), "legendgroup": line.label, "showlegend": first}
    else:
        style |= {"showlegend": False, "hoverinfo": "skip"}
    if panel.kind == "polar":
        return go.Scatterpolar(theta=np.degrees(line.points[0]), r=line.points[1], **style)
    if panel.kind == "space":
        x, y, z = line.points
        return go.Scatter3d(x=x, y=y, z=z, **style)
    x, y = line.points
    return go.Scatter(x=x, y=y, **style)


def _colours(panel: Panel) -> Any:
    from plotly import graph_objects as go

    field = panel.field
    assert field is not None
    values, quantity = field.values, field.quantity
    limits = quantity.limits or (np.nanmin(values), np.nanmax(values))
    label = _text(quantity.label)
    if quantity.log:
        values, limits = np.log10(values), tuple(np.log10(limits))
        label = f"log10 of {label}"
    return go.Heatmap(
        x=field.x, y=field.y, z=values, zmin=limits[0], zmax=limits[1], colorscale="Viridis",
        colorbar={"title": {"text": label, "side": "right"}},
    )  # fmt: skip


def _axes(made: Figure, panel: Panel, row: int, column: int) -> None:
    where = {"row": row, "col": column}
    if panel.kind == "space":
        names = ("xaxis", "yaxis", "zaxis")
        axes = {name: _axis(a) for name, a in zip(names, panel.axes, strict=True)}
        made.update_scenes(**axes, aspectmode="manual", aspectratio=_SPACE, camera=_CAMERA, **where)
    elif panel.kind == "plane":
        x, y = (_axis(axis) for axis in panel.axes)
        made.update_xaxes(**x, **where)
        if panel.equal:
            y["scaleanchor"] = made.get_subplot(row, column).xaxis.plotly_name.replace("axis", "")
        made.update_yaxes(**y, **where)


def _axis(axis: PlotAxis) -> dict[str, Any]:
    said: dict[str, Any] = {"title": {"text": _text(axis.label)}}
    if axis.log:
        said["type"] = "log"
    if axis.ticks is not None:
        said["tickvals"] = list(axis.ticks)
    if axis.limits is not None:
        said["range"] = [*(np.log10(axis.limits) if axis.log else axis.limits)]
    return said
