"""The unstable band of a ring of liquid over its fill, by four ways that share little.

    python -m tests.studies.ring_band [PICTURE]

Closed form; `speeds` (eigenvalues); growth of motions integrated in one piece; growth over a
revolution of the units, FMUs in one file.  Prints the largest difference, and draws them.
"""

from __future__ import annotations

import math
import sys

import numpy as np
from matplotlib.figure import Figure
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import autobalancer as ab
from autobalancer.harness.stability.main_motion import MainMotion
from autobalancer.models.linear.ring_band import ring_of, unstable_band

MASS, STIFFNESS, WALL = 10.0, 2.5e4, 0.25
HEIGHT = 1.0 / (1000.0 * math.pi * WALL**2)  # of 1 kg, where the ring is full
FILLS = np.linspace(0.1, 0.9, 9)
AT = 5e-3  # of the speed: how near to an end motions are integrated


def scene_of(fill: float) -> ab.Scene:
    ring = {"kind": "ring", "wall_radius": WALL, "inner_radius": WALL * math.sqrt(1.0 - fill),
            "height": HEIGHT, "density": 1000.0, "viscosity": 0.0}  # fmt: skip
    rotor = {"kind": "planar", "mass": MASS, "stiffness": STIFFNESS, "unbalance": 1e-6}
    return ab.Scene(rotor=rotor, balancer=[ring], operation={"speed": 60.0})


def by_integration(scene: ab.Scene, end: float, upward: bool) -> float:
    """Where growth of a motion in time begins, from its growth at two speeds inside the band.

    Near an end the square of the growth is linear in the speed.  The equations stand here anew.
    """
    ring = scene.balancer[0].device
    mass, f, squares = ring.liquid_mass, ring.hollow, []
    inverse = np.linalg.inv([[MASS + mass, mass * f], [1.0, 1.0 + f]]).tolist()
    (a, b), (c, d) = inverse
    speeds = end * (1.0 + AT * np.array([1.0, 2.0]) * (1.0 if upward else -1.0))
    for w in speeds.tolist():

        def rhs(_t, s, w=w):
            z, v, y, u = s.tolist()
            pull, push = -STIFFNESS * z, 4j * w * u + 2.0 * w * w * y
            return [v, a * pull + b * push, u, c * pull + d * push]

        turn = math.tau / w
        times = np.array([0.0, 50.0, 100.0]) * turn
        start = np.array([1e-3, 0.0, 0.0, 0.0], complex)
        found = solve_ivp(rhs, (0.0, times[2]), start, t_eval=times, rtol=1e-8, atol=1e-12)
        size = np.abs(found.y[2])
        squares.append((math.log(size[2] / size[1]) / (times[2] - times[1])) ** 2)
    slope = (squares[1] - squares[0]) / (speeds[1] - speeds[0])
    return float(speeds[0] - squares[0] / slope)


def by_units(scene: ab.Scene, low: float, high: float) -> tuple[float, float]:
    with MainMotion(scene) as motion:

        def rises(speed: float) -> float:
            return motion.growth(speed) - 1e-4 * speed

        inside = 0.5 * (low + high)
        return (
            brentq(rises, 0.97 * low, inside, xtol=1e-6),
            brentq(rises, inside, 1.03 * high, xtol=1e-6),
        )


def main(picture: str = "ring_band.png") -> None:
    rows = []
    for fill in FILLS:
        scene = scene_of(float(fill))
        low, high = unstable_band(*ring_of(scene.assembly()))
        found = scene.speeds(0.5 * low, 1.5 * high, "floquet").methods["floquet"]
        ends = [c.speed for c in found if c.above == "unstable"] + [
            c.speed for c in found if c.above != "unstable"
        ]
        times = by_integration(scene, low, True), by_integration(scene, high, False)
        rows.append([(low, high), (ends[0], ends[-1]), times, by_units(scene, low, high)])
        print(f"fill {fill:.3f}: " + "; ".join(f"{a:.4f} {b:.4f}" for a, b in rows[-1]), flush=True)
    bands = np.array(rows)  # (fills, ways, ends)
    apart = np.abs(bands / bands[:, :1] - 1.0).max(axis=(0, 2))
    names = ("closed form", "speeds", "integrated motions", "units of one file")
    for name, value in zip(names, apart, strict=True):
        print(f"{name}: at most {value:.1e} of the speed beside the closed form")
    axes = (figure := Figure(figsize=(6.0, 4.0), layout="constrained")).subplots()
    natural = math.sqrt(STIFFNESS / MASS)
    axes.fill_between(FILLS, *(bands[:, 0].T / natural), alpha=0.2, label=names[0])
    for way, mark in ((1, "o"), (2, "x"), (3, "+")):
        for end in (0, 1):
            label = names[way] if end == 0 else None
            axes.plot(FILLS, bands[:, way, end] / natural, f"k{mark}", ms=4 + 2 * way, mfc="none",
                      label=label)  # fmt: skip
    axes.set_xlabel("share of the ring that is full")
    axes.set_ylabel("speed over natural frequency, without liquid")
    axes.set_title("Unstable band of a ring of liquid, undamped")
    axes.legend()
    figure.savefig(picture, dpi=110)


if __name__ == "__main__":
    main(*sys.argv[1:])
