"""Impacts of weights on a free rotor: momentum, energy and restitution of the whole machine.

The machine is written down here once more, with the velocity of the rotor as a coordinate.
"""

from __future__ import annotations

import ctypes
import math
from ctypes import POINTER, byref, c_double, c_int
from pathlib import Path

import fmpy
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.optimize import nnls

from autobalancer.harness import Scene
from autobalancer.harness.export.one_file import build_one_file
from tests.native.packaging import Host, compile_units

SOURCE = Path(__file__).parent / "host" / "impact.c"
KAPPA, TRACK = 1.4, 0.3  # of the weights; radius of their track [m]
CARRIER = 2.0  # mass of the rotor without weights [kg]
_D = POINTER(c_double)


class ImpactPair(ctypes.Structure):
    _fields_ = (
        ("behind", c_int), ("ahead", c_int), ("lasting", c_int), ("pushing", c_int),
        ("restitution", c_double), ("right", c_double),
    )  # fmt: skip


class Impact(ctypes.Structure):
    """`Impact` of impact_law.h."""

    _fields_ = (
        ("count", c_int), ("contacts", c_int), ("pairs", POINTER(ImpactPair)), ("rate", _D),
        ("impulse", _D), ("jumps", _D), ("openings", _D), ("square", _D),
    )  # fmt: skip


def collided(core, angles, rates, pairs, mass, restitution, lasting=()):
    """Rates behind the impact of weights on one planar rotor, and its velocity in its axes."""
    n = len(angles)
    core.library.impact_begin.restype = Impact
    memory = np.zeros(core.library.impact_doubles(n))
    impact = core("impact_begin", n, memory)
    impact.contacts = len(pairs)
    matrix, rows = mass_matrix(angles, mass), np.zeros((len(pairs), 2 + n))
    for i, (a, b) in enumerate(pairs):
        impact.pairs[i] = ImpactPair(a, b, int(i in lasting), 0, restitution, 0.0)
        rows[i, [2 + a, 2 + b]] = -1.0, 1.0
    jumps = np.linalg.solve(matrix, rows.T)[2:].ravel()
    for k, rate in enumerate(rates):
        impact.rate[k] = rate
    for i, jump in enumerate(jumps):
        impact.jumps[i] = jump
    core.demand("impact_solve", byref(impact))
    after = np.array(impact.rate[:n])
    # the rotor's momentum and the weights' along x and y are kept
    push = matrix[:2, 2:] @ (after - np.array(rates, float))
    return after, -push / matrix[0, 0]


def mass_matrix(angles, mass):
    """Of the rotor's velocity (2,) and the angles: twice the kinetic energy as a form."""
    n = len(angles)
    matrix = np.zeros((2 + n, 2 + n))
    matrix[:2, :2] = (CARRIER + n * mass) * np.eye(2)
    matrix[2:, 2:] = KAPPA * mass * TRACK**2 * np.eye(n)
    matrix[0, 2:] = matrix[2:, 0] = -mass * TRACK * np.sin(angles)
    matrix[1, 2:] = matrix[2:, 1] = mass * TRACK * np.cos(angles)
    return matrix


RATES = st.lists(st.floats(-50.0, 50.0), min_size=2, max_size=6)
RESTITUTION = st.one_of(st.just(0.0), st.floats(0.0, 1.0))
MASS = st.floats(0.001, 0.4)


@settings(max_examples=200, deadline=None)
@given(RATES, MASS, RESTITUTION, st.floats(0.0, 6.0))
def test_momentum_is_kept_and_energy_falls_in_an_impact(core, rates, mass, restitution, start):
    angles = start + 0.3 * np.arange(len(rates))
    pairs = [(k, k + 1) for k in range(len(rates) - 1)]
    before = np.concatenate([[0.0, 0.0], rates])
    after, jump = collided(core, angles, rates, pairs, mass, restitution)
    after = np.concatenate([jump, after])
    matrix = mass_matrix(angles, mass)
    change, size = matrix @ (after - before), np.abs(matrix @ before).max() + 1e-300
    assert np.abs(change[:2]).max() <= 1e-12 * size  # of rotor and weights
    assert abs(change[2:].sum()) <= 1e-12 * size  # of all weights about the track's centre
    energy, left = before @ matrix @ before, after @ matrix @ after
    assert left <= energy * (1.0 + 1e-12)
    opening = np.diff(after[2:])
    assert opening.min() >= -1e-12 * max(1.0, np.abs(rates).max())


