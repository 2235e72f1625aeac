"""Polar picture of measured runs: corrections in every plane, vibration before and after."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ..output.plot import Drawing, save
from .correction import Correction
from .plot import LAYOUT


def plot_correction(result: Correction, path: Path | None) -> Path | Drawing:
    """One polar diagram a plane, and one of the sensors."""
    measured, count = result.measured, len(result.exact)
    figure = Figure(figsize=(5.2 * (count + 1), 6.4), layout=LAYOUT)
    panels: list[Any] = [
        figure.add_subplot(1, count + 1, i + 1, projection="polar") for i in range(count + 1)
    ]
    for j, axes in enumerate(panels[:-1]):
        trials = measured.mounted[:, j]
        _points(axes, trials[np.abs(trials) > 0.0], "o", "tab:grey", "mounted in the runs")
        _arrow(axes, complex(result.exact[j]), "tab:green", "correction, least squares")
        split = [p.mass * np.exp(1j * p.angle) for p in result.pieces if p.plane == j]
        _points(axes, np.array(split), "s", "tab:blue", "to mount")
        axes.set_title(f"plane {measured.planes[j]}\nmass [g], angle in the rotor")
    for before, after in zip(result.before.tolist(), result.after.tolist(), strict=True):
        _arrow(panels[-1], before, "tab:red", "measured")
        _arrow(panels[-1], after, "tab:green", "expected")
    for name, before in zip(measured.sensors, result.before.tolist(), strict=True):
        beside: Any = {"xytext": (6, 6), "textcoords": "offset points", "ha": "center"}
        beside["bbox"] = {"fc": "white", "ec": "none", "alpha": 0.8, "pad": 1.0}
        panels[-1].annotate(name, (np.angle(before), abs(before)), fontsize="small", **beside)
    unit = f" [{measured.unit}]" if measured.unit else ""
    panels[-1].set_title(f"vibration{unit}\nrun {result.corrected!r} and with the corrections")
    once: dict[str, Any] = {}
    for axes in panels:
        axes.grid(alpha=0.4)
        once |= {str(handle.get_label()): handle for handle in axes.get_legend_handles_labels()[0]}
    figure.legend(handles=list(once.values()), loc="outside lower center", ncols=3)
    return save(figure, path)


def _points(axes: Any, values: np.ndarray, marker: str, colour: str, label: str) -> None:
    axes.plot(np.angle(values), np.abs(values), marker, color=colour, label=label)


def _arrow(axes: Any, value: complex, colour: str, label: str) -> None:
    axes.plot([0.0, np.angle(value)], [0.0, abs(value)], "-", color=colour, lw=2.0, label=label)
    axes.plot([np.angle(value)], [abs(value)], "*", color=colour, ms=11)
