"""Growth rates with their errors: what can be told from zero."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

import autobalancer as ab
from autobalancer.models.linear.growth import Growth, balance, eigenvalues_with_errors
from autobalancer.models.linear.linearised import linearise
from autobalancer.models.stability import find_growth, growth_and_errors, growth_rates


def scene(stiffness=(20e3, 20e3), drag=0.0):
    rotor = {"mass": 2.0, "stiffness": list(stiffness), "damping": 0.0, "unbalance": 0.001}
    balls = {"count": 2, "mass": 0.02, "track_radius": 0.1, "drag": drag}
    return ab.Scene.from_document(
        {
            "rotor": {"kind": "planar", **rotor},
            "balancer": [{"name": "balls", "kind": "balls", **balls}],
            "operation": {"speed": 100.0},
            "run": {"revolutions": 5},
        }
    )


@pytest.mark.parametrize("stiffness", [(20e3, 20e3), (20e3, 45e3)])
def test_a_motion_without_any_damping_is_neutral(stiffness):
    # 300 rad/s is far above both critical speeds
    found = find_growth(scene(stiffness).assembly(), 300.0)
    assert found.state == "neutral", found
    assert found.error < 1e-8


@pytest.mark.parametrize("drag", [1e-9, 1e-6, 0.01, 1e6])
def test_drag_however_small_or_large_is_told_from_none(drag):
    found = find_growth(scene((20e3, 45e3), drag).assembly(), 300.0)
    assert not found.is_neutral, found


def test_the_error_covers_what_rounding_does_to_eigenvalues():
    generator = np.random.default_rng(5)
    for _ in range(40):
        size = int(generator.integers(2, 9))
        units = 10.0 ** generator.uniform(-6, 6, size)
        matrix = generator.standard_normal((size, size)) * units[:, None] / units
        if generator.random() < 0.3:  # two that nearly coincide
            matrix[0, 1:], matrix[1, 2:], matrix[1, 0] = 0.0, 0.0, units[1] / units[0]
            matrix[1, 1] = matrix[0, 0] * (1.0 + 1e-9)
        values, errors = eigenvalues_with_errors(matrix[None])
        with mpmath.workdps(60):
            right = [complex(z) for z in mpmath.eig(mpmath.matrix(matrix.tolist()), right=False)]
        for value, error in zip(values[0], errors[0], strict=True):
            assert min(abs(value - each) for each in right) <= error


def test_errors_of_followed_motions_cover_a_finer_integration():
    system = linearise(ab.load("two_balls").replace({"weights.drag": 1e4}).assembly())
    speeds = np.linspace(0.4, 12.0, 24)
    which = np.zeros(len(speeds), int)
    growth, error = growth_and_errors([system], which, speeds)
    assert (error > 0.0).any()
    import autobalancer.models.stability as module

    slow = error > 0.0
    turns, _ = module.half_turns([system], which, speeds, finer=5)
    finer = np.log(np.abs(np.linalg.eigvals(turns)).max(axis=1)) * speeds / np.pi
    rounding = 1e-13 * speeds  # of this witness
    assert (np.abs(finer - growth)[slow] <= (error + rounding)[slow]).all()


def test_balancing_changes_no_eigenvalue_and_makes_norms_alike():
    generator = np.random.default_rng(2)
    units = 10.0 ** np.array([0.0, 5.0, -7.0, 3.0])
    matrix = generator.standard_normal((4, 4)) * units[:, None] / units
    (balanced,), (factors,) = balance(matrix[None])
    np.testing.assert_array_equal(balanced * factors[:, None] / factors, matrix)
    assert np.trace(balanced) == pytest.approx(np.trace(matrix), rel=1e-12)
    assert np.linalg.norm(balanced) < 10.0


def test_states_follow_from_rate_and_error():
    states = [Growth(rate, 1e-3).state for rate in (-1.0, -1e-4, 1e-4, 1.0)]
    assert states == ["stable", "neutral", "neutral", "unstable"]


def test_rates_with_errors_are_those_without():
    assembly = ab.load("two_balls").assembly()
    assert find_growth(assembly, 6.0).rate == growth_rates(assembly, 6.0)[0]
