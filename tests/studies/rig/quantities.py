"""Every quantity of the rig that can be compared, of one model, washer by washer.

`python -m tests.studies.rig.quantities` prints tables in Markdown, without and with balls, one
piece of physics after the other.  Amplitudes in mm, speeds in rpm.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from autobalancer.harness import Scene, load_scene
from autobalancer.harness.checks.rig import BANDS, HIGH, peak
from autobalancer.harness.checks.rig_data import at, response, steady, swept
from autobalancer.harness.checks.rig_picture import STEPS, WASHERS
from autobalancer.harness.checks.rig_sweeps import FIRST, FITTED_DRAG, SWEPT, gained, lost
from autobalancer.models.arrays import Array

FITTED, OTHERS = [1, 3], [0, 2, 4]  # washers
CURVE = (*range(1100, 2601, 60), 2800, 3000, *range(3800, 5201, 200))  # not the bearing's resonance
MOTOR = 1260  # rpm: below, the rig moves as much without washers as with one
WHOLE = (*range(MOTOR, 3001, 20), *range(3800, 5201, 20))  # all that unbalance moves, evenly
GRID = np.arange(FIRST[0], BANDS["conical x"][1], 20.0)  # rpm, on which peaks are looked for
WITH_BALLS = (3000.0, *HIGH)
RUN_UP = (2400.0, 5050.0)  # rpm: balls leave the heavy side above the resonances, and settle
SETTLING = 150  # revolutions of the rotor alone
SETTLED_SLOW = 100  # of its peaks' speeds: to 1e-4
PROMINENT = 0.005  # mm, of a peak: few washers make small ones
ROLLING = {"balls.rolling_resistance": 1.5e-4}  # chosen on 1 and 3 washers, among five values


class Quantity(NamedTuple):
    """Of 0 to 4 washers, as measured and as co-simulated; NaN where there is none.

    Attributes:
        kind: "critical speed", "plain", "curve", "balls", "order" or "helping".
        measured, found: (5,), or (5, k) where many points are judged together.
    """

    kind: str
    label: str
    measured: Array
    found: Array

    @property
    def errors(self) -> Array:
        """(5,) relative, or the rms of the logarithms of many points."""
        if self.found.ndim == 1:
            return np.abs(self.found / self.measured - 1.0)
        return np.sqrt(np.mean(np.log(self.found / self.measured) ** 2, axis=1))

    def rms(self, washers: Sequence[int] = WASHERS) -> float:
        """Of the errors with these numbers of washers."""
        return math.sqrt(np.mean(self.errors[list(washers)] ** 2))


def without_balls(scene: Scene) -> Iterator[Quantity]:
    """Critical speeds, amplitudes above the resonances, the whole curve; at constant speed.

    Raises:
        SimulationError: a run has failed.
    """
    scene = scene.without_balancers().replace(STEPS)
    grids = [(GRID, steady(scene, n, GRID, SETTLED_SLOW)) for n in WASHERS]
    both = [[response(n, 0, falling=way) for way in (0, 1)] for n in WASHERS]
    for mode, band in BANDS.items():
        rig = np.array([np.mean([peak(c, band, PROMINENT) for c in ways]) for ways in both])
        ours = np.array([peak(curve, band, PROMINENT) for curve in grids])
        yield Quantity("critical speed", f"critical speed, {mode}", rig, ours)
    speeds = sorted({*CURVE, *WHOLE, *HIGH})
    found = np.array([steady(scene, n, np.array(speeds, float), SETTLING) for n in WASHERS])
    for speed in HIGH:
        wide = np.array([at(response(n, 0), [speed])[0] for n in WASHERS])
        ours = found[:, speeds.index(speed)]
        yield Quantity("plain", f"no balls, {speed:g} rpm", wide, ours)
    for curve in (CURVE, WHOLE):
        label = f"no balls, {len(curve)} speeds, {curve[0]} to {curve[-1]} rpm"
        measured = np.array([at(response(n, 0), curve, 12.5) for n in WASHERS])
        ours = found[:, [speeds.index(speed) for speed in curve]]
        yield Quantity("curve", f"{label}, rms of the logarithms", measured, ours)


def with_balls(scene: Scene) -> Iterator[Quantity]:
    """What remains after a run-up above the resonances, from the heavy side.

    Raises:
        SimulationError: a run has failed.
    """
    ends = swept(scene.replace(STEPS), WASHERS, *RUN_UP, falling=False)
    measured = np.array([at(response(n, 2), WITH_BALLS) for n in WASHERS])
    found = np.array([at(curve, WITH_BALLS) for curve in ends.values()])
    label = "balls, 3000, 4000, 4500, 5000 rpm, rms of the logarithms"
    yield Quantity("balls", label, measured, found)
    label = "balls, mean of 4000, 4500, 5000 rpm"
    yield Quantity("order", label, measured[:, 1:].mean(axis=1), found[:, 1:].mean(axis=1))


def helping(scene: Scene) -> Iterator[Quantity]:
    """Speeds at which balance is gained and lost, of 3 and 4 washers.

    Raises:
        SimulationError: a run has failed.
    """
    scene, some = scene.replace(STEPS), (3, 4)
    for falling, speed_of, name in ((False, gained, "gained"), (True, lost, "lost")):
        both = [swept(one, some, *SWEPT, falling) for one in (scene, scene.without_balancers())]
        measured, found = np.full((2, len(WASHERS)), math.nan)
        for n in some:
            measured[n] = speed_of(*(response(n, balls, falling=falling) for balls in (2, 0)))
            found[n] = speed_of(*(curves[n] for curves in both))
        yield Quantity("helping", f"balance is {name} at", measured, found)


def with_fitted_balls(scene: Scene) -> Scene:
    """A rotor with the balls of `bristol` on its disk: drag and rolling resistance as fitted."""
    (balls,) = load_scene("bristol").document["balancer"]
    document = {**scene.document, "balancer": [{**balls, "at": 2}]}
    made = Scene.from_document(document, path=scene.path, label=scene.label)
    return made.replace(FITTED_DRAG | ROLLING)


def models() -> dict[str, Scene]:
    """The rig with one piece of physics after the other; what is said of it, and the scene."""
    rigid, fitted = load_scene("bristol"), load_scene("bristol_friction")
    tables = ("support_stiffness", "support_damping"), ("stiffness", "damping")
    bends = {f"rotor.{of}": getattr(rigid.rotor, own) for of, own in zip(*tables, strict=True)}
    left = [one.model_dump() for one in rigid.rotor.unbalances]
    left[0]["position"] = fitted.rotor.unbalances[0].position
    bends |= {"rotor.friction": [], "rotor.unbalances": left}
    return {
        "rigid, as published": rigid.without_balancers(),
        "shaft that bends": fitted.replace(bends),
        "friction, fitted": fitted,
    }


def models_with_balls() -> dict[str, Scene]:
    """The same with balls, and what these bring."""
    _, bends, friction = models().values()
    bends, friction = with_fitted_balls(bends), with_fitted_balls(friction)
    points = {"balls.rolling_resistance": 0.0}
    return {
        "rigid, drag fitted": load_scene("bristol").replace(FITTED_DRAG),
        "shaft that bends": bends.replace(points),
        "friction, fitted": friction.replace(points),
        "rolling resistance": friction,
    }


def table(models: dict[str, Scene], *parts: Callable[[Scene], Iterator[Quantity]]) -> Iterator[str]:
    """Lines in Markdown: every quantity as measured, then by model."""
    yield f"| | | {' | '.join(map(str, WASHERS))} | worst, 1 to 4 |"
    yield f"|---|---|{'---:|' * (len(WASHERS) + 1)}"
    found = [[one for part in parts for one in part(scene)] for scene in models.values()]
    for alike in zip(*found, strict=True):
        first = alike[0]
        if first.measured.ndim == 1:
            yield _line(first, "measured", first.measured, _least(first, first.measured))
        for name, one in zip(models, alike, strict=True):
            values = one.found if one.found.ndim == 1 else one.errors
            yield _line(one, name, values, _least(one, values) or _worst(one))


def _least(one: Quantity, values: Array) -> str:
    return f"least: {np.argmin(values)}" if one.kind == "order" else ""


def _worst(one: Quantity) -> str:
    if one.kind == "balls":
        return f"all: {one.rms():.2f}"
    worst = np.nanmax(one.errors[1:])
    return f"{worst:.2f}" if one.kind == "curve" else f"{worst:.0%}"


def _line(one: Quantity, name: str, values: Array, last: str) -> str:
    digits = {"critical speed": 0, "helping": 0, "curve": 2, "balls": 2}.get(one.kind, 4)
    cells = ["-" if math.isnan(value) else f"{value:.{digits}f}" for value in values]
    return f"| {one.label} | {name} | {' | '.join(cells)} | {last} |"


if __name__ == "__main__":
    for line in table(models(), without_balls):
        print(line, flush=True)
    print(flush=True)
    for line in table(models_with_balls(), with_balls, helping):
        print(line, flush=True)
