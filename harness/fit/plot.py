"""The picture of a fit: measured and simulated amplitudes, and what is left between them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..output.panels import COLOURS, colour
from ..output.plot import Drawing, metres, save
from ..output.ticks import logarithmic
from .measured import SPEED
from .study import Fit

_MARKS = "os^Dv"  # each time the colours repeat
_MOST_WITHIN = 6  # entries of a legend within the axes
_MOST_SETTINGS = 8  # that are told apart


def plot_fit(found: Fit, path: Path | None) -> Path | Drawing:
    """Amplitudes over the speed, or over their number where one speed was measured.

    Raises:
        UserError: the format is unknown, or the file cannot be written.
    """
    measured, values = found.measured, found.measured.values
    differences = np.log(found.simulated / values)
    places = measured.settings.get(SPEED, np.arange(1.0, measured.count + 1.0))
    factor, unit = metres(float(values.max()))
    figure = Figure(figsize=(9.0, 6.5), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
    for number, (label, part, rows) in enumerate(_series(found)):
        x = places[rows]
        look: dict[str, Any] = {"color": colour(number), "ls": ""}
        mark = _MARKS[number // len(COLOURS) % len(_MARKS)]
        upper.plot(x, factor * values[part], marker=mark, ms=3.5, label=label, **look)
        upper.plot(x, factor * found.simulated[part], marker="x", ms=5, **look)
        lower.plot(x, differences[part], marker=mark, ms=3.0, **look)
    upper.plot([], [], "kx", label="fitted")
    logarithmic(upper.yaxis)
    upper.set_ylabel(f"amplitude [{unit}]")
    beside: Any = (
        {"loc": "upper left", "bbox_to_anchor": (1.0, 1.0)} if number >= _MOST_WITHIN else {}
    )
    upper.legend(fontsize="small", **beside)
    lower.axhline(0.0, color="black", lw=0.8)
    lower.set(
        xlabel="speed [rad/s]" if SPEED in measured.settings else "measurement",
        ylabel="ln(simulated / measured)",
    )
    for axes in (upper, lower):
        axes.grid(alpha=0.25)
    figure.suptitle(
        f"{found.start.heading}\nrms {found.rms[0]:.3g} before, {found.rms[1]:.3g} after the fit"
    )
    return save(figure, path)


def _series(found: Fit) -> Iterator[tuple[str, NDArray[np.int_], NDArray[np.int_]]]:
    """What was measured at the same settings: its words, where in `values`, rows of the table.

    Many settings are not told apart.
    """
    measured, begin = found.measured, 0
    varied = {n: c for n, c in measured.settings.items() if n != SPEED and len(np.unique(c)) > 1}
    together = np.column_stack([np.zeros(measured.count), *varied.values()])
    settings, of_row = np.unique(together, axis=0, return_inverse=True)
    if len(settings) > _MOST_SETTINGS:
        varied, settings, of_row = {}, settings[:1], np.zeros(measured.count, int)
    for name, column in measured.sizes.items():
        rows = np.flatnonzero(~np.isnan(column))
        for number, setting in enumerate(settings):
            own = np.flatnonzero(of_row.ravel()[rows] == number)
            words = [
                f"{path} {value:.4g} {found.start.unit_of(path)}".rstrip()
                for path, value in zip(varied, setting[1:], strict=False)
            ]
            if len(own):
                yield ", ".join([f"{name}, measured", *words]), begin + own, rows[own]
        begin += len(rows)
