"""What random planar machines of these studies have in common, and how they are integrated."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

Array = np.ndarray


def draw_supports(rng: np.random.Generator) -> tuple[float, float, Array, Array]:
    """Mass [kg], natural frequency [rad/s], and stiffness and damping along x and y."""
    mass, natural = rng.uniform(4.0, 40.0), rng.uniform(10.0, 60.0)
    stiffness = mass * natural**2 * np.array([1.0, rng.choice([1.0, rng.uniform(0.6, 1.6)])])
    damping = 2.0 * rng.uniform(0.0, 0.1) * mass * natural * np.array([1.0, rng.uniform(0.5, 2.0)])
    return mass, natural, stiffness, damping


def draw_drive(
    rng: np.random.Generator, natural: float, revolutions: int
) -> tuple[dict[str, Any], dict[str, Any]]:
    """The tables `operation` and `run`: a constant speed, or a run-up from rest or not."""
    speed = natural * rng.uniform(0.3, 4.0)
    turn = 2.0 * np.pi / speed
    if rng.random() >= 0.4:
        return {"speed": speed}, {"revolutions": revolutions}
    begin = rng.choice([0.0, rng.uniform(0.1, 0.9)]) * speed
    rise = {"from": begin, "to": speed, "seconds": rng.uniform(2.0, 8.0) * turn}
    return {"run_up": rise}, {"duration": revolutions * turn}


def draw_rotor(
    rng: np.random.Generator, mass: float, stiffness: Array, damping: Array
) -> dict[str, Any]:
    """The table `rotor`, with internal damping or not."""
    return {
        "kind": "planar", "mass": mass, "stiffness": stiffness.tolist(),
        "damping": damping.tolist(),
        "internal_damping": rng.choice([0.0, 0.2]) * float(damping[0]),
        "unbalance": rng.uniform(1e-4, 2e-3) * mass,
        "unbalance_angle": rng.uniform(0.0, 6.0),
    }  # fmt: skip


def solve_between_corners(
    rhs: Callable[[float, Array], Array],
    start: Array,
    times: Array,
    corners: tuple[float, ...],
    rtol: float,
    atol: float,
) -> Array:
    """States (n, T) at the times, from the first of them on; the torque jumps at corners [s]."""
    solved = np.empty((len(start), len(times)))
    solved[:, 0] = start
    begin, state = 0.0, start
    for end in sorted({t for t in corners if 0.0 < t < times[-1]} | {times[-1]}):
        inside = (times > begin) & (times <= end)
        at = np.unique(np.append(times[inside], end))
        piece = solve_ivp(rhs, (begin, end), state, "DOP853", at, rtol=rtol, atol=atol)
        solved[:, inside] = piece.y[:, : int(inside.sum())]
        begin, state = end, piece.y[:, -1]
    return solved
