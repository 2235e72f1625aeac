"""The picture of a scatter: how machines vibrate, which grade they meet, what matters most."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ..output.plot import Drawing, metres, save
from ..output.ticks import logarithmic
from ..scene.grade import GRADES
from .study import Scatter

BINS, FEWEST_BINS = 60, 10
MACHINES_PER_BIN = 5
WIDE = 30.0  # largest over smallest residual: from here on the axis is logarithmic


def plot_scatter(scatter: Scatter, path: Path | None) -> Path | Drawing:
    """Histogram of residual vibration, cumulative share over the grade, importance of the values.

    Raises:
        UserError: the format is unknown, or the file cannot be written.
    """
    figure = Figure(figsize=(12.0, 4.2), layout="constrained")
    said = scatter.as_json()
    left, middle, right = figure.subplots(1, 3)
    residual = scatter.residual[scatter.ran]
    factor, unit = metres(float(residual.max()))
    low, high = factor * float(residual.min()), factor * float(residual.max())
    bins: Any = min(BINS, max(FEWEST_BINS, len(residual) // MACHINES_PER_BIN))
    if high > WIDE * low > 0.0:
        bins = np.geomspace(low, high, bins + 1)
        logarithmic(left.xaxis)
    left.hist(residual * factor, bins=bins, color="C0")
    for name, style in (("0.5", "-"), ("0.95", "--"), ("0.99", ":")):
        label = f"{100 * float(name):g} % below"
        left.axvline(said["residual"][name] * factor, color="black", ls=style, lw=1.2, label=label)
    left.set(xlabel=f"residual amplitude [{unit}]", ylabel="machines")
    left.legend(fontsize="small")
    _grades(middle, scatter)
    _importance(right, said)
    failed = f", {said['failed']} failed" if said["failed"] else ""
    figure.suptitle(f"{scatter.title}\n{said['machines']} machines{failed}")
    return save(figure, path)


def _grades(axes: Any, scatter: Scatter) -> None:
    if scatter.left_out:
        axes.text(0.5, 0.5, f"no grades:\n{scatter.left_out}", ha="center", va="center")
        axes.set_axis_off()
        return
    grade = np.sort(scatter.grade[scatter.ran])
    axes.step(grade, np.arange(1, len(grade) + 1) / len(grade), where="post")
    low, high = grade[0], grade[-1]
    next_above = min((g for g in GRADES if g >= high), default=high)
    shown = [g for g in GRADES if 0.5 * low <= g <= next_above]
    for g in shown:
        axes.axvline(g, color="0.6", lw=0.8)
        axes.annotate(f"G{g:g}", (g, 0.02), rotation=90, va="bottom", ha="right", fontsize="small")
    if low > 0.0:
        axes.set_xscale("log")
        axes.set_xticks(shown, [f"{g:g}" for g in shown])  # powers of ten say nothing here
        axes.minorticks_off()
    axes.set(
        xlabel="grade just met [mm/s]", ylabel="share of the machines that ran", ylim=(0.0, 1.02)
    )


def _importance(axes: Any, said: Mapping[str, Any]) -> None:
    rows = said["importance"][::-1]
    axes.barh(
        [one["path"] for one in rows], [one["rank_correlation"] for one in rows], 0.4, color="C1"
    )
    axes.set(xlim=(-1.0, 1.0), ylim=(-0.8, len(rows) - 0.2))  # a weak one looks weak
    axes.set_xlabel("rank correlation with the residual amplitude")
    axes.axvline(0.0, color="black", lw=0.8)
