"""Goncharov 2017: the table, limits and extremes by independent searches, and the slow root."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest

from autobalancer.models.assembly import Assembly, Mounted
from autobalancer.models.linear.floquet import exponents
from autobalancer.models.linear.linearised import linearise
from autobalancer.models.papers.capacity import (
    best_ratio,
    capacity,
    capacity_shape,
    fastest_count,
    filled_sector,
    full_ratio,
    half_angle,
    largest_alignment,
    packed_alignment,
    packed_angles,
    residual_unbalance,
    weight_mass,
)
from autobalancer.models.papers.settling import (
    critical_drag_factor,
    plane_response,
    settling_time,
    slow_root,
)
from autobalancer.models.rotor import LinearRotor
from autobalancer.models.spacing import closest
from autobalancer.models.weights import Weights, alignment
from tests.studies.papers import completed_angles, fan_angles, slow_roots


def test_errata_of_table_1():
    """One s is cut off, one rounded twice, and three sectors are wrong."""
    printed = [0.105, 0.060, 0.051, 0.044, 0.037, 0.031, 0.027, 0.023]
    found = [capacity_shape("balls", best_ratio("balls", n), n) for n in range(1, 9)]
    rounded = [n for n, s, p in zip(range(1, 9), found, printed, strict=True) if round(s, 3) != p]
    assert rounded == [3]
    assert math.floor(found[2] * 1000) / 1000 == printed[2]
    five = capacity_shape("rollers", best_ratio("rollers", 5), 5)
    assert (round(five, 3), round(round(five, 4), 3)) == (0.139, 0.140)
    sectors = [math.degrees(filled_sector(best_ratio("rollers", n), n)) for n in (5, 7, 8)]
    assert sectors == pytest.approx([195.8, 204.5, 207.5], abs=0.05)


@pytest.mark.parametrize("kind", ["balls", "rollers"])
def test_best_ratio_is_the_maximum_of_a_plain_search(kind):
    for n in range(2, 13):
        grid = np.linspace(1e-4, full_ratio(n) * (1 - 1e-9), 200001)
        s = grid * (1 - grid) ** 2 * np.sin(n * np.arcsin(grid / (1 - grid)))
        s = s * grid if kind == "balls" else s
        assert best_ratio(kind, n) == pytest.approx(grid[s.argmax()], abs=2 * grid[0] + 1e-5)


def test_capacity_is_the_largest_moment_of_weights_side_by_side():
    weights, radius = Weights(5, 0.02, 0.3), 0.05
    alpha = half_angle(radius, 0.3)
    angles = packed_angles(weights, radius, 0.7)
    moment = 0.02 * 0.3 * sum(cmath.exp(1j * x) for x in angles)
    limit = capacity(0.02, 0.3, radius, 5)
    assert moment == pytest.approx(-limit * cmath.exp(0.7j), rel=1e-13)
    assert closest(angles)[0] == pytest.approx(2 * alpha, rel=1e-12)
    rng = np.random.default_rng(0)
    for _ in range(300):  # no other position without overlap has more
        spare = rng.dirichlet(np.ones(5)) * (math.tau - 10 * alpha)
        other = np.cumsum(spare + 2 * alpha)
        assert abs(np.exp(1j * other).sum()) * 0.02 * 0.3 <= limit * (1 + 1e-12)


def test_point_weights_are_the_limit_of_small_ones():
    assert capacity(0.1, 2.0, 0.0, 7) == pytest.approx(1.4)
    assert capacity(0.1, 2.0, 1e-6, 7) == pytest.approx(1.4, rel=1e-10)
    assert largest_alignment(7, 0.0) == packed_alignment(7, 0.0) == 1.0


@pytest.mark.parametrize("count", range(2, 9))
def test_spread_extremes_10_13_are_those_of_the_drawn_positions(count):
    alpha = 0.9 * math.pi / (2 * count)
    assert alignment(packed_angles(Weights(count, 1.0, 1.0), math.sin(alpha))) == pytest.approx(
        packed_alignment(count, alpha), abs=1e-13
    )
    part = count // 2
    near = [alpha * (2 * k - (count - part) + 1) for k in range(count - part)]
    far = [math.pi + alpha * (2 * k - part + 1) for k in range(part)]
    assert alignment(near + far) == pytest.approx(largest_alignment(count, alpha), rel=1e-12)


def test_three_balls_and_five_rollers_settle_fastest():
    assert fastest_count("balls") == 3
    assert fastest_count("rollers") == 5


def test_every_unbalance_up_to_the_capacity_is_balanced_without_overlap():
    weights, radius = Weights(6, 0.02, 0.3), 0.05
    limit = capacity(0.02, 0.3, radius, 6)
    for share in (0.0, 0.1, 0.5, 0.9, 0.999, 1.0):
        angles = fan_angles(weights, radius, share * limit, 0.4)
        moment = 0.006 * sum(cmath.exp(1j * x) for x in angles)
        assert moment == pytest.approx(-share * limit * cmath.exp(0.4j), abs=1e-14)
        assert closest(angles)[0] >= 2 * half_angle(radius, 0.3) * (1 - 1e-9)
        assert residual_unbalance(weights, radius, share * limit) == 0.0
    assert residual_unbalance(weights, radius, 1.2 * limit) == pytest.approx(0.2 * limit)
    with pytest.raises(ValueError, match="balance 0 to"):
        fan_angles(weights, radius, 1.01 * limit)


def test_one_weight_balances_one_unbalance_only():
    weights = Weights(1, 0.02, 0.3)
    assert residual_unbalance(weights, 0.05, 0.004) == pytest.approx(0.002)
    assert residual_unbalance(weights, 0.05, 0.009) == pytest.approx(0.003)
    with pytest.raises(ValueError, match="only"):
        fan_angles(weights, 0.05, 0.006)


def test_impossible_sizes_are_refused():
    with pytest.raises(ValueError, match="track radius"):
        half_angle(0.4, 0.3)
    with pytest.raises(ValueError, match="fill the track at 3"):
        capacity(0.1, 1.0, 0.8, 4)
    with pytest.raises(ValueError, match="fit up to"):
        capacity_shape("balls", 0.47, 3)
    with pytest.raises(ValueError, match="one of balls, rollers"):
        weight_mass("cubes", 0.1, 1.0)
    with pytest.raises(ValueError, match="height"):
        weight_mass("rollers", 0.1, 1.0)


@pytest.mark.parametrize("damping", [0.0, 0.4])
def test_slow_root_is_the_limit_of_the_eigenvalues_for_light_weights(damping):
    errors = []
    for mass in (4e-3, 1e-3):
        weights = Weights(3, mass, 1.0, 2.0 * mass, 1.4)
        unbalance, speed = 0.5 * mass, 2.0
        angles = completed_angles(weights, 0.0, unbalance, [0.4])
        rotor = LinearRotor.planar(1.0, 1.0, damping, unbalance=unbalance)
        loaded = rotor.with_added_mass([weights.added_mass])
        assembly = Assembly(rotor, (Mounted("balls", weights, 0, tuple(angles)),))
        values = exponents([linearise(assembly)], np.zeros(1, int), np.array([speed]))[0]
        exact = [r for r in values if abs(r.imag) < 0.5 and r.real > -0.5]
        exact.sort(key=lambda root: -root.real)
        found = slow_roots(weights, alignment(angles), plane_response(loaded, speed))[:2]
        errors.append(abs(found[0] / exact[0] - 1.0))
        assert found[1] == pytest.approx(exact[1], rel=0.1)
        closed = slow_root(weights, alignment(angles), critical_drag_factor(loaded, speed, 1.4))
        # Goncharov's (1) is this root when the rotor has no damping, and near it with damping
        assert closed == pytest.approx(found[0], rel=1e-9 if damping == 0.0 else 0.2)
    assert errors[1] < 5e-3
    # first order in the mass, second where the rotor has no damping
    assert errors[0] / errors[1] == pytest.approx(4.0 if damping else 16.0, rel=0.2)


def test_critical_drag_of_a_disc():
    rotor = LinearRotor.planar(2.0, 8.0)
    w = 5.0
    expected = math.sqrt(2 * w**4 / (1.4 * (2.0 * w**2 - 8.0)))
    assert critical_drag_factor(rotor, w, 1.4) == pytest.approx(expected, rel=1e-13)
    fast = critical_drag_factor(rotor, 1e4, 1.4) / 1e4
    assert fast == pytest.approx(math.sqrt(2 / (1.4 * 2.0)), rel=1e-6)
    limit = critical_drag_factor(rotor, w)
    for factor in (0.5, 2.0):  # at b = b_cr sqrt((1 - p) m n) the two slow roots meet
        drag = factor * limit * math.sqrt(0.4 * 3 * 0.01)
        root = slow_root(Weights(3, 0.01, 1.0, drag * 0.01), 0.6, limit)
        assert (root.imag != 0.0) == (factor < 1.0)
        assert root.real < 0.0


def test_weights_on_one_diameter_have_a_direction_that_never_settles():
    root = slow_root(Weights(2, 0.01, 1.0, 0.02), 1.0, 3.0)
    assert root == 0.0
    assert settling_time(root) == math.inf
    assert settling_time(-0.5 + 0j) == pytest.approx(math.log(100) / 0.5)


def test_no_slow_root_where_weights_move_to_the_heavy_side():
    with pytest.raises(ValueError, match="heavy side"):
        critical_drag_factor(LinearRotor.planar(1.0, 4.0), 1.5)
    with pytest.raises(ValueError, match="equal stiffness"):
        plane_response(LinearRotor.planar(1.0, [1.0, 2.0]), 3.0)
