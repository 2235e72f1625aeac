"""Pictures that belong to a scene's checks, measured from the coupled units."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..scene import Scene
from ..scene.check import LiquidWindowCheck

CURVE_POINTS = 600
MEASURED_POINTS = 24
BELOW, ABOVE = 0.5, 1.1  # how far the picture reaches beyond the window, times its limits
OPEN_END = 5.0  # times w_*: where a window without an upper limit is cut


def draw_pictures(scene: Scene, directory: Path) -> list[Path]:
    """One picture for every check that has one, in `directory`.

    Raises:
        UserError: a file cannot be written.
    """
    paths = []
    for check in scene.check:
        if isinstance(check, LiquidWindowCheck):
            paths.append(_liquid_window(scene, check, directory / f"{scene.name}_{check.kind}.png"))
    return paths


def _liquid_window(scene: Scene, check: LiquidWindowCheck, path: Path) -> Path:
    from ...models.papers.window import LiquidWindow
    from ..output.plot import WindowCurves, plot_liquid_window
    from ..stability.revolution import Revolution

    window = LiquidWindow.of(scene.assembly())
    lower, upper = window.lower, window.upper
    end = ABOVE * max(lower, upper) if upper is not None else check.up_to or OPEN_END * lower
    start = BELOW * (lower if upper is None else min(lower, upper))
    speeds = np.linspace(start, end, CURVE_POINTS)
    limits = [limit for limit in (lower, upper) if limit is not None]
    points = np.sort(np.concatenate([np.linspace(start, end, MEASURED_POINTS), limits]))
    bare = scene.without_balancers()
    measured = []
    for variant in (scene, bare):
        with Revolution(variant) as units:
            rest = np.zeros(len(units.states))
            steady = [units.steady(float(speed), rest)[0] for speed in points]
        measured.append(np.array([np.hypot(state[0], state[1]) for state in steady]))
    curves = WindowCurves(
        title=scene.title or scene.name,
        speeds=speeds,
        bending=np.asarray(window.bending(speeds)),
        bending_without=np.asarray(window.bending_without(speeds)),
        points=points,
        measured=measured[0],
        measured_without=measured[1],
        lower=lower,
        upper=upper,
        gap=window.liquid.gap,
    )
    return plot_liquid_window(curves, path)
