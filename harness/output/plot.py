"""What pictures share, and the time history of signals; every picture is written by `save`.

Figures are made without pyplot, so that neither a display nor a global state is touched.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..errors import UserError
from .files import picture_format, write_whole
from .words import printable

Signal = NDArray[np.float64]
Signals = Mapping[str, Signal]
_MOST_LINES = 12  # in one panel; more cannot be told apart
_PREFIXES = ((1.0, "m"), (1e-3, "mm"), (1e-6, "µm"), (1e-9, "nm"))


def save(figure: Figure, path: Path) -> Path:
    """Write a figure, completely or not at all.

    Raises:
        UserError: the format is unknown, or the file cannot be written.
    """
    kind = picture_format(path)
    for text in (figure._suptitle, *(axes.title for axes in figure.axes)):  # type: ignore[attr-defined]
        if text is not None:
            text.set_parse_math(False)  # a title's $ is a $
            text.set_text(printable(text.get_text()))
    with write_whole(path, "wb") as stream:
        figure.savefig(stream, format=kind, dpi=150)
    return path


def metres(largest: float) -> tuple[float, str]:
    """Factor and unit in which a length reads well."""
    return readable(largest, _PREFIXES)


def readable(largest: float, units: Sequence[tuple[float, str]]) -> tuple[float, str]:
    """Factor and name of the first of falling units that a value reaches, or of the last."""
    size, unit = next((each for each in units if largest >= each[0]), units[-1])
    return 1.0 / size, unit


def _panels(units: Mapping[str, str]) -> dict[str, list[str]]:
    """Signals by panel title: what belongs together stands together."""
    panels: dict[str, list[str]] = {}
    for name, unit in units.items():
        if unit == "m" and name.endswith((".x", ".y")):
            title = "displacement"
        elif ".weight[" in name and name.endswith(".angle"):
            title = "weights, angle in the rotor"
        else:
            title = name.rpartition(".")[2].removesuffix("_xi").removesuffix("_eta")
        panels.setdefault(f"{title}\t{unit}", []).append(name)
    return panels


def _draw(axes: Any, time: Signal, signals: Signals, title: str, unit: str) -> None:
    largest = max(float(np.max(np.abs(values), initial=0.0)) for values in signals.values())
    factor, shown = metres(largest) if unit == "m" else (1.0, unit)
    for name in list(signals)[:_MOST_LINES]:
        values = signals[name] * factor
        label = name
        if title == "displacement":
            label += f", 0-peak {np.max(np.abs(values)):.3g} {shown}"
        axes.plot(time, values, label=label, linewidth=1.0)
    if len(signals) > _MOST_LINES:
        axes.plot([], [], " ", label=f"and {len(signals) - _MOST_LINES} more, not drawn")
    axes.set_ylabel(f"{title} [{shown}]" if shown else title)
    axes.grid(alpha=0.3)
    axes.legend(loc="upper right", fontsize="small")


def plot_run(
    time: Signal, signals: Signals, units: Mapping[str, str], title: str, path: Path
) -> Path:
    """Time history of everything recorded: displacements, weights' angles, the rest by quantity.

    Args:
        time: (T,) [s].
        signals: (T,) each, by name.
        units: of measurement, by the signals' names.

    Raises:
        UserError: nothing was recorded, or the file cannot be written.
    """
    panels = _panels(units)
    if not panels:
        raise UserError(f"{path}: nothing to draw: the run recorded no signal")
    figure = Figure(figsize=(9.0, 1.0 + 2.4 * len(panels)), layout="constrained")
    grid = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
    for axes, (heading, names) in zip(grid, panels.items(), strict=True):
        quantity, unit = heading.split("\t")
        _draw(axes, time, {name: signals[name] for name in names}, quantity, unit)
    grid[-1].set_xlabel("time [s]")
    figure.suptitle(title)
    return save(figure, path)