@settings(max_examples=100, deadline=None)
@given(st.floats(-20.0, 20.0), st.floats(0.1, 20.0), MASS, RESTITUTION, st.floats(0.0, 6.0))
def test_a_pair_opens_at_e_times_its_speed_of_closing(core, rate, closing, mass, e, start):
    """And takes (1 - e^2)/2 of the energy of approach, with the mass of the whole machine."""
    angles, rates = np.array([start, start + 0.2]), np.array([rate, rate - closing])
    after, jump = collided(core, angles, rates, [(0, 1)], mass, e)
    assert after[1] - after[0] == pytest.approx(e * closing, abs=1e-12 * (closing + abs(rate)))
    matrix = mass_matrix(angles, mass)
    gap = np.array([0.0, 0.0, -1.0, 1.0])
    lost = 0.5 * (1.0 - e**2) * closing**2 / (gap @ np.linalg.solve(matrix, gap))
    before, after = np.array([0.0, 0.0, *rates]), np.concatenate([jump, after])
    found = 0.5 * (before @ matrix @ before - after @ matrix @ after)
    assert found == pytest.approx(lost, abs=1e-12 * 0.5 * (before @ matrix @ before))


@settings(max_examples=200, deadline=None)
@given(RATES, MASS, st.floats(0.0, 0.9))
def test_several_pairs_are_a_complementarity_problem(core, rates, mass, e):
    """The first impact of weights that all approach each other, by least squares."""
    rates = np.sort(rates)[::-1]
    assume(np.abs(np.diff(rates)).min() > 1e-6)
    n = len(rates)
    angles = 0.25 * np.arange(n)
    pairs = [(k, k + 1) for k in range(n - 1)]
    after, _ = collided(core, angles, rates, pairs, mass, e)
    rows = np.hstack([np.zeros((n - 1, 2)), np.diff(np.eye(n), axis=0)])
    inverse = np.linalg.inv(mass_matrix(angles, mass))
    factor = np.linalg.cholesky(rows @ inverse @ rows.T).T
    right = (1.0 + e) * np.diff(rates)
    impulses = nnls(factor, -np.linalg.solve(factor.T, right))[0]
    expected = rates + (inverse @ rows.T @ impulses)[2:]
    assert after == pytest.approx(expected, abs=1e-9 * np.abs(rates).max())


def test_a_contact_that_lasts_pulls_as_well(core):
    after, _ = collided(core, [0.0, 0.3], [0.0, 1.0], [(0, 1)], 0.1, 0.5, lasting=(0,))
    assert after[1] == pytest.approx(after[0], abs=1e-15)


BALL = 0.03  # radius [m]
ALPHA = math.asin(BALL / TRACK)
MACHINE = {
    "rotor": {
        "kind": "two_support",
        "mass": 12.0,
        "inertia": 0.4,
        "span": 0.6,
        "stiffness": [2e4, 3e4],
        "damping": [50.0, 20.0],
        "planes": [0.1, 0.5],
        "unbalances": [{"position": 0.2, "amount": 0.01}],
    },
    "balancer": [
        {"name": "left", "kind": "balls", "count": 3, "mass": 0.2, "track_radius": TRACK,
         "weight_radius": BALL, "drag": 0.1, "at": 1, "restitution": 0.4,
         "angles": [1.0, 1.0 + 2 * ALPHA, 3.5], "speeds": [5.0, -3.0, 1.0]},
        {"name": "right", "kind": "balls", "count": 2, "mass": 0.3, "track_radius": TRACK,
         "weight_radius": BALL, "drag": 0.1, "at": 2, "restitution": 0.0,
         "angles": [4.0, 4.0 + 2 * ALPHA], "speeds": [2.0, -6.0]},
    ],
    "operation": {"speed": 100.0},
}  # fmt: skip


