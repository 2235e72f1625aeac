"""Pictures over time: everything recorded, and the motion with all weights."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ....models.arrays import Array
from ...errors import UserError
from ...output.picture import Line, Panel, Picture, PlotAxis, colour
from ...output.plot import metres
from .motion import Motion, station_names
from .over_speed import weight_panels

_MOST_LINES = 12  # in one panel; more cannot be told apart


def history(
    time: Array, signals: Mapping[str, Array], units: Mapping[str, str], title: str
) -> Picture:
    """Time history of everything recorded: displacements, weights' angles, the rest by quantity.

    Args:
        time: (T,) [s].
        signals: (T,) each, by name.
        units: of measurement, by the signals' names.

    Raises:
        UserError: nothing was recorded.
    """
    groups: dict[tuple[str, str], list[str]] = {}
    for name in signals:
        unit = units.get(name, "")
        groups.setdefault((_quantity(name, unit), unit), []).append(name)
    if not groups:
        raise UserError("nothing to draw: the run recorded no signal")
    panels = [
        _panel(time, {name: signals[name] for name in names}, *heading)
        for heading, names in groups.items()
    ]
    return Picture(title, panels, height=2.4)


def _quantity(name: str, unit: str) -> str:
    """What belongs together stands together."""
    if unit == "m" and name.endswith((".x", ".y")):
        return "displacement"
    if ".weight[" in name and name.endswith(".angle"):
        return "weights, angle in the rotor"
    return name.rpartition(".")[2].removesuffix("_xi").removesuffix("_eta")


def _panel(time: Array, signals: Mapping[str, Array], quantity: str, unit: str) -> Panel:
    largest = max(float(np.max(np.abs(values), initial=0.0)) for values in signals.values())
    factor, shown = metres(largest) if unit == "m" else (1.0, unit)
    lines = []
    for number, name in enumerate(list(signals)[:_MOST_LINES]):
        values, label = signals[name] * factor, name
        if quantity == "displacement":
            label += f", 0-peak {np.max(np.abs(values)):.3g} {shown}"
        lines.append(Line((time, values), label, colour(number), width=1.0))
    if len(signals) > _MOST_LINES:
        nothing = np.full(1, np.nan)
        label = f"and {len(signals) - _MOST_LINES} more, not drawn"
        lines.append(Line((nothing, nothing), label, "none"))
    return Panel((PlotAxis("time", "s"), PlotAxis(quantity, shown)), lines)


def motion_with_weights(motion: Motion) -> Picture:
    """Displacement of every station, speed where it rises, and the angles of all weights."""
    size = np.hypot(motion.displacement[:, 0], motion.displacement[:, 1])
    factor, unit = metres(float(size.max()))
    time = PlotAxis("time", "s")
    lines = [
        Line((motion.time, size[:, j] * factor), name, colour(j), width=1.0)
        for j, name in enumerate(station_names(motion.scene))
    ]
    panels = [Panel((time, PlotAxis("displacement, 0-peak", unit)), lines)]
    if motion.rises:
        panels.append(
            Panel((time, PlotAxis("speed", "rad/s")), [Line((motion.time, motion.speed))])
        )
    panels += weight_panels(motion, time, motion.time)
    return Picture(f"{motion.title}\nmotion and weights", panels, height=2.6)
