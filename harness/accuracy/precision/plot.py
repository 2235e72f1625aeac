"""Work-precision diagram: error across, seconds up, both logarithmic."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from ...output.machine import machine
from ...output.picture import GREY, Line, Panel, Picture, PlotAxis, colour
from .measure import TARGETS, TWO_DECADES, Point, Precision, cheapest
from .methods import Method


def plot_precision(study: Precision, path: Path | None) -> Path | Picture:
    """Draw the best method of each group, its smallest step or tolerance beside it."""
    points = [p for p in study.points if p.error and p.seconds and p.error < 1.0]
    lines = []
    for number, family in enumerate(best_of_groups(points)):
        method = family[0].method
        order = None if method.in_one_piece else study.orders.get(method.family)
        name = method.family + ("" if order is None else f" (order {order:.1f})")
        curve = np.array([[p.error, p.seconds] for p in family], float).T
        texts = tuple(p.method.setting if p is family[-1] else "" for p in family)
        look = colour(number)
        lines.append(Line((curve[0], curve[1]), name, look))
        marks = Line((curve[0], curve[1]), "", look, "marks", texts=texts, text_colour=look)
        lines.append(marks)
    seconds = [float(p.seconds or 0.0) for p in points] or [1.0]
    limit = TWO_DECADES * study.reference_error
    edge = np.array([limit, limit]), np.array([min(seconds), max(seconds)])
    lines.append(Line(edge, "100 times the reference's own error", GREY, "dashed"))
    across = "largest error over time and signals, relative to each signal's range"
    axes = PlotAxis(across, log=True), PlotAxis("run time", "s", log=True)
    title = f"{study.scene.heading}\nsmallest of {study.rounds} runs on {machine()}"
    picture = Picture(title, [Panel(axes, lines)], height=5.4)
    return picture if path is None else picture.save(path)


def best_of_groups(points: Sequence[Point]) -> Iterator[list[Point]]:
    """Of each group the family that is the cheapest at most of the errors in `TARGETS`."""
    groups: dict[str, list[Point]] = {}
    for point in points:
        groups.setdefault(_group(point.method), []).append(point)
    for members in groups.values():
        ways = [found for error in TARGETS if (found := cheapest(members, error))]
        families = Counter(way.method.family for way in ways or members)
        ((best, _),) = families.most_common(1)
        yield [point for point in members if point.method.family == best]


def _group(method: Method) -> str:
    """Methods that a reader chooses between."""
    if method.in_one_piece:
        return "one piece"
    if method.one_file:
        return "one file"
    return "jacobi" if method.name == "jacobi" else "separate FMUs"
