"""The rig's measured points with the co-simulated sweep over them, for every number of washers."""

from __future__ import annotations

import itertools
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from matplotlib.figure import Figure

from ..output.plot import save
from ..scene import Scene
from .rig_data import RATE, Curve, response, swept
from .rig_sweeps import FITTED_DRAG

WASHERS = range(5)
STEPS = {"coupling.steps_per_rev": 20}  # enough for a picture
RANGE = (1050.0, 5300.0)  # rpm
COLOURS = {0: "tab:gray", 2: "tab:blue"}  # by number of balls


def plot_rig(scene: Scene, _check: object, path: Path) -> Path:
    """Amplitude against speed on the way up and down, with and without balls.

    Points are measured, lines co-simulated sweeps at the rig's rate.
    """
    rotors = {0: scene.without_balancers(), 2: scene.replace(FITTED_DRAG)}
    ways = list(itertools.product(rotors, (False, True)))  # at once: five runs leave cores idle

    def sweep(way: tuple[int, bool]) -> dict[float, Curve]:
        balls, falling = way
        return swept(rotors[balls].replace(STEPS), WASHERS, *RANGE, falling)

    with ThreadPoolExecutor(len(ways)) as executor:
        sweeps = dict(zip(ways, executor.map(sweep, ways), strict=True))
    figure = Figure(figsize=(12.0, 15.0), layout="constrained")
    grid = figure.subplots(len(WASHERS), 2, sharex=True, sharey=True)
    for (balls, falling), curves in sweeps.items():
        name = f"{balls} balls" if balls else "no balls"
        for washers, (speeds, amplitude) in curves.items():
            axes, colour = grid[washers, int(falling)], COLOURS[balls]
            points = response(washers, balls, falling=falling)
            axes.plot(*points, ".", color=colour, ms=3, alpha=0.6, label=f"{name}, measured")
            axes.plot(speeds, amplitude, color=colour, lw=1.2, label=f"{name}, co-simulated")
            axes.set_title(f"{washers} washers, speed {'falling' if falling else 'rising'}")
    for axes in grid.flat:
        axes.set(yscale="log", xlim=RANGE, ylim=(3e-3, 2.0))
        axes.grid(which="both", alpha=0.25)
    for axes in grid[:, 0]:
        axes.set_ylabel("amplitude [mm]")
    for axes in grid[-1]:
        axes.set_xlabel(f"speed [rpm], changing by {RATE:g} rpm/s")
    grid[0, 0].legend(fontsize="small")
    return save(figure, path)
