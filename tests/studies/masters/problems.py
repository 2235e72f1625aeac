"""Linear coupling problems: units of `tests/guests`, their wires, and the exact motion."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

Array = np.ndarray
Units = Mapping[str, tuple[str, dict[str, float]]]  # by name, guest and start values
CHAIN = (
    *(("a.x", "s.x1"), ("a.v", "s.v1"), ("b.x", "s.x2"), ("b.v", "s.v2")),
    *(("s.F", "a.F"), ("s.R", "b.F")),
)
BOLTED = (
    *(("mass.x", "bracket.x"), ("mass.v", "bracket.v")),
    *(("mass.a", "bracket.a"), ("bracket.F", "mass.F")),
)


@dataclass(frozen=True)
class Problem:
    """A system, the steps that it is run in, and its exact signals at given times.

    Attributes:
        about: where it is from.
        steps: communication steps [s].
    """

    name: str
    about: str
    units: Units
    wires: tuple[tuple[str, str], ...]
    steps: tuple[float, ...]
    duration: float
    exact: Callable[[Array], dict[str, Array]]


def _linear(matrix: Array, start: Array, shown: tuple[str, str]) -> Callable[[Array], dict]:
    """First and third state of x' = matrix x by the matrix exponential."""

    def exact(time: Array) -> dict[str, Array]:
        states = np.array([expm(matrix * t) @ start for t in time]).T
        return {shown[0]: states[0], shown[1]: states[2]}

    return exact


def _chain(
    name: str,
    about: str,
    masses: tuple[float, float],
    grounds: tuple[tuple[float, float], tuple[float, float]],
    between: tuple[float, float],
    starts: tuple[float, float],
    steps: tuple[float, ...],
    duration: float,
) -> Problem:
    """Two masses with springs and dampers (k, c) to the ground and between them."""
    (m, n), ((k, c), (q, r)), (s, d) = masses, grounds, between
    matrix = np.array([
        [0, 1, 0, 0],
        [-(k + s) / m, -(c + d) / m, s / m, d / m],
        [0, 0, 0, 1],
        [s / n, d / n, -(q + s) / n, -(r + d) / n],
    ])  # fmt: skip
    units = {
        "a": ("mass", {"m": m, "k": k, "c": c, "x0": starts[0]}),
        "s": ("spring", {"k": s, "c": d}),
        "b": ("mass", {"m": n, "k": q, "c": r, "x0": starts[1]}),
    }
    begin = np.array([starts[0], 0.0, starts[1], 0.0])
    return Problem(
        name, about, units, CHAIN, steps, duration, _linear(matrix, begin, ("a.x", "b.x"))
    )


def bolted(gain: float) -> Problem:
    """A mass of 1 kg with a bracket of `gain` kg on it, which carries an oscillator."""
    k, c, m2, k2, c2 = 20.0, 0.2, 0.5, 10.0, 0.1
    whole = 1.0 + gain
    matrix = np.array([
        [0, 1, 0, 0],
        [-(k + k2) / whole, -(c + c2) / whole, k2 / whole, c2 / whole],
        [0, 0, 0, 1],
        [k2 / m2, c2 / m2, -k2 / m2, -c2 / m2],
    ])  # fmt: skip
    units = {
        "mass": ("mass", {"m": 1.0, "k": k, "c": c, "x0": 1.0}),
        "bracket": ("bracket", {"mb": gain, "m": m2, "k": k2, "c": c2, "z0": 0.0}),
    }
    motion = _linear(matrix, np.array([1.0, 0.0, 0.0, 0.0]), ("mass.x", "bracket.z"))
    return Problem(
        f"bracket, loop gain {gain:g}",
        "force answers acceleration at once",
        units,
        BOLTED,
        (0.02, 0.01),
        2.0,
        lambda time: {"mass.x": motion(time)["mass.x"]},
    )


PROBLEMS = (
    _chain(
        "quarter truck",
        "chassis and wheel on a road step of 0.1 m; in libcosim's form, with our own values",
        (400.0, 40.0), ((0.0, 0.0), (150e3, 0.0)), (15e3, 1e3), (-0.1, -0.1), (2e-3, 1e-3), 1.0,
    ),
    _chain(
        "dual mass oscillator",
        "displacement against force, in the form of Busch's benchmark with our own values",
        (1.0, 1.0), ((10.0, 0.1), (20.0, 0.1)), (5.0, 0.2), (1.0, 0.0), (0.02, 0.01), 3.0,
    ),
    _chain(
        "two-mass rotation",
        "two inertias on a shaft, angles and torques",
        (0.01, 0.02), ((0.0, 0.002), (0.0, 0.002)), (3.0, 0.005), (0.1, 0.0), (2e-3, 1e-3), 1.0,
    ),
    bolted(0.5),
    bolted(1.5),
)  # fmt: skip
