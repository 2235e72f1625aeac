"""How a result shows itself in a notebook."""

from __future__ import annotations

from base64 import b64encode
from typing import TYPE_CHECKING

from ..output.words import in_html
from .tables import summary

if TYPE_CHECKING:
    from .result import Result


def html(result: Result) -> str:
    """Table of the signals, what a reader must know, and the time history."""
    counts = f"{result.steps} steps, {result.passes} passes, {result.seconds:.3f} s"
    said = [
        *([str(result.summary())] if result.scene else []),
        counts,
        *(f"NOTE: {event}" for event in result.events),
    ]
    parts = [summary(result).html(), *(f"<p>{in_html(line)}</p>" for line in said)]
    if result.signals:
        png = b64encode(result.plot()._repr_png_()).decode()
        parts.append(
            f'<img style="max-width:100%" alt="signals" src="data:image/png;base64,{png}">'
        )
    return "\n".join(parts)
