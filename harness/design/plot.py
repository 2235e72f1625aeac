"""Picture of a design: Goncharov's Fig. 7 with the co-simulated settling times on it."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator

from ..output.plot import save
from .choices import Design

CLOSED_FORM, MEASURED = "#1f5fa8", "#c03a2b"


def plot_design(data: Design, path: Path) -> Path:
    """Functions (15), (16) over n above, predicted and co-simulated settling times below."""
    figure = Figure(figsize=(7.0, 6.4), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True)
    counts = [c.count for c in data.choices]
    above.plot(counts, [c.measure for c in data.choices], "o-", color=CLOSED_FORM)
    above.set_ylabel("(1 - p) m n, dimensionless,\nat the largest p")
    above.set_title(f"{data.title}\n{data.kind}, race {1e3 * data.race:.4g} mm", fontsize="medium")
    ended, where = [c.predicted_at_end for c in data.choices], "where the runs ended: median"
    curves = (
        ([c.predicted for c in data.choices], "s--", CLOSED_FORM, "slow root at the largest p"),
        (ended, "d:", "#2c7a4b", f"slow root {where}"),
    )
    for times, style, colour, label in curves:
        shown = [(n, time) for n, time in zip(counts, times, strict=True) if math.isfinite(time)]
        below.plot(*np.array(shown).reshape(-1, 2).T, style, color=colour, mfc="white", label=label)
    settled = [c for c in data.choices if math.isfinite(c.median)]
    tops = [c.high if math.isfinite(c.high) else c.median for c in settled]
    medians = np.array([c.median for c in settled])
    reach = [medians - [c.low for c in settled], tops - medians]
    label, look = "co-simulated: median, 95 % confidence", {"fmt": "o", "capsize": 4}
    below.errorbar([c.count for c in settled], medians, reach, color=MEASURED, label=label, **look)
    late = [c.count for c in data.choices if c.has_capacity and math.isinf(c.median)]
    if late:
        label, top = "co-simulated: most starts do not settle", below.get_xaxis_transform()
        below.plot(late, [0.95] * len(late), "^", color=MEASURED, transform=top, label=label)
    for c in data.choices:
        if not c.has_capacity:
            below.axvspan(c.count - 0.4, c.count + 0.4, color="0.9", zorder=0)
    below.set_yscale("log")
    below.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 3.0, 5.0, 7.0)))
    below.yaxis.set_minor_locator(NullLocator())
    below.yaxis.set_major_formatter("{x:g}")
    grey = "" if all(c.has_capacity for c in data.choices) else " (grey: too little capacity)"
    below.set_xlabel(f"number of weights n{grey}")
    below.set_ylabel("settling time [s]")
    below.set_xticks(counts)
    below.legend(fontsize="small")
    for axes in (above, below):
        axes.grid(alpha=0.3)
    return save(figure, path)
