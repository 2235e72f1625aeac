"""A picture that is saved or shown: `Panels`, which `plot` draws."""

from __future__ import annotations

from pathlib import Path

from .panels import COLOURS as COLOURS
from .panels import GREY as GREY
from .panels import Field as Field
from .panels import Line as Line
from .panels import Panel as Panel
from .panels import Panels
from .panels import PlotAxis as PlotAxis
from .panels import Style as Style
from .panels import colour as colour
from .panels import style as style
from .panels import unbroken as unbroken


class Picture(Panels):
    """Panels under a title; shows itself in a notebook."""

    def save(self, path: str | Path) -> Path:
        """Write it, completely or not at all.

        Raises:
            UserError: the format is unknown, or the file cannot be written.
        """
        from .plot import drawn, save  # matplotlib is loaded only to plot

        return save(drawn(self), Path(path))

    def _repr_png_(self) -> bytes:
        from .plot import as_png, drawn

        return as_png(drawn(self))
