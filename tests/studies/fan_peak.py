"""Largest vibration of a fan in its run-up, with and without balls, against `scipy` `odeint`.

`python -m tests.studies.fan_peak` runs a fan of 14 kg up to 2950 rpm within 4 s, without balls, and
with two and with six point balls from several starts.  The equations here are written in fixed
axes and share no code with the package.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import odeint

import autobalancer as ab

MASS, STIFFNESS, DAMPING, UNBALANCE = 14.0, (40e3, 60e3), (45.0, 55.0), 120e-6
SPEED, RISE, END = 2950.0 * math.tau / 60.0, 4.0, 5.0
TRACK, DRAG, KAPPA = 0.0761, 0.03, 1.4
BALLS = {2: 4e-3, 6: 1.94e-3}  # number: mass of each [kg]
POINTS = 40_000


def scene(count: int, angles: np.ndarray) -> ab.Scene:
    """The fan with so many balls at angles in the rotor [rad]."""
    rotor = {"kind": "planar", "mass": MASS, "stiffness": STIFFNESS, "damping": DAMPING,
             "unbalance": UNBALANCE}  # fmt: skip
    balls = {"name": "balls", "kind": "balls", "count": count, "mass": BALLS.get(count),
             "track_radius": TRACK, "drag": DRAG, "angles": angles.tolist()}  # fmt: skip
    drive = {"profile": [[0.0, 0.0], [RISE, SPEED], [END, SPEED]]}
    return ab.Scene(rotor=rotor, balancer=[balls] if count else [], operation=drive)


def by_package(count: int, angles: np.ndarray) -> float:
    """Largest distance of the rotor from its middle [m]."""
    run = scene(count, angles).run()
    return float(np.hypot(run["rotor.x"], run["rotor.y"]).max())


def by_odeint(count: int, angles: np.ndarray) -> float:
    """The same, by LSODA."""
    mass = BALLS.get(count, 0.0)

    def rates(state: np.ndarray, t: float) -> np.ndarray:
        x, y, vx, vy = state[:4]
        phi, turning = state[4 : 4 + count], state[4 + count :]
        rate = SPEED / RISE if t < RISE else 0.0
        w = min(SPEED * t / RISE, SPEED)
        beta = 0.5 * SPEED / RISE * min(t, RISE) ** 2 + SPEED * max(0.0, t - RISE)
        c, s = np.cos(phi), np.sin(phi)
        free = ((KAPPA - 1.0) * rate - DRAG / mass * (turning - w)) / KAPPA if count else phi
        fx = UNBALANCE * (w * w * math.cos(beta) + rate * math.sin(beta))
        fy = UNBALANCE * (w * w * math.sin(beta) - rate * math.cos(beta))
        fx += (mass * TRACK * (turning**2 * c + free * s)).sum()
        fy += (mass * TRACK * (turning**2 * s - free * c)).sum()
        fx -= DAMPING[0] * vx + STIFFNESS[0] * x
        fy -= DAMPING[1] * vy + STIFFNESS[1] * y
        total, part = MASS + count * mass, mass / KAPPA
        xx, yy = total - part * (s * s).sum(), total - part * (c * c).sum()
        xy = part * (s * c).sum()
        det = xx * yy - xy * xy
        ax, ay = (yy * fx - xy * fy) / det, (xx * fy - xy * fx) / det
        pull = free + (ax * s - ay * c) / (KAPPA * TRACK)
        return np.concatenate([[vx, vy, ax, ay], turning, pull])

    start = np.concatenate([np.zeros(4), angles, np.zeros(count)])
    times = np.linspace(0.0, END, POINTS)
    found = odeint(rates, start, times, rtol=1e-9, atol=1e-12, mxstep=5000)
    return float(np.hypot(found[:, 0], found[:, 1]).max())


def main() -> None:
    random = np.random.default_rng(2950)
    print("| balls | largest vibration [mm] | by odeint | difference |\n|---:|---:|---:|---:|")
    for count in (0, 2, 2, 2, 6, 6, 6):
        angles = random.uniform(0.0, math.tau, count)
        own, other = by_package(count, angles), by_odeint(count, angles)
        print(f"| {count} | {1e3 * own:.4f} | {1e3 * other:.4f} | {own / other - 1.0:+.1e} |")


if __name__ == "__main__":
    main()
