"""Point weights and liquid in C against the Python units', over random parameters."""

from __future__ import annotations

import ctypes
from ctypes import byref

import mpmath
import numpy as np
import pytest

from autobalancer.models.steps import weights as points
from autobalancer.models.weights import Weights
from tests.native.equations import STEADY

DRAGS = (0.0, 1e-6, 1e-3, 0.05, 3.0, 1e3, 1e6)


def _weights(core, random, drag=None):
    """Equal weights in Python and C."""
    values = {
        "count": int(random.integers(1, 9)),
        "mass": 10.0 ** random.uniform(-3.0, 0.0),
        "track_radius": 10.0 ** random.uniform(-2.0, 0.0),
        "drag": float(random.choice(DRAGS)) if drag is None else drag,
        "kappa": float(random.choice([1.0, 1.4, 1.5])),
    }
    return Weights(**values), core.structures.Weights(**values)


def _signal(random, size=100.0):
    pairs = random.normal(size=(4, 2)) * size * np.array([[1.0], [1e2], [1e4], [1e6]])
    return pairs @ [1.0, 1.0j]


def _advance(core, native, angles, speeds, signal, spin_up, step, memory=None):
    angles, speeds = np.array(angles, float), np.array(speeds, float)
    new_angles, new_speeds = np.empty_like(angles), np.empty_like(speeds)
    memory = memory or core("quadrature_empty")
    motion = core.centre_motion(signal, 0.0, (spin_up, *STEADY))
    core.demand(
        "weights_advance", byref(native), angles, speeds, motion, step, new_angles, new_speeds,
        byref(memory), None,
    )  # fmt: skip
    return new_angles, new_speeds


@pytest.mark.parametrize("drag", DRAGS)
def test_steps_of_point_weights_are_those_of_python(core, drag):
    random = np.random.default_rng(int(drag) + 1)
    for _ in range(60):
        python, native = _weights(core, random, drag)
        turns = random.choice([0.0, 1.0, 1e3, 1e7])  # far angles lose whole turns on the way
        angles = (random.uniform(-7.0, 7.0, python.count) + turns * 6.0).tolist()
        speeds = (random.normal(size=python.count) * random.choice([0.0, 3.0, 300.0])).tolist()
        signal = _signal(random)
        spin_up = float(random.choice([0.0, random.uniform(-300.0, 300.0)]))
        step = 10.0 ** random.uniform(-7.0, -2.0)
        expected = points.advance(python, angles, speeds, signal.tolist(), spin_up, step)
        found = _advance(core, native, angles, speeds, signal, spin_up, step)
        moved = np.abs(np.array(expected[0]) - angles).max() + np.abs(expected[0]).max()
        assert np.abs(found[0] - expected[0]).max() <= 2e-14 * max(1.0, moved)
        rates = max(1.0, np.abs(speeds).max(), np.abs(expected[1]).max())
        assert np.abs(found[1] - expected[1]).max() <= 2e-13 * rates


def test_a_step_may_overwrite_the_state_it_starts_from(core):
    random = np.random.default_rng(2)
    for turns in (0.0, 1e4):
        _, native = _weights(core, random, 0.05)
        angles = random.uniform(0.0, 7.0, native.count) + turns * 6.0
        speeds, signal = random.normal(size=native.count), _signal(random)
        apart = _advance(core, native, angles, speeds, signal, 3.0, 1e-3)
        core.demand(
            "weights_advance", byref(native), angles, speeds,
            core.centre_motion(signal, 0.0, (3.0, *STEADY)), 1e-3, angles, speeds,
            byref(core("quadrature_empty")), None,
        )  # fmt: skip
        assert angles.tolist() == apart[0].tolist()
        assert speeds.tolist() == apart[1].tolist()


def test_response_to_rate_and_drive_is_exact_whatever_the_drag(core):
    phi = np.empty(6)
    for z in [0.0, -1e-12, -1e-3, -0.3, -0.999999, -1.0, -1.0000001, -1.5, -30.0, -1e3, -1e9]:
        core("phi_functions", z, phi)
        with mpmath.workdps(80):
            exact = [mpmath.hyp1f1(1, k + 1, mpmath.mpf(z)) / mpmath.factorial(k) for k in range(6)]
            errors = [
                abs(mpmath.mpf(a) - b) / (b + 1e-300)
                for a, b in zip(phi.tolist(), exact, strict=True)
            ]
        # the upward recursion loses a factor of at most k!/|z|^k
        assert max(errors) < 2e-14, (z, [float(e) for e in errors])


def test_a_remembered_response_is_not_taken_for_another_step_or_drag(core):
    memory = core("quadrature_empty")
    core.library.quadrature.restype = ctypes.POINTER(ctypes.c_double)
    for drag in (0.0, 2.0, 0.0, 1e5):
        for step in (1e-3, 1e-3, 1e-5):
            found = core("quadrature", byref(memory), drag, step)[:10]
            assert found == pytest.approx(points.quadrature(drag, step), rel=1e-14)
