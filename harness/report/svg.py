"""Shapes of a drawing as SVG text; the page's style has the colours, in light and dark."""

from __future__ import annotations

import math
from collections.abc import Iterable
from html import escape

COILS = 5  # of a spring


def line(points: Iterable[tuple[float, float]], kind: str = "line") -> str:
    """A polyline through points (x, y) [px]; `kind` is a class of the page's style."""
    joined = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    return f'<polyline class="{kind}" points="{joined}"/>'


def circle(x: float, y: float, radius: float, kind: str = "line") -> str:
    """A circle about (x, y) [px]."""
    return f'<circle class="{kind}" cx="{x:.1f}" cy="{y:.1f}" r="{radius:.1f}"/>'


def box(x: float, y: float, width: float, height: float, kind: str = "body") -> str:
    """A rectangle about its middle (x, y) [px]."""
    return (
        f'<rect class="{kind}" x="{x - width / 2:.1f}" y="{y - height / 2:.1f}" '
        f'width="{width:.1f}" height="{height:.1f}" rx="2"/>'
    )


def words(x: float, y: float, text: str, anchor: str = "middle") -> str:
    """Text at (x, y) [px]."""
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{escape(text)}</text>'


def spring(start: tuple[float, float], end: tuple[float, float], width: float = 7.0) -> str:
    """A spring between two points, and the hatched ground at its end."""
    (x0, y0), (x1, y1) = start, end
    length = math.hypot(x1 - x0, y1 - y0)
    along = ((x1 - x0) / length, (y1 - y0) / length)
    across = (-along[1], along[0])
    steps = 2 * COILS
    points = [start]
    for k in range(steps + 1):
        share = 0.2 + 0.6 * k / steps
        side = 0.0 if k in (0, steps) else width * (-1.0) ** k
        points.append(
            (
                x0 + share * length * along[0] + side * across[0],
                y0 + share * length * along[1] + side * across[1],
            )
        )
    points.append(end)
    ground = [(x1 + side * across[0], y1 + side * across[1]) for side in (-14.0, 14.0)]
    hatches = [
        line(
            [
                (x1 + side * across[0], y1 + side * across[1]),
                (
                    x1 + (side - 5.0) * across[0] + 6.0 * along[0],
                    y1 + (side - 5.0) * across[1] + 6.0 * along[1],
                ),
            ]
        )
        for side in (-9.0, -2.0, 5.0, 12.0)
    ]
    return line(points) + line(ground) + "".join(hatches)


def drawing(width: float, height: float, shapes: Iterable[str], title: str) -> str:
    """The whole drawing, which scales with the page; `title` is what a screen reader says."""
    return (
        f'<svg class="machine" role="img" viewBox="0 0 {width:.0f} {height:.0f}" '
        f'xmlns="http://www.w3.org/2000/svg"><title>{escape(title)}</title>'
        f"{''.join(shapes)}</svg>"
    )
