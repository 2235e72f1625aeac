"""Weights of the machine in one piece that touch: who moves as one, and how that moves a rotor."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from autobalancer.fmus.composite.run import Run, Stretch
from autobalancer.harness import Scene, cosimulate
from autobalancer.harness.master.one_file import composition
from autobalancer.models.constants import FIRST_DERIVATIVE

KAPPA, RADIUS, SIZE = 1.4, 0.1, 0.008  # of balls and their track
RATE = -3.0  # of the pair in the rotor [rad/s]: drag presses the first weight on the other
INSTANT = 1e-11  # s: what is read is of a motion that has begun
APART = 2.0 * math.asin(SIZE / RADIUS)  # angle of two that touch


def scene_of(rotor, masses, drags, begin, rate, speed):
    """Balls in a row, each touching the next, at one rate in the rotor."""
    count = len(masses)
    return Scene.from_document(
        {
            "rotor": {"kind": "planar", "unbalance": 0.0, **rotor},
            "balancer": [
                {
                    "kind": "balls", "name": "balls", "count": count, "track_radius": RADIUS,
                    "mass": list(masses), "drag": list(drags), "weight_radius": SIZE,
                    "angles": [begin + APART * k for k in range(count)], "speeds": [rate] * count,
                }
            ],
            "operation": {"speed": speed},
            "coupling": {"tolerance": 1e-9},
            "run": {"revolutions": 0.5},
        }
    )  # fmt: skip


def accelerations_at_start(scene):
    """Of the weights in the rotor [rad/s^2]."""
    made = composition(scene)
    states = [f"{part.name}.{state}" for part in made.parts for state in part.states]
    speeds = [f"balls.weight[{k + 1}].speed" for k in range(scene.balancer[0].count)]
    read = np.array([FIRST_DERIVATIVE + states.index(name) for name in speeds], np.uintc)
    found, run = np.empty(len(read)), Run(made)
    run.start()
    run.on(Stretch(0.0, INSTANT, INSTANT, INSTANT, 1), read[:0], np.empty((2, 1)))
    assert run.reason == ""
    run.read(read, found)
    run.close()
    return found


def pooled(free, masses):
    """What weights in a row accelerate by: the least-squares fit that does not fall along the row.

    By the minimax formula of isotonic regression (Robertson, Wright & Dykstra 1988, 1.4.4).
    """

    def mean(i, j):
        return np.average(free[i : j + 1], weights=masses[i : j + 1])

    n = len(free)
    return [max(min(mean(i, j) for j in range(k, n)) for i in range(k + 1)) for k in range(n)]


def test_a_contact_that_was_opened_closes_where_its_weights_would_meet():
    """The first contact pulls in the whole row; once the second is open, it pushes."""
    free, masses = np.array([1.0, 0.0, 11.0]), np.full(3, 0.05)
    drags = free * KAPPA * masses  # at a rate of -1 rad/s on a rotor that is held
    held = {"mass": 1e9, "stiffness": 1e9, "damping": 0.0}
    found = accelerations_at_start(scene_of(held, masses, drags, 0.3, -1.0, 1.0))
    assert found == pytest.approx([0.5, 0.5, 11.0], abs=1e-6)


@pytest.mark.parametrize("seed", range(12))
def test_weights_in_a_row_move_as_isotonic_regression_says(seed):
    rng = np.random.default_rng(seed)
    count = int(rng.integers(3, 8))
    masses, free = rng.uniform(0.02, 0.09, count), rng.uniform(0.0, 20.0, count)
    held = {"mass": 1e9, "stiffness": 1e9, "damping": 0.0}
    scene = scene_of(held, masses, free * KAPPA * masses, 0.3, -1.0, 1.0)
    assert accelerations_at_start(scene) == pytest.approx(pooled(free, masses), abs=1e-6)


def test_a_pair_of_unequal_weights_moves_a_free_rotor_as_one():
    """Against Lagrange's equations of the rotor and one angle, by SciPy."""
    mass, stiffness, damping, unbalance, speed = 2.0, 800.0, 4.0, 0.004, 40.0
    masses, drags, begin = np.array([0.03, 0.08]), np.array([0.3, 0.02]), math.pi - 0.9
    rotor = {"mass": mass, "stiffness": stiffness, "damping": damping, "unbalance": unbalance}
    scene = scene_of(rotor, masses, drags, begin, RATE, speed)
    record = ["rotor.x", "rotor.y", "balls.weight[1].angle", "balls.weight[2].angle"]
    run = cosimulate(scene, record=record)
    behind = np.array([0.0, APART])

    def rate(t, state):
        x, y, vx, vy, phi, turning = state
        along = np.exp(1j * (phi + behind))
        turn = unbalance * speed**2 * np.exp(1j * speed * t)
        push = turn - stiffness * (x + 1j * y) - damping * (vx + 1j * vy)
        push += (masses * RADIUS * turning**2 * along).sum()
        across = masses * RADIUS * along
        matrix = np.array(
            [
                [mass + masses.sum(), 0.0, -across.imag.sum()],
                [0.0, mass + masses.sum(), across.real.sum()],
                [-across.imag.sum(), across.real.sum(), (KAPPA * masses * RADIUS**2).sum()],
            ]
        )
        drag = (drags * RADIUS**2).sum() * (turning - speed)
        ax, ay, gained = np.linalg.solve(matrix, [push.real, push.imag, -drag])
        return [vx, vy, ax, ay, turning, gained]

    start = [0.0, 0.0, 0.0, 0.0, begin, speed + RATE]
    right = solve_ivp(rate, (0.0, run.time[-1]), start, "DOP853", run.time, rtol=1e-12, atol=1e-14)
    first, second = run["balls.weight[1].angle"], run["balls.weight[2].angle"]
    assert np.abs(second - first - APART).max() <= 1e-9
    assert np.abs(first - (right.y[4] - speed * run.time)).max() <= 1e-7
    assert np.ptp(first) > 0.1
    for name, expected in (("rotor.x", right.y[0]), ("rotor.y", right.y[1])):
        assert np.abs(run[name] - expected).max() <= 1e-7 * np.abs(expected).max()
