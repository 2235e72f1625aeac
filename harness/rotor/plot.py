"""Pictures of a rotor over its speed: Campbell diagram, unbalance response, run-up."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import get_args

import numpy as np
from numpy.typing import NDArray

from ...models.arrays import Array
from ..errors import UserError
from ..output.picture import (
    GREY,
    Line,
    Panel,
    Picture,
    PlotAxis,
    Style,
    colour,
    unbroken,
)
from ..output.plot import metres
from ..result.in_space import mode_shapes
from ..result.motion import station_names
from ..result.sag import FROM_SAG
from ..units import shown_in
from .analysis import Kind, RotorAnalysis

CRITICAL = "#D62728"
SPEED = PlotAxis("speed", "rad/s")
ALONE = "rotor without balancers"
_WHIRL: dict[int, tuple[str, Style]] = {
    1: ("forward", "solid"),
    -1: ("backward", "dashed"),
    0: ("planar", "dotted"),
}
_STRAIGHT = 1e-6  # |whirl| below it is no whirl, as in the modes


def draw(found: RotorAnalysis, path: Path | None, kind: Kind = "campbell") -> Path | Picture:
    """A picture of a kind: modes, campbell, response, or run-up.

    Raises:
        UserError: the kind is unknown, or the rotor has nothing of it to show.
    """
    if kind not in get_args(Kind):
        raise UserError(f"kind {kind!r}: must be one of {', '.join(get_args(Kind))}")
    pictures = {
        "campbell": campbell_diagram,
        "response": response_curves,
        "run-up": run_up_curves,
        "modes": lambda found: mode_shapes(found.scene),
    }
    picture = pictures[kind](found)
    return picture if path is None else picture.save(path)


def campbell_diagram(found: RotorAnalysis) -> Picture:
    """Natural frequencies and damping ratios against speed, forward and backward whirl."""
    data, critical = found.campbell(), _critical(found)
    frequency = np.abs(data.eigenvalues)
    damping = -data.eigenvalues.real / np.where(frequency > 0.0, frequency, 1.0)
    lines = [*_senses(data.whirl), *_by_whirl(data.speeds, frequency, data.whirl)]
    lines.append(Line((data.speeds, data.speeds), "frequency = speed", GREY, width=0.8))
    double = data.speeds, 2.0 * data.speeds
    lines.append(Line(double, "frequency = 2 x speed", GREY, "dashed", 0.8))
    unit, factor = shown_in("rad/s")
    listed = "\n".join(f"{speed * factor:.6g} {unit}" for speed in critical)  # as the table
    label = f"critical speeds, undamped:\n{listed}" if listed else ""
    lines.append(Line((critical, critical), label, CRITICAL, "marks"))
    # modes far above the speeds would press the rest together
    low = frequency[frequency <= 1.3 * found.high]
    top = 1.08 * max(found.high, float(low.max(initial=0.0)))
    upward = PlotAxis("natural frequency $|\\lambda|$", "rad/s", limits=(0.0, top))
    ratio = PlotAxis("damping ratio (negative: unstable)", "1")
    below = [*_by_whirl(data.speeds, damping, data.whirl)]
    panels = [Panel((SPEED, upward), lines, beside=True), Panel((SPEED, ratio), below)]
    return Picture(f"{found.scene.heading}\n{ALONE}", panels, height=3.8)


def _sense(whirl: Array) -> Array:
    return np.where(np.abs(whirl) < _STRAIGHT, 0, np.sign(whirl))


def _senses(whirl: Array) -> Iterator[Line]:
    """Entries of the legend alone: what the styles of the lines of all colours mean."""
    nowhere = np.array([np.nan])
    for value, (name, style) in _WHIRL.items():
        if (_sense(whirl) == value).any():
            yield Line((nowhere, nowhere), f"{name} motion", "#000000", style)


def _by_whirl(speeds: Array, values: Array, whirl: Array) -> Iterator[Line]:
    """A line for every mode and sense of its whirl, which its style shows."""
    sense = _sense(whirl)
    for value, (_, style) in _WHIRL.items():
        for k in np.flatnonzero((sense == value).any(axis=0)).tolist():
            inside = sense[:, k] == value
            # one more point on, so that a change of sense leaves no gap
            shown = inside | np.concatenate([[False], inside[:-1]])
            yield Line((speeds, np.where(shown, values[:, k], np.nan)), "", colour(k), style)


def response_curves(found: RotorAnalysis) -> Picture:
    """Amplitude and phase of every station against speed, x and y side by side."""
    data = found.response()
    alike = np.allclose(data.amplitude[:, 1], -1j * data.amplitude[:, 0], rtol=1e-9, atol=0.0)
    names = ["x and y alike, y a quarter turn later"] if alike else ["along x", "along y"]
    size = np.abs(data.amplitude[:, : len(names)])
    factor, unit = metres(float(size.max()))
    ends = 0.8 * factor * float(size.min()), 1.25 * factor * float(size.max())
    upward = PlotAxis("amplitude, 0-peak", unit, log=True, limits=ends)
    turn = PlotAxis("phase to the rotor's angle", "deg", range(-180, 181, 90), limits=(-190, 190))
    above, below = [], []
    for column, name in enumerate(names):
        sizes, phases = _marked(found, ends), _marked(found, (-190.0, 190.0), "")
        for j, station in enumerate(station_names(found.scene)):
            curve, points = data.amplitude[:, column, j], data.measured[:, column, j]
            label = f"{station}, equations"
            sizes.append(Line((data.speeds, np.abs(curve) * factor), label, colour(j)))
            phases.append(
                Line((data.speeds, unbroken(_degrees(curve) + 180.0) - 180.0), "", colour(j))
            )
            label = f"{station}, co-simulated unit"
            sizes.append(Line((data.points, np.abs(points) * factor), label, colour(j), "marks"))
            phases.append(Line((data.points, _degrees(points)), "", colour(j), "marks"))
        above.append(Panel((SPEED, upward), sizes, title=name))
        below.append(Panel((SPEED, turn), phases))
    title = f"{found.scene.heading}\nunbalance response of the {ALONE}"
    return Picture(title, [*above, *below], columns=len(names), height=3.8)


def _degrees(values: NDArray[np.complexfloating]) -> Array:
    return np.degrees(np.angle(values))


def _marked(
    found: RotorAnalysis,
    ends: tuple[float, float],
    label: str = "critical speeds of the rotor alone",
) -> list[Line]:
    """A line from one end of the picture to the other at every critical speed within it."""
    speeds = _critical(found)
    across = np.repeat(speeds, 3).astype(float)
    across[2::3] = np.nan
    upward = np.tile([*ends, np.nan], len(speeds))
    return [Line((across, upward), label if len(speeds) else "", CRITICAL, "dashed", 0.9)]


def _critical(found: RotorAnalysis) -> Array:
    """Critical speeds within the range of the pictures."""
    return found.critical[(found.critical >= found.low) & (found.critical <= found.high)]


def run_up_curves(found: RotorAnalysis) -> Picture:
    """Displacement of every station while the speed rises, with and without balancers."""
    data = found.run_up()
    runs = {"without balancers": data.run}
    if data.alone is not None:
        runs = {"with balancers": data.run, "without balancers": data.alone}
    largest = max(float(displacement.max()) for _, displacement in runs.values())
    factor, unit = metres(largest)
    ends = 0.0, 1.05 * factor * largest
    called = FROM_SAG if found.scene.operation.gravity else "displacement"
    upward = PlotAxis(f"{called} $\\sqrt{{x^2 + y^2}}$, 0-peak", unit, limits=ends)
    panels = []
    for name, (speeds, displacement) in runs.items():
        lines = _marked(found, ends)
        for j, station in enumerate(station_names(found.scene)):
            shown = displacement[:, j] * factor
            label = f"{station}, largest {shown.max():.3g} {unit}"
            lines.append(Line((speeds, shown), label, colour(j), width=0.8))
        panels.append(Panel((SPEED, upward), lines, title=name))
    rise = f"{found.low:.3g} to {found.high:.4g} rad/s within {data.seconds:.4g} s"
    return Picture(f"{found.scene.heading}\nrun-up by co-simulation, {rise}", panels)
