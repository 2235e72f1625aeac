"""The picture of systems whose start values scatter: a histogram of every signal."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from ..errors import UserError
from ..output.plot import Drawing, save
from .systems import SystemScatter

MOST_DRAWN = 6  # signals
BINS = 30


def plot_scatter(found: SystemScatter, path: Path | None) -> Path | Drawing:
    """Largest magnitude and end of each signal; lines say the median and 95 %.

    Raises:
        UserError: no signals were recorded, the format is unknown, or the file cannot be written.
    """
    names = found.signals[:MOST_DRAWN]
    if not names:
        raise UserError("nothing to draw: run.record = []")
    figure = Figure(figsize=(8.0, 2.4 * len(names) + 0.6), layout="constrained")
    grid = figure.subplots(len(names), 2, squeeze=False)
    for k, (name, row) in enumerate(zip(names, grid, strict=True)):
        unit = f" [{found.signal_units[name]}]" if found.signal_units[name] else ""
        for axes, what, outcome in zip(
            row, ("largest {}", "{} at the end"), (found.largest, found.end), strict=True
        ):
            values = outcome[found.ran, k]
            axes.hist(values, bins=min(BINS, max(5, len(values) // 5)), color="C0")
            for share, style in ((0.5, "-"), (0.95, "--")):
                place, label = np.quantile(values, share), f"{100 * share:g} % below"
                axes.axvline(place, color="black", ls=style, lw=1.2, label=label)
            axes.set_xlabel(what.format(name) + unit)
        row[0].set_ylabel("systems")
    grid[0, 1].legend(fontsize="small")
    failed = f", {(~found.ran).sum()} failed" if not found.ran.all() else ""
    figure.suptitle(f"{found.title}\n{len(found.values)} systems{failed}")
    return save(figure, path)
