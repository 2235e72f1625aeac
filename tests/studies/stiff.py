"""Study: what do stiff machines cost, and is the error that they state true?

    python -m tests.studies.stiff

The two-ball machine with one support that is 10 to 1e8 times as stiff as the other (7 % damping),
and with weights in ever heavier drag, each run with a tolerance of 1e-5.  Prints how many steps the
run took and how many of them by collocation (the rest by series), processor time, the error that it
states, and the error from an integration by SciPy (LSODA) of equations of its own; both over the
largest displacement, angles over 1 rad.
"""

from __future__ import annotations

import math
import time
import warnings
from collections.abc import Iterator

import numpy as np
from scipy.integrate import solve_ivp

from autobalancer.harness import Result, Scene, cosimulate, load_scene

TOLERANCE, REPEATS = 1e-5, 3
STIFFNESS = (1e1, 1e2, 1e3, 3e3, 1e4, 3e4, 1e5, 1e6, 1e7, 1e8)  # ky/kx
DRAG = (1.0, 20.0, 100.0, 300.0, 1e3, 1e4)  # over that of the scene, a sixth of kappa m w
DAMPING = 0.07
NAMES = ["rotor.x", "rotor.y", "weights.weight[1].angle", "weights.weight[2].angle"]


def cases() -> Iterator[tuple[str, Scene]]:
    """Each machine with what it is called."""
    keys = {"coupling.scheme": "auto", "coupling.steps_per_rev": None}
    keys |= {"coupling.corrections": None, "coupling.tolerance": TOLERANCE}
    scene = load_scene("two_balls").replace(keys)
    for ratio in STIFFNESS:
        supports = {"rotor.stiffness": [1.0, ratio]}
        supports |= {"rotor.damping": [0.5, 2.0 * DAMPING * math.sqrt(ratio)]}
        yield f"ky/kx {ratio:g}", scene.replace(supports)
    for factor in DRAG:
        yield f"drag x {factor:g}", scene.replace({"weights.drag": 0.0125 * factor})


def rates(t: float, y: np.ndarray, scene: Scene) -> np.ndarray:
    """Derivatives of x, y, angles in fixed axes and their rates: Newton's law of rotor and weights.

    M q'' + C q' + K q = U w^2 e^{iwt} + sum of N_k, with N_k the reaction of a weight, whose own
    equation is R phi'' = (q'' . tangent) - b/m R (phi' - w).
    """
    weights, rotor, w = scene.balancer[0], scene.rotor, scene.operation.speed
    m, radius = weights.mass, weights.track_radius
    stiffness, damping = np.array(rotor.stiffness), np.array(rotor.damping)
    q, v, phi, rate = y[:2], y[2:4], y[4:6], y[6:]
    out, along = np.array([np.cos(phi), np.sin(phi)]), np.array([-np.sin(phi), np.cos(phi)])
    drag = -weights.drag / m * (rate - w)
    mass = (rotor.mass + len(phi) * m) * np.eye(2) - m * along @ along.T
    force = rotor.unbalance * w**2 * np.array([math.cos(w * t), math.sin(w * t)])
    force = force - stiffness * q - damping * v
    force = force + m * radius * (out @ rate**2 - along @ drag)
    a = np.linalg.solve(mass, force)
    return np.concatenate([v, a, rate, drag - a @ along / radius])


def exact(scene: Scene, times: np.ndarray) -> np.ndarray:
    """Displacements and angles in the rotor (4, t) by SciPy."""
    w = scene.operation.speed
    y = np.zeros(8)
    y[4:6], y[6:] = scene.balancer[0].angles, w
    found = solve_ivp(
        rates, (0.0, times[-1]), y, "LSODA", times, args=(scene,), rtol=1e-12, atol=1e-14
    )
    return np.array([*found.y[:2], *(found.y[4:6] - w * times)])


def true_error(scene: Scene, run: Result) -> float:
    """Largest difference from SciPy's motion."""
    expected, found = exact(scene, run.time), np.array([run[name] for name in NAMES])
    off = np.abs(found - expected).max(axis=1)
    return float(max(off[:2].max() / np.abs(expected[:2]).max(), off[2:].max()))


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    for name, scene in cases():
        spent = []
        for _ in range(REPEATS):
            begun = time.process_time()
            run = cosimulate(scene, record=NAMES)
            spent.append(time.process_time() - begun)
        print(
            f"{name:12} {run.steps:5} steps, {run.collocated_steps:4} collocated, "
            f"{min(spent) * 1e3:7.1f} ms, states "
            f"{run.estimated_error or 0.0:.1e}, errs {true_error(scene, run):.1e}",
            flush=True,
        )
