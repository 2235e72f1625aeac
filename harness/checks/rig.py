"""A rig as Rodrigues et al. 2010 measured it, and its authors' own simulation, co-simulated.

Every run is in C, as the scene's composite.  *expected* is the rig's or the authors', *measured*
the co-simulation's.  Tolerances hold the scatter of the measurement and what the model leaves out:
harness/manual/results/bristol.md.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from ..scene import Scene, load_scene
from .rig_data import SOURCE, Curve, at, bearings, chosen, response, steady
from .rig_sweeps import sweep_rows
from .row import Row, Rows

FLEXIBLE = "bristol_flexible"  # the same rig with a shaft that bends
EQUATIONS = 0.01  # of the authors' simulation with balls
PAPER = 0.05  # of theirs without balls
CRITICAL, BEARINGS = 0.05, 0.2  # of a critical speed, of the ratio of two bearings' amplitudes
PLAIN = {"shaft that bends": {2: 0.2, 3: 0.12, 4: 0.12}, "rigid": {2: 0.3, 3: 0.2, 4: 0.2}}
GAIN, FACTOR = 2.0, 2.2  # what balls are good for at least, how far their amplitudes may be off
BALLS_SETTLE = 400  # revolutions
BANDS = {  # rpm: where each mode's peak is looked for
    "cylindrical y": (1300.0, 1560.0),
    "cylindrical x": (1560.0, 1860.0),
    "conical y": (1860.0, 2150.0),
    "conical x": (2150.0, 2480.0),
}
HIGH = (4000.0, 4500.0, 5000.0)  # rpm, above the resonances
PROMINENT = 0.03  # mm, of a peak: ten times the scatter between neighbours


def check_rig(scene: Scene, rows_of: str) -> Iterator[Row]:
    """Rows of one of `GROUPS`.

    Raises:
        SceneError: the scene is not of the rig.
        SimulationError: a run has failed.
    """
    yield from GROUPS[rows_of](scene, Rows(scene.name, "rig"))


def _as_points(scene: Scene) -> Scene:
    """Balls as the authors simulate them: they roll without inertia and pass each other."""
    return scene.replace({"balls.kind": "pendulums", "balls.weight_radius": None})


def _simulated_with_balls(scene: Scene, rows: Rows) -> Iterator[Row]:
    for washers, figure in ((3, "13"), (2, "14a")):
        table = np.unique(chosen("simulated", washers=washers, balls=2))
        speeds, first = np.unique(table["speed_rpm"], return_index=True)
        found = steady(_as_points(scene), washers, speeds[::2], BALLS_SETTLE)
        label = f"authors' simulation, {washers} washers, balls, worst of {len(found)} speeds [mm]"
        expected = table["amplitude_mm"][first][::2]
        yield rows.number(label, expected, found, EQUATIONS, f"{SOURCE}, Fig. {figure}")


def _simulated_plain(scene: Scene, rows: Rows) -> Iterator[Row]:
    table = chosen("simulated", washers=3, balls=0)
    speeds, expected = table["speed_rpm"], table["amplitude_mm"]
    found = steady(scene.without_balancers(), 3, speeds)
    source, above = f"{SOURCE}, Fig. 8a", speeds > 2600.0
    label = "authors' simulation, 3 washers, no balls"
    rms = math.sqrt(np.mean(np.log(found / expected) ** 2))
    yield rows.number(f"{label}: rms of the logarithms", 0.0, rms, PAPER, source, 1.0)
    worst = f"{label}, worst above 2600 rpm [mm]"
    yield rows.number(worst, expected[above], found[above], PAPER, source)


def _critical_speeds(scene: Scene, rows: Rows) -> Iterator[Row]:
    speeds = np.arange(BANDS["cylindrical y"][0], BANDS["conical x"][1], 10.0)
    for washers, figure in ((3, "9a"), (4, "11e")):
        curve = speeds, steady(scene.without_balancers(), washers, speeds)
        both = [response(washers, 0, falling=falling) for falling in (0, 1)]
        for mode, band in BANDS.items():
            expected = np.mean([peak(one, band) for one in both])
            label = f"critical speed, {mode}, {washers} washers [rpm]"
            source = f"{SOURCE}, Fig. {figure}, mean of up and down"
            yield rows.number(label, expected, peak(curve, band), CRITICAL, source)


def peak(curve: Curve, band: tuple[float, float], prominent: float = PROMINENT) -> float:
    """Speed of the largest local maximum within a band; NaN: there is none."""
    from scipy.signal import find_peaks  # a second to load, for every check

    speeds, amplitude = curve
    places, _ = find_peaks(amplitude, prominence=prominent)
    inside = [k for k in places if band[0] < speeds[k] < band[1]]
    return speeds[max(inside, key=lambda k: amplitude[k])] if inside else math.nan


def _bearings(scene: Scene, rows: Rows) -> Iterator[Row]:
    orbits = chosen("orbits")
    speeds = np.unique(orbits["speed_rpm"])
    found = bearings(scene.without_balancers(), 3, speeds)
    for figure, speed, (motor, other) in zip("bcde", speeds, found, strict=True):
        orbit = orbits[orbits["speed_rpm"] == speed]
        largest = [np.hypot(orbit[f"x{n}_mm"], orbit[f"y{n}_mm"]).max() for n in (2, 1)]
        label = f"bearing at the motor over the other, 3 washers, {speed:g} rpm"
        source = f"{SOURCE}, Fig. 7{figure}, bearings exchanged"
        yield rows.number(label, largest[0] / largest[1], motor / other, BEARINGS, source)


def _plain(scene: Scene, rows: Rows) -> Iterator[Row]:
    rotors = (load_scene(FLEXIBLE), scene)
    for one, (name, tolerances) in zip(rotors, PLAIN.items(), strict=True):
        for washers, tolerance in tolerances.items():
            found = steady(one.without_balancers(), washers, HIGH)
            label = f"no balls, {name}, {washers} washers, worst of 4000, 4500, 5000 rpm [mm]"
            yield rows.number(label, at(response(washers, 0), HIGH), found, tolerance, SOURCE)


def _high_with_balls(scene: Scene, rows: Rows) -> Iterator[Row]:
    plain, number = scene.without_balancers(), range(5)
    without, ours_without = (
        np.array([at(response(n, 0), HIGH) for n in number]),
        np.array([steady(plain, n, HIGH) for n in number]),
    )
    balls, ours = (
        np.array([at(response(n, 2), HIGH) for n in number]),
        np.array([steady(scene, n, HIGH, BALLS_SETTLE) for n in number]),
    )
    gains, our_gains = (without / balls).min(axis=1), (ours_without / ours).min(axis=1)
    for n in (2, 3, 4):
        label = f"no balls over balls, {n} washers, least of 4000, 4500, 5000 rpm; above {GAIN:g}"
        yield rows.statement(label, gains[n], our_gains[n], our_gains[n] > GAIN, SOURCE)
    best, our_best = (int(np.argmin(one.mean(axis=1))) for one in (balls, ours))
    label = "washers of the least vibration with balls, 4000 to 5000 rpm"
    yield rows.number(label, best, our_best, 0.0, SOURCE)
    factors = np.exp(np.abs(np.log(ours / balls)))
    worst = np.unravel_index(np.argmax(factors), factors.shape)
    label = (
        f"balls, 0 to 4 washers, 4000 to 5000 rpm, worst: {worst[0]} at {HIGH[worst[1]]:g} rpm, "
        f"a factor of {factors[worst]:.2f}; below {FACTOR} [mm]"
    )
    yield rows.statement(label, balls[worst], ours[worst], factors[worst] < FACTOR, SOURCE)


GROUPS: dict[str, Callable[[Scene, Rows], Iterator[Row]]] = {
    "simulated with balls": _simulated_with_balls,
    "simulated": _simulated_plain,
    "critical speeds": _critical_speeds,
    "bearings": _bearings,
    "plain": _plain,
    "with balls": _high_with_balls,
    "way up": partial(sweep_rows, falling=False),
    "way down": partial(sweep_rows, falling=True),
}
