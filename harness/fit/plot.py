"""The picture of a fit: measured and simulated amplitudes, and what is left between them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from ..output.plot import Drawing, metres, save
from .measured import SPEED
from .study import Fit


def plot_fit(found: Fit, path: Path | None) -> Path | Drawing:
    """Amplitudes over the speed, or over their number where one speed was measured.

    Raises:
        UserError: the format is unknown, or the file cannot be written.
    """
    measured, values = found.measured, found.measured.values
    differences = np.log(found.simulated / values)
    places = measured.settings.get(SPEED, np.arange(1.0, measured.count + 1.0))
    columns = [places[~np.isnan(column)] for column in measured.sizes.values()]
    factor, unit = metres(float(values.max()))
    figure = Figure(figsize=(9.0, 6.5), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
    begin = 0
    for number, (name, x) in enumerate(zip(measured.sizes, columns, strict=True)):
        part = slice(begin, begin := begin + len(x))
        upper.plot(
            x, factor * values[part], "o", ms=3.5, color=f"C{number}", label=f"{name}, measured"
        )
        upper.plot(x, factor * found.simulated[part], "x", ms=5, color=f"C{number}")
        lower.plot(x, differences[part], ".", color=f"C{number}")
    upper.plot([], [], "kx", label="fitted")
    upper.set(yscale="log", ylabel=f"amplitude [{unit}]")
    upper.legend(fontsize="small")
    lower.axhline(0.0, color="black", lw=0.8)
    lower.set(
        xlabel="speed [rad/s]" if SPEED in measured.settings else "measurement",
        ylabel="ln(simulated / measured)",
    )
    for axes in (upper, lower):
        axes.grid(which="both", alpha=0.25)
    figure.suptitle(
        f"{found.start.heading}\nrms {found.rms[0]:.3g} before, {found.rms[1]:.3g} after the fit"
    )
    return save(figure, path)