@pytest.fixture(scope="module")
def probed(tmp_path_factory):
    """The one file of `MACHINE` in a library that lets its weights collide on demand."""
    folder = tmp_path_factory.mktemp("impact")
    path = build_one_file(Scene.from_document(MACHINE), folder / "one.fmu",
                          platforms=[fmpy.platform_tuple])  # fmt: skip
    library = compile_units(folder / "probe", SOURCE, "-O0")
    return Host(path, library=library).begin(), ctypes.CDLL(str(library))


@pytest.mark.slow
def test_the_one_file_lets_the_whole_machine_collide(probed):
    """Both pairs at once, each with its restitution, and the rotor with its tilting inertia."""
    host, library = probed

    def read(*names):
        return np.array(host.get(*names))

    counts = {"left": 3, "right": 2}
    names = [f"{b}.weight[{k}].{{}}" for b, n in counts.items() for k in range(1, n + 1)]
    angles = read(*(name.format("angle") for name in names))
    rates = [name.format("speed") for name in names]
    velocities = [f"rotor.station[{k}].{v}" for k in (1, 2) for v in ("vx", "vy")]
    before = np.concatenate([read(*velocities), read(*rates)])
    library.collide_now.argtypes = [ctypes.c_void_p]
    assert library.collide_now(host.slave.component) == 1
    after = np.concatenate([read(*velocities), read(*rates)])

    rotor = MACHINE["rotor"]
    mass, inertia, span = rotor["mass"], rotor["inertia"], rotor["span"]
    own = np.array([[1.0, 1.0], [1.0, 1.0]]) * mass / 4.0
    own += np.array([[1.0, -1.0], [-1.0, 1.0]]) * inertia / span**2
    matrix = np.zeros((9, 9))
    matrix[:4, :4] = np.kron(own, np.eye(2))
    k = 4
    for b, place in zip(MACHINE["balancer"], rotor["planes"], strict=True):
        row = np.kron([1.0 - place / span, place / span], np.eye(2))  # velocity of the plane
        for _ in range(b["count"]):
            along = TRACK * np.array([-math.sin(angles[k - 4]), math.cos(angles[k - 4])])
            matrix[:4, :4] += b["mass"] * row.T @ row
            matrix[k, :4] = matrix[:4, k] = b["mass"] * along @ row
            matrix[k, k] = KAPPA * b["mass"] * TRACK**2
            k += 1
    change = matrix @ (after - before)
    size = np.abs(matrix @ before).max()
    assert np.abs(change[:4]).max() < 1e-12 * size
    assert abs(change[4:7].sum()) < 1e-12 * size
    assert abs(change[7:].sum()) < 1e-12 * size
    assert after[5] - after[4] == pytest.approx(0.4 * 8.0, rel=1e-12)
    assert after[8] - after[7] == pytest.approx(0.0, abs=1e-12)
    rows = np.zeros((2, 9))
    rows[0, [4, 5]] = rows[1, [7, 8]] = -1.0, 1.0
    response = rows @ np.linalg.solve(matrix, rows.T)
    # one impact in which each pair has its own restitution
    impulses = np.linalg.solve(response, np.array([1.4, 1.0]) * 8.0)
    expected = before + np.linalg.solve(matrix, rows.T @ impulses)
    assert after == pytest.approx(expected, rel=1e-11)
    lost = 0.5 * (before @ matrix @ before - after @ matrix @ after)
    assert lost == pytest.approx(0.5 * impulses @ np.array([0.6, 1.0]) * 8.0, rel=1e-11)
