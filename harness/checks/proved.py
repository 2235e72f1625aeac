"""Rows of boundaries that are proved, where python-flint is installed."""

from __future__ import annotations

from collections.abc import Iterator

from ...models.papers.window import LiquidWindow
from ..scene import Scene
from ..stability.boundaries import is_provable, speeds
from ..stability.speeds import Speeds
from .row import Row, Rows

NARROWEST = 1e-6  # of the lower natural frequency: width of a proved bracket
PROVED = "proved in ball arithmetic"


def bracket_rows(rows: Rows, scene: Scene, found: Speeds, label: str, w_x: float) -> Iterator[Row]:
    """Every boundary of Floquet lies in a proved bracket, and every bracket has one."""
    if not is_provable():
        return
    proof = speeds(scene, found.range, ["proved"], narrowest=NARROWEST * w_x).proof
    assert proof is not None
    exact = found.methods["floquet"]
    for number, (band, crossing) in enumerate(proof.boundaries, start=1):
        inside = [c for c in exact if band.low <= c.speed <= band.high]
        yield rows.statement(
            f"{label}proved boundary {number}, {crossing.above} above / w_x, holds Floquet's",
            f"{band.low / w_x:.9g} to {band.high / w_x:.9g}",
            ", ".join(f"{c.speed / w_x:.9g}" for c in inside) or "none",
            [c.above for c in inside] == [crossing.above],
            PROVED,
        )
    if len(proof.boundaries) != len(exact):
        counts = str(len(exact)), str(len(proof.boundaries))
        yield rows.statement(f"{label}number of proved boundaries", *counts, False, PROVED)


def window_rows(
    rows: Rows, scene: Scene, window: LiquidWindow, lower: float, upper: float | None, within: float
) -> Iterator[Row]:
    """Dubovik's limits as proved, against those of the units."""
    if not is_provable():
        return
    span = (0.5 * window.lower, 2.0 * max(window.lower, window.upper or 0.0))
    proof = speeds(scene, span, ["proved"]).proof
    assert proof is not None
    assert proof.window is not None
    yield rows.number("proved w_* [rad/s]", float(proof.window.lower), lower, within, PROVED)
    if upper is not None:
        ((_, crossing),) = proof.boundaries
        yield rows.number("proved w^* [rad/s]", crossing.speed, upper, within, PROVED)
    else:
        states = ", ".join(band.state for band in proof.bands)
        yield rows.statement(
            "proved w^*", "none", f"{states} at every speed", states == "stable", PROVED
        )
