"""The rig's measured points with the co-simulated sweep over them, for every number of washers."""

from __future__ import annotations

import itertools
from concurrent.futures import ThreadPoolExecutor

from ..output.picture import GREY, Line, Panel, Picture, PlotAxis, colour
from ..scene import Scene
from .rig_data import RATE, Curve, response, swept
from .rig_sweeps import FITTED_DRAG

WASHERS = range(5)
STEPS = {"coupling.steps_per_rev": 20}  # enough for a picture
RANGE = (1050.0, 5300.0)  # rpm
SETTLING = 50.0  # rpm beyond it: a sweep starts from rest, which its first second shows
COLOURS = {0: GREY, 2: colour(0)}  # by number of balls


def plot_rig(scene: Scene) -> Picture:
    """Amplitude against speed on the way up and down, with and without balls.

    Points are measured, lines co-simulated sweeps at the rig's rate.
    """
    rotors = {0: scene.without_balancers(), 2: scene.replace(FITTED_DRAG)}
    ways = list(itertools.product(rotors, (False, True)))  # at once: five runs leave cores idle

    def sweep(way: tuple[int, bool]) -> dict[float, Curve]:
        balls, falling = way
        low, high = RANGE[0] - SETTLING, RANGE[1] + SETTLING
        return swept(rotors[balls].replace(STEPS), WASHERS, low, high, falling)

    with ThreadPoolExecutor(len(ways)) as executor:
        sweeps = dict(zip(ways, executor.map(sweep, ways), strict=True))
    across = PlotAxis("speed", "rpm", limits=RANGE)
    upward = PlotAxis("amplitude", "mm", log=True, limits=(3e-3, 2.0))
    panels: list[Panel] = []
    for washers, falling in itertools.product(WASHERS, (False, True)):
        lines = []
        for balls, shade in COLOURS.items():
            name = f"{balls} balls" if balls else "no balls"
            named = not panels  # the others' lines look alike
            points = response(washers, balls, falling=falling)
            lines.append(Line(points, named * f"{name}, measured", shade, "dots"))
            curve = sweeps[balls, falling][washers]
            lines.append(Line(curve, named * f"{name}, co-simulated", shade, width=1.2))
        count = "1 washer" if washers == 1 else f"{washers} washers"
        heading = f"{count}, speed {'falling' if falling else 'rising'}"
        panels.append(Panel((across, upward), lines, title=heading))
    title = f"Rig of Rodrigues et al. 2010, speed changing by {RATE:g} rpm/s"
    return Picture(title, panels, columns=2, height=2.8, width=6.0)
