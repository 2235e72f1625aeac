"""Candidates over the mass of their weights: share that balances, and peak in the run-up."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..output.picture import Line, Panel, Picture, PlotAxis, colour

if TYPE_CHECKING:
    from .fitting import Fitting


def plot_fitting(data: Fitting, path: Path | None = None) -> Path | Picture:
    """One colour a number of weights; bars are 95 % intervals of the worst corner."""
    counts = sorted({one.candidate.count for one in data.trials})
    shares, peaks = [], []
    for number, count in enumerate(counts):
        those = [one for one in data.trials if one.candidate.count == count]
        mass = np.array([1e3 * one.total for one in those])
        share = np.array([100.0 * one.worst.share for one in those])
        label, shade = f"{count} {data.kind}", colour(number)
        shares.append(Line((mass, share), label, shade, "marks"))
        for x, one in zip(mass, those, strict=True):
            bar = 100.0 * np.array(one.interval)
            shares.append(Line((np.array([x, x]), bar), "", shade))
        peak = np.array([100.0 * one.peak_ratio for one in those])
        peaks.append(Line((mass, peak), label, shade, "marks"))
    across = PlotAxis("mass of all weights", "g", log=True)
    panels = [
        Panel((across, PlotAxis("starts that balance", "%", limits=(-2.0, 102.0))), shares),
        Panel((across, PlotAxis("largest vibration of the run, of none", "%", log=True)), peaks),
    ]
    picture = Picture(f"{data.title}: {data.start}", panels, columns=2, width=5.5, height=3.8)
    return picture if path is None else picture.save(path)
