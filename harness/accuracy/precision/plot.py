"""Work-precision diagram: error across, seconds up, both logarithmic."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from ...output.machine import machine
from ...output.plot import Drawing, save
from .measure import TARGETS, TWO_DECADES, Point, Precision
from .methods import Method

_COLOURS = {
    "jacobi": "tab:red",
    "gauss-seidel": "tab:orange",
    "compensated": "tab:olive",
    "iterated": "tab:blue",
    "auto": "tab:blue",
    "monolith RK45": "0.70",
    "monolith DOP853": "0.45",
    "monolith LSODA": "0.0",
    "monolith Radau": "0.82",
}
_STYLES: dict[int | None, str] = {0: ":", 1: "--", 3: "-", 5: "-", None: "-"}
_MARKERS: dict[int | None, str] = {0: "v", 1: "s", 3: "o", 5: "*", None: "."}
_TOLERANCE = "tab:green"


def plot_precision(study: Precision, path: Path | None, all_curves: bool = False) -> Path | Drawing:
    """Draw a measured scene: the best method of each group, or all of them."""
    figure = Figure(figsize=(10.5, 6.4), layout="constrained")
    axes = figure.subplots()
    families: dict[str, list[Point]] = {}
    for point in study.points:
        if point.error and point.seconds and point.error < 1.0:
            families.setdefault(point.method.family, []).append(point)
    drawn = families if all_curves else best_of_groups(families)
    for family, points in drawn.items():
        _draw(axes, study, family, points)
    limit = TWO_DECADES * study.reference_error
    axes.axvspan(axes.get_xlim()[0] * 0.1, limit, color="0.92", zorder=0)
    smallest = min((p.error for p in study.points if p.error), default=limit)
    axes.set(xscale="log", yscale="log", xlim=(max(0.3 * smallest, 1e-16), 1.0))
    axes.set_xlabel("largest error over time and signals, relative to each signal's range")
    axes.set_ylabel("run time [s]")
    axes.grid(which="major", alpha=0.35)
    axes.grid(which="minor", alpha=0.1)
    if all_curves:
        figure.legend(loc="outside right upper", fontsize="small", frameon=False)
    else:
        axes.legend(loc="upper right", fontsize="small")
    axes.set_title(study.scene.heading, fontsize="medium")
    figure.supxlabel(_footer(study), fontsize="x-small", color="0.35")
    return save(figure, path)


def best_of_groups(families: Mapping[str, list[Point]]) -> dict[str, list[Point]]:
    """The family of each group that is the cheapest at most of the errors in `TARGETS`."""
    groups: dict[str, dict[str, list[Point]]] = {}
    for family, points in families.items():
        groups.setdefault(_group(points[0].method), {})[family] = points
    best = {}
    for group in groups.values():
        costs = {family: [_cost(points, t) for t in TARGETS] for family, points in group.items()}
        least = [min(column) for column in zip(*costs.values(), strict=True)]
        wins = {
            family: sum(own <= lowest < math.inf for own, lowest in zip(row, least, strict=True))
            for family, row in costs.items()
        }
        winner = max(wins, key=lambda family: wins[family])
        best[winner] = group[winner]
    return best


def _group(method: Method) -> str:
    """Methods that a reader chooses between."""
    if method.in_one_piece:
        return "one piece"
    if method.one_file:
        return "one file"
    return "jacobi" if method.name == "jacobi" else "separate FMUs"


def _cost(points: Sequence[Point], error: float) -> float:
    """Time of the cheapest point that errs by no more [s]; infinite: there is none."""
    return min(
        (p.seconds for p in points if p.seconds and p.error and p.error <= error), default=math.inf
    )


def _draw(axes: Any, study: Precision, family: str, points: Sequence[Point]) -> None:
    method = points[0].method
    whole = method.in_one_piece
    stepped = method.tolerance is not None and not whole
    colour = _TOLERANCE if stepped else _COLOURS.get(method.name, "tab:purple")
    order = study.orders.get(family)
    label = family if order is None or whole else f"{family} (order {order:.1f})"
    many = method.name == "iterated" and method.order == 3 and method.corrections is None
    axes.plot(
        [p.error for p in points],
        [p.seconds for p in points],
        label=label,
        color="tab:cyan" if many and not stepped else colour,
        linestyle="-." if whole else _STYLES[method.order],
        marker="x" if whole else "D" if method.one_file else _MARKERS[method.order],
        markersize=4.5,
        linewidth=2.2 if method.order == 3 and not whole else 1.2,
    )
    if method.order == 3 and not whole:
        for point in (points[0], points[-1]) if len(points) > 1 else points[:1]:
            steps, tolerance = point.method.steps_per_rev, point.method.tolerance
            label = f"{steps}" if steps else f"{tolerance:.0e}"
            look = {"textcoords": "offset points", "fontsize": "x-small", "color": colour}
            axes.annotate(label, (point.error, point.seconds), xytext=(4, 4), **look)


def _footer(study: Precision) -> str:
    return (
        "Numbers at points: communication steps a revolution, or the tolerance asked. Smallest of "
        f"{study.rounds} runs, taking turns. Grey: within two decades of the reference's error.\n"
        f"{machine()}"
    )
