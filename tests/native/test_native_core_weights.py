"""Point weights and liquid in C against the Python units', over random parameters."""

from __future__ import annotations

import ctypes
import math
from ctypes import byref

import mpmath
import numpy as np
import pytest

from autobalancer.models import weights as described
from autobalancer.models.liquid import Liquid
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
    core.demand(
        "weights_advance", byref(native), angles, speeds, np.array(signal, complex),
        np.array([spin_up, *STEADY]), step, new_angles, new_speeds, byref(memory), None,
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
            "weights_advance", byref(native), angles, speeds, signal,
            np.array([3.0, *STEADY]), 1e-3, angles, speeds,
            byref(core("quadrature_empty")), None,
        )  # fmt: skip
        assert angles.tolist() == apart[0].tolist()
        assert speeds.tolist() == apart[1].tolist()


def test_reactions_of_point_weights_are_those_of_python(core):
    random = np.random.default_rng(5)
    for _ in range(400):
        python, native = _weights(core, random, float(random.choice(DRAGS[:5])))
        angles = random.uniform(-50.0, 50.0, python.count)
        speeds = random.normal(size=python.count) * 100.0
        a, slope, *_ = _signal(random).tolist()
        drive = random.uniform(-900.0, 900.0), random.uniform(-300.0, 300.0)
        expected = points.reaction(python, angles, speeds, a, slope, *drive)
        force, force_slope = core.structures.Complex(), core.structures.Complex()
        core(
            "weights_reaction", byref(native), angles, speeds, a, slope, *drive, 0.0,
            byref(force), byref(force_slope), None,
        )  # fmt: skip
        radius = python.point_capacity * python.damping_rate
        for found, exact, size in (
            (force, expected[0], python.point_capacity * 1e6),
            (force_slope, expected[1], (python.point_capacity + radius) * 1e9),
        ):
            assert abs(complex(found.re, found.im) - exact) <= 1e-15 * max(abs(exact), size)


def test_moment_and_spread_of_weights_are_those_of_python(core):
    random = np.random.default_rng(6)
    for _ in range(100):
        python, native = _weights(core, random)
        angles = random.uniform(-1e3, 1e3, python.count)
        moment = core("weights_static_moment", byref(native), angles, None)
        expected = described.static_moment(python, angles)
        assert abs(complex(moment.re, moment.im) - expected) <= 1e-15 * python.point_capacity
        spread = core("weights_alignment", python.count, angles, None)
        assert spread == pytest.approx(described.alignment(angles), abs=1e-15)
        assert core("weights_added_mass", byref(native)) == python.added_mass
        assert core("weights_damping_rate", byref(native)) == python.damping_rate


def test_response_to_rate_and_drive_is_exact_whatever_the_drag(core):
    phi = np.empty(6)
    for z in [0.0, -1e-12, -1e-3, -0.3, -0.999999, -1.0, -1.0000001, -1.5, -30.0, -1e3, -1e9]:
        core("phi_functions", z, 5, phi)
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


def test_steps_that_python_refuses_are_refused_with_the_numbers_of_its_message(core):
    native = core.structures.Weights(2, 0.01, 0.05, 0.05, 1.4)
    python = Weights(2, 0.01, 0.05, 0.05, 1.4)
    for angles, speeds, signal, step, code in (
        ([0.0, math.nan], [0.0, 0.0], [1.0, 0.0, 0.0, 0.0], 1e-3, "FAILURE_ANGLES"),
        ([0.0, math.inf], [0.0, 0.0], [1.0, 0.0, 0.0, 0.0], 1e-3, "FAILURE_ANGLES"),
        ([0.0, 1.0], [0.0, 2e5], [1e9, 0.0, 0.0, 0.0], 1.0, "FAILURE_SUBSTEPS"),
        ([0.0, 1.0], [0.0, math.nan], [1.0, 0.0, 0.0, 0.0], 1e-3, "FAILURE_NOT_CONVERGED"),
        ([0.0, 1.0], [0.0, 0.0], [0.0, 0.0, 0.0, 1e30], 1e-3, "FAILURE_NOT_CONVERGED"),
    ):
        found, failure = core.refusal(_advance, core, native, angles, speeds, signal, 0.0, step)
        assert found == code
        with pytest.raises(ArithmeticError) as error:
            points.advance(python, angles, speeds, [complex(a) for a in signal], 0.0, step)
        if code != "FAILURE_ANGLES":
            for value in failure.value:
                assert f"{value:.3g}" in str(error.value) or f"{value:g}" in str(error.value)


def test_weights_that_python_refuses_are_refused_in_the_same_order(core):
    good = {"count": 2, "mass": 0.01, "track_radius": 0.05, "drag": 0.05, "kappa": 1.4}
    bad = {
        "count": (0, -1),
        "mass": (0.0, -1.0, math.nan, math.inf),
        "track_radius": (0.0, math.inf),
        "drag": (-1e-9, math.nan, math.inf),
        "kappa": (0.999, math.nan),
    }
    core.demand("weights_check", byref(core.structures.Weights(**good)))
    for name, values in bad.items():
        for value in values:
            changed = good | {"kappa": 0.0, name: value}  # the last one is wrong as well
            native = core.structures.Weights(**changed)
            _, failure = core.refusal(core.demand, "weights_check", byref(native))
            assert failure.name.decode() == name
            assert failure.value[0] == pytest.approx(value, nan_ok=True)
            with pytest.raises(ValueError, match=f"^{name} = "):
                Weights(**changed)


def test_liquid_is_that_of_python(core):
    random = np.random.default_rng(8)
    for _ in range(200):
        outer = random.uniform(0.01, 1.0)
        values = (outer, outer * random.uniform(0.1, 0.999), *random.uniform(0.01, 2e3, 2).tolist())
        python, native = Liquid(*values), core.structures.Liquid(*values)
        core.demand("liquid_check", byref(native))
        assert core("liquid_gap", byref(native)) == python.gap
        assert core("liquid_mass", byref(native)) == pytest.approx(python.liquid_mass, rel=1e-15)
        added = core("liquid_added_mass", byref(native))
        assert added == pytest.approx(python.added_mass, rel=5e-16)
        z = complex(*random.normal(size=2))
        clearance = core("liquid_clearance", byref(native), z)
        assert clearance == pytest.approx(python.clearance(z), abs=4e-16)


def test_liquids_that_python_refuses_are_refused(core):
    good = [0.05, 0.04, 0.02, 1000.0]
    names = ("chamber_radius", "float_radius", "height", "density")
    for k, name in enumerate(names):
        for value in (0.0, -1.0, math.nan, math.inf):
            values = [*good[:k], value, *good[k + 1 :]]
            native = core.structures.Liquid(*values)
            code, failure = core.refusal(core.demand, "liquid_check", byref(native))
            assert (code, failure.name.decode()) == ("FAILURE_NOT_POSITIVE", name)
    native = core.structures.Liquid(0.04, 0.05, 0.02, 1000.0)
    code, failure = core.refusal(core.demand, "liquid_check", byref(native))
    assert (code, *failure.value[:2]) == ("FAILURE_FLOAT_RADIUS", 0.05, 0.04)
