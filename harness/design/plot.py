"""Pictures of a design: capacity and settling, or Goncharov's Fig. 7 with the settling times."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..output.plot import Drawing, save
from ..output.ticks import logarithmic
from ..units import shown_in
from .choices import Design

CLOSED_FORM, MEASURED = "#1f5fa8", "#c03a2b"


def plot_capacity(data: Design, path: Path | None, theory: bool = False) -> Path | Drawing:
    """Capacity over n with the unbalance above, settling times below; or `plot_design`."""
    if theory:
        return plot_design(data, path)
    figure, above, below = _panels(data)
    unit, factor = shown_in("kg m")
    counts = [c.count for c in data.choices]
    above.plot(counts, [factor * c.capacity for c in data.choices], "o-", color=CLOSED_FORM)
    levels = {"largest unbalance": data.unbalance}
    if data.reserve > 1.0:
        levels[f"with the reserve of {data.reserve:g}"] = data.reserve * data.unbalance
    for (label, level), style in zip(levels.items(), ("-", "--"), strict=False):
        above.axhline(factor * level, color=MEASURED, ls=style, label=label)
    above.set_ylim(bottom=0.0)
    above.set_ylabel(f"capacity [{unit}]")
    above.legend(fontsize="small")
    _settling_times(below, data)
    return save(figure, path)


def plot_design(data: Design, path: Path | None) -> Path | Drawing:
    """Functions (15), (16) over n above, predicted and co-simulated settling times below."""
    figure, above, below = _panels(data)
    counts = [c.count for c in data.choices]
    above.plot(counts, [c.measure for c in data.choices], "o-", color=CLOSED_FORM)
    above.set_ylabel("(1 - p) m n, dimensionless,\nat the largest p")
    ended, where = [c.predicted_at_end for c in data.choices], "where the runs ended: median"
    curves = (
        ([c.predicted for c in data.choices], "s--", CLOSED_FORM, "slow root at the largest p"),
        (ended, "d:", "#2c7a4b", f"slow root {where}"),
    )
    for times, style, colour, label in curves:
        shown = [(n, time) for n, time in zip(counts, times, strict=True) if math.isfinite(time)]
        below.plot(*np.array(shown).reshape(-1, 2).T, style, color=colour, mfc="white", label=label)
    _settling_times(below, data)
    return save(figure, path)


def _panels(data: Design) -> tuple[Figure, Axes, Axes]:
    """A figure, and its two panels over the number of weights."""
    figure = Figure(figsize=(7.0, 6.4), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True)
    above.set_title(f"{data.title}\n{data.kind}, race {1e3 * data.race:.4g} mm", fontsize="medium")
    grey = "" if all(c.has_capacity for c in data.choices) else " (grey: too little capacity)"
    below.set_xlabel(f"number of weights n{grey}")
    below.set_xticks([c.count for c in data.choices])
    for axes in (above, below):
        axes.grid(alpha=0.3)
    return figure, above, below


def _settling_times(axes: Axes, data: Design) -> None:
    """Co-simulated medians with their intervals; grey where nothing was run."""
    settled = [c for c in data.choices if math.isfinite(c.median)]
    tops = [c.high if math.isfinite(c.high) else c.median for c in settled]
    medians = np.array([c.median for c in settled])
    reach = [medians - [c.low for c in settled], tops - medians]
    label, counts = "co-simulated: median, 95 % confidence", [c.count for c in settled]
    axes.errorbar(counts, medians, reach, color=MEASURED, label=label, fmt="o", capsize=4)
    late = [c.count for c in data.choices if c.has_capacity and math.isinf(c.median)]
    if late:
        label, top = "co-simulated: most starts do not settle", axes.get_xaxis_transform()
        axes.plot(late, [0.95] * len(late), "^", color=MEASURED, transform=top, label=label)
    for c in data.choices:
        if not c.has_capacity:
            axes.axvspan(c.count - 0.4, c.count + 0.4, color="0.9", zorder=0)
    logarithmic(axes.yaxis)
    axes.set_ylabel("settling time [s]")
    axes.legend(fontsize="small")
