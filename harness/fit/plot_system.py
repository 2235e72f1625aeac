"""The picture of a fit of a system: measured signals over time, and those of the fitted system."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from ..output.plot import Drawing, save
from ..result.system import run_system
from .systems import SystemFit


def plot_fit(found: SystemFit, path: Path | None) -> Path | Drawing:
    """A panel a signal.

    Raises:
        UserError: the format is unknown, or the file cannot be written.
    """
    signals = found.measured.signals
    result = run_system(found.system, record=list(signals))
    figure = Figure(figsize=(9.0, 1.2 + 2.4 * len(signals)), layout="constrained")
    panels = np.atleast_1d(figure.subplots(len(signals), 1, sharex=True))
    for axes, (name, column) in zip(panels, signals.items(), strict=True):
        unit = result.signal_units[name]
        axes.plot(result.time, result.signals[name], color="C0", lw=1.2, label="fitted")
        axes.plot(found.measured.time, column, "o", ms=3.0, color="C1", label="measured")
        axes.set_ylabel(name + (f" [{unit}]" if unit else ""))
        axes.grid(alpha=0.25)
    panels[0].legend(fontsize="small")
    panels[-1].set_xlabel("time [s]")
    figure.suptitle(
        f"{found.start.heading}\nrms {found.rms[0]:.3g} before, {found.rms[1]:.3g} after the fit"
    )
    return save(figure, path)
