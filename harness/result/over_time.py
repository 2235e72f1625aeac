"""Pictures over time: everything recorded, and the motion with all weights."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ...models.arrays import Array
from ..errors import UserError
from ..master.names import ANGLE, quantity
from ..output.picture import GREY, Line, Panel, Picture, PlotAxis, colour, style, unbroken
from ..output.plot import metres
from .motion import Motion, station_names
from .sag import FROM_SAG, from_sag
from .stop_panel import stop_panel

if TYPE_CHECKING:
    from ..scene import Scene
    from .verdict import Verdict

ONE_TURN = PlotAxis(ANGLE, "deg", range(0, 361, 90), limits=(-5.0, 365.0))
_DECADES = 5  # below the largest amplitude that are drawn
_MOST_LINES = 12  # in one panel; more cannot be told apart
_WIDTH = 11.0  # of a panel and the legend beside it [inch]: curves that swing leave no room in it


def history(
    time: Array,
    signals: Mapping[str, Array],
    units: Mapping[str, str],
    title: str,
    judged: Verdict | None = None,
    sag: Mapping[str, Array] | None = None,
    scene: Scene | None = None,
) -> Picture:
    """Time history of everything recorded: displacements, weights' angles, the rest by quantity.

    Below displacements stand their amplitudes, logarithmic, which show what is left.

    Args:
        time: (T,) [s].
        signals: (T,) each, by name.
        units: of measurement, by the signals' names.
        judged: what the run comes to, marked in the amplitudes.
        sag: of displacements under gravity (T,) each [m], see `sag_of`: what is drawn is counted
            from it.
        scene: whose stops are drawn, if it has any.

    Raises:
        UserError: nothing was recorded.
    """
    called = {"displacement": FROM_SAG} if sag else {}
    stops = stop_panel(scene, time, signals) if scene and scene.rotor.stops else None
    signals = from_sag(signals, sag or {})
    groups: dict[tuple[str, str], list[str]] = {}
    for name in signals:
        unit = units.get(name, "")
        groups.setdefault((quantity(name, unit), unit), []).append(name)
    if not groups:
        raise UserError("nothing to draw: the run recorded no signal")
    panels = [
        _panel(time, {name: signals[name] for name in names}, *heading, called)
        for heading, names in groups.items()
    ]
    shown = [
        n for heading, names in groups.items() if heading == ("displacement", "m") for n in names
    ]
    pairs = [n[:-1] for n in shown if n.endswith("x") and f"{n[:-1]}y" in shown]
    if pairs:
        del pairs[_MOST_LINES:]
        sizes = [np.hypot(signals[f"{pair}x"], signals[f"{pair}y"]) for pair in pairs]
        place = 1 + [title for title, _ in groups].index("displacement")
        amplitudes = _amplitudes(
            time, sizes, [pair[:-1] for pair in pairs], judged, *called.values()
        )
        panels.insert(place, amplitudes)
        if stops:
            panels.insert(place + 1, stops)
    return Picture(title, panels, height=2.4, width=_WIDTH)


def _panel(
    time: Array, signals: Mapping[str, Array], title: str, unit: str, called: Mapping[str, str]
) -> Panel:
    largest = max(float(np.max(np.abs(values), initial=0.0)) for values in signals.values())
    factor, shown = metres(largest) if unit == "m" else (1.0, unit)
    lines = []
    for number, name in enumerate(list(signals)[:_MOST_LINES]):
        values, label = signals[name] * factor, name
        if title == "displacement":
            label += f", 0-peak {np.max(np.abs(values)):.3g} {shown}"
        elif title == ANGLE:
            values = unbroken(np.degrees(values))
        lines.append(Line((time, values), label, colour(number), style(number), width=1.0))
    if len(signals) > _MOST_LINES:
        nothing = np.full(1, np.nan)
        label = f"and {len(signals) - _MOST_LINES} more, not drawn"
        lines.append(Line((nothing, nothing), label, "none"))
    upward = ONE_TURN if title == ANGLE else PlotAxis(called.get(title, title), shown)
    return Panel((PlotAxis("time", "s"), upward), lines, beside=True)


def _amplitudes(
    time: Array,
    sizes: Sequence[Array],
    names: Sequence[str],
    judged: Verdict | None,
    called: str = "displacement",
) -> Panel:
    """Distances from the axis or the sag (T,) [m], logarithmic: a decay is a straight line."""
    alone, after = (judged.alone, judged.after) if judged and judged.balancers else (None, None)
    largest = max(alone or 0.0, *(float(size.max()) for size in sizes))
    factor, unit = metres(largest)
    top = 1.5 * factor * largest or 1.0
    low = top / 10.0**_DECADES
    lines = [
        Line((time, np.maximum(size * factor, low)), name, colour(j), style(j), width=1.0)
        for j, (name, size) in enumerate(zip(names, sizes, strict=True))
    ]
    if alone:
        label = f"steady without balancers, {factor * alone:.3g} {unit}"
        lines.append(Line((time[[0, -1]], np.full(2, factor * alone)), label, GREY, "dashed"))
    if after:
        label = f"balanced after {after:.3g} s"
        lines.append(Line((np.full(2, after), np.array([low, top])), label, "#000000", "dotted"))
    upward = PlotAxis(f"{called}, 0-peak", unit, log=True, limits=(low, top))
    return Panel((PlotAxis("time", "s"), upward), lines, beside=True)


def motion_with_weights(motion: Motion, judged: Verdict | None = None) -> Picture:
    """Displacement of every station, speed where it changes, and the angles of all weights."""
    size, time = np.hypot(motion.displacement[:, 0], motion.displacement[:, 1]), motion.time
    panels = [_amplitudes(time, list(size.T), station_names(motion.scene), judged, motion.called)]
    axis = PlotAxis("time", "s")
    if motion.changes:
        panels.append(Panel((axis, PlotAxis("speed", "rad/s")), [Line((time, motion.speed))]))
    light = motion.light_side(time)
    for balancer, angles in motion.weights():
        lines = [
            Line((time, unbroken(np.degrees(angle))), f"weight {k + 1}", colour(k), width=1.0)
            for k, angle in enumerate(angles)
        ]
        if np.isfinite(light).any():
            line = time, unbroken(np.degrees(light))
            lines.append(Line(line, "opposite the unbalance", GREY, "dashed"))
        panels.append(Panel((axis, ONE_TURN), lines, title=balancer.label, beside=True))
    return Picture(f"{motion.scene.heading}\nmotion and weights", panels, height=2.6, width=_WIDTH)
