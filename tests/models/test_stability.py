"""Stability of the main motion against the paper's tables and an independent integration."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import block_diag

from autobalancer.models.assembly import Assembly, Mounted, SpeedProfile
from autobalancer.models.boundaries import balancing_boundaries, growth_regions
from autobalancer.models.linear import floquet
from autobalancer.models.linear.balanced import CannotBalance, balanced_angles
from autobalancer.models.linear.linearised import linearise
from autobalancer.models.linear.regions import Regions
from autobalancer.models.linear.weight_table import WeightTable, residual_unbalance
from autobalancer.models.liquid import Liquid
from autobalancer.models.papers.dimensionless import Dimensionless
from autobalancer.models.papers.tables import TABLE_1, TABLE_2
from autobalancer.models.papers.window import LiquidWindow
from autobalancer.models.reference.coupled import Monolith
from autobalancer.models.rotor import LinearRotor
from autobalancer.models.stability import growth_map, growth_rates
from autobalancer.models.weights import Weights, alignment
from tests.floquet import multipliers

pytestmark = pytest.mark.slow

LIQUID = Liquid(chamber_radius=0.1, float_radius=0.08, height=0.01, density=1000.0)


def is_stable(assembly, speeds):
    """Where every deviation but the neutral turns decays, by more than rounding in a revolution."""
    w = np.atleast_1d(speeds)
    return growth_rates(assembly, w) * (2.0 * math.pi / w) < -1e-10


def balls(count=2, mass=0.01, unbalance=0.005, stiffness=(1.0, 49.0), damping=(0.5, 1.0), **more):
    options = {"drag": 0.003, "kappa": 1.0, "internal": 0.0, "angles": None, "track": 1.0, **more}
    angles = options["angles"] or [2.0 * math.pi * (k + 0.3) / count for k in range(count)]
    device = Weights(count, mass, options["track"], options["drag"], options["kappa"])
    rotor = LinearRotor.planar(0.98, stiffness, damping, options["internal"], unbalance, 0.4)
    return Assembly(rotor, (Mounted("balls", device, 0, tuple(angles)),))


def two_stations(isotropic):
    """A coupled rotor with gyroscopic and internal damping, and two balancers on two planes."""
    k_x = np.array([[3.0, -0.4], [-0.4, 2.0]])
    k_y = k_x if isotropic else np.array([[5.0, -0.3], [-0.3, 7.0]])
    c_x = np.array([[0.2, 0.02], [0.02, 0.3]])
    rotor = LinearRotor.from_matrices(
        mass=np.array([[1.0, 0.2], [0.2, 0.8]]),
        damping=block_diag(c_x, c_x if isotropic else 1.5 * c_x),
        stiffness=block_diag(k_x, k_y),
        internal_damping=np.array([[0.02, 0.0], [0.0, 0.03]]),
        gyroscopic=np.array([[0.3, -0.3], [-0.3, 0.3]]),
        planes=np.array([[0.9, 0.1], [-0.2, 1.2]]),
        unbalance=np.array([0.01 + 0.004j, -0.003 + 0.006j]),
    )
    first = Mounted("first", Weights(2, 0.02, 0.7, 0.006, 1.4), 0, (2.0, 4.0))
    second = Mounted("second", Weights(3, 0.01, 0.9, 0.01, 1.0), 1, (0.5, 2.5, 4.5))
    return Assembly(rotor, (first, second))


def one_turn_map(assembly, speed):
    """Multipliers of the nonlinear equations in fixed axes, with absolute angles.

    Derivatives of the map after a revolution by central differences.
    """
    system = Monolith(assembly, SpeedProfile.constant(speed))
    start = np.zeros(system.size)
    start[4 * system.stations :] = np.append(
        balanced_angles(assembly), np.full(system.weights, speed)
    )
    period, h = 2.0 * math.pi / speed, 1e-4

    def after(y):
        run = solve_ivp(system.rhs, (0.0, period), y, "DOP853", rtol=1e-12, atol=1e-14)
        return run.y[:, -1]

    columns = [
        (8 * (after(start + h * e) - after(start - h * e)) - after(start + 2 * h * e)
         + after(start - 2 * h * e)) / (12 * h)
        for e in np.eye(len(start))
    ]  # fmt: skip
    return np.linalg.eigvals(np.array(columns).T)


def paired(ours, theirs):
    """Largest distance between two sets of multipliers after greedy pairing."""
    left, worst = list(theirs), 0.0
    for value in sorted(ours, key=lambda z: -abs(z)):
        nearest = min(left, key=lambda z: abs(z - value))
        left.remove(nearest)
        worst = max(worst, abs(nearest - value))
    return worst


@pytest.mark.parametrize(
    ("assembly", "speed", "within"),
    [
        (balls(), 3.0, 1e-8),
        (balls(internal=0.1, kappa=1.4, track=0.3, unbalance=0.002), 1.05, 1e-8),
        # a double multiplier 1 (N - 2 = 2) splits by the root of the differences' error
        (balls(count=3), 6.0, 1e-7),
        (two_stations(isotropic=False), 2.2, 1e-7),
        (two_stations(isotropic=True), 1.7, 1e-7),
        (Assembly(balls().rotor, (*balls().balancers, Mounted("liquid", LIQUID))), 2.5, 1e-8),
    ],
)
def test_multipliers_agree_with_an_independent_integration(assembly, speed, within):
    ours = multipliers(assembly, [speed])[0]
    assert paired(ours, one_turn_map(assembly, speed)) < within


@pytest.mark.parametrize("row", TABLE_1 + TABLE_2)
def test_published_intervals_hold_the_critical_speeds(row):
    # Table 2: the paper's finite time of integration takes very slow growth for stable
    allowed = 0.0003 if row.table == 1 else 0.022
    speeds = [
        c.speed for c in balancing_boundaries(Dimensionless.of_row(row).assembly(), 0.5, 13.0)
    ]
    for low, high in row.intervals:
        assert any(low - allowed <= speed <= high + allowed for speed in speeds)


def test_second_unstable_bands_the_paper_does_not_report():
    cases = {
        (0.1, 0.25, 0.5): (10.2, 11.4),
        (0.01, 1.0, 2.0): (5.49, 7.86),
        (0.01, 0.5, 1.5): (5.40, 7.96),
    }
    for (eps, mu_xi, mu_eta), (low, high) in cases.items():
        assembly = Dimensionless(eps, mu_xi, mu_eta, 0.5, 7.0, 0.5).assembly()
        around = [low - 0.05, (low + high) / 2.0, high + 0.05]
        assert is_stable(assembly, around).tolist() == [True, False, True]
        largest = np.abs(one_turn_map(assembly, around[1])).max()
        assert largest > 1.01
        rate = math.log(largest) * around[1] / (2 * math.pi)
        assert growth_rates(assembly, around[1])[0] == pytest.approx(rate, rel=1e-6)


@pytest.mark.parametrize("row", [TABLE_1[3], TABLE_1[6], TABLE_2[8]])
def test_boundaries_do_not_move_under_doubled_discretisation(row, monkeypatch):
    assembly = Dimensionless.of_row(row).assembly()
    once = balancing_boundaries(assembly, 0.5, 13.0, narrowest=0.1, tolerance=1e-12)
    monkeypatch.setattr(floquet, "_RADIANS", floquet._RADIANS / 2.0)
    monkeypatch.setattr(floquet, "_FEWEST", floquet._FEWEST * 2)
    twice = balancing_boundaries(assembly, 0.5, 13.0, narrowest=0.1, tolerance=1e-12)
    assert [c.above for c in once] == [c.above for c in twice]
    assert [c.speed for c in once] == pytest.approx([c.speed for c in twice], abs=1e-8)


def test_a_growth_that_does_not_depend_on_the_speed_is_not_looked_into():
    """Rounding gives it a least value between any three speeds."""
    asked = []

    def growth(speeds):
        asked.append(speeds.size)
        return -2.0 * (1.0 + 1e-13 * np.sin(1e5 * speeds)), np.zeros_like(speeds)

    assert growth_regions(growth, np.linspace(1.0, 2.0, 101)) == Regions("stable")
    assert asked == [101]


def test_isotropic_rotor_by_eigenvalues_is_the_limit_of_floquet():
    speeds = [0.7, 1.05, 1.5, 3.0]
    near = growth_rates(balls(stiffness=(1.0, 1.0 + 1e-9), damping=0.1), speeds)
    exact = growth_rates(balls(stiffness=1.0, damping=0.1), speeds)
    assert near == pytest.approx(exact, rel=1e-6)


def test_isotropic_rotor_becomes_stable_near_its_natural_frequency():
    assembly = balls(mass=1e-4, unbalance=5e-5, drag=1e-3, stiffness=1.0, damping=0.3)
    first = balancing_boundaries(assembly, 0.3, 5.0)
    natural = math.sqrt(1.0 / 0.9802)
    assert [c.above for c in first] == ["stable"]
    assert first[0].speed == pytest.approx(natural, rel=1e-3)


@pytest.mark.parametrize("count", [3, 4, 6])
@pytest.mark.parametrize("stiffness", [(1.0, 49.0), (1.0, 1.0)])
def test_neutral_turns_of_many_weights_are_exact_and_no_instability(count, stiffness):
    assembly = balls(count=count, stiffness=stiffness, mass=0.02 / count, drag=0.05 / count)
    result = multipliers(assembly, [3.0])[0]
    assert linearise(assembly).neutral == count - 2
    assert len(result) == 4 + 2 * count
    assert (result[-(count - 2) :] == 1.0).all()
    assert np.abs(result[: -(count - 2)]).max() < 0.99
    assert is_stable(assembly, 3.0)[0]


def test_neutral_directions_do_not_hide_an_instability_close_to_one():
    assembly = balls(count=4)
    edge = balancing_boundaries(assembly, 0.5, 2.0)[0].speed
    assert is_stable(assembly, [edge - 1e-6, edge + 1e-6]).tolist() == [False, True]


def test_two_opposite_weights_have_their_slow_direction():
    assembly = balls(unbalance=0.0, angles=(0.3, 0.3 + math.pi))
    assert linearise(assembly).neutral == 1
    assert balanced_angles(assembly) == pytest.approx([0.3, 0.3 + math.pi])


def test_weights_of_two_balancers_on_one_plane_share_their_neutral_turns():
    base = balls(count=2)
    other = Mounted("more", Weights(2, 0.004, 0.5, 0.002, 1.4), 0, (1.0, 3.0))
    assembly = Assembly(base.rotor, (*base.balancers, other))
    assert linearise(assembly).neutral == 2
    result = multipliers(assembly, [3.0])[0]
    assert len(result) == 12
    assert paired(result, one_turn_map(assembly, 3.0)) < 1e-7


def test_weights_are_turned_to_balance_plane_by_plane():
    for assembly in (balls(), balls(count=5), two_stations(isotropic=False)):
        left = residual_unbalance(assembly, WeightTable.of(assembly), balanced_angles(assembly))
        assert np.abs(left).max() < 1e-12
    given = Dimensionless.of_row(TABLE_1[0]).assembly()
    assert balanced_angles(given) == pytest.approx([2 * math.pi / 3, 4 * math.pi / 3], abs=1e-12)


def test_evenly_spread_weights_balance_without_standing_on_one_line():
    # by symmetry least turns would take the four to 0, pi, pi, pi: nothing drives them across
    angles = tuple(0.4 + 0.5 * math.pi * k for k in range(4))  # the unbalance is at 0.4
    even = balls(count=4, unbalance=2 * 0.01, angles=angles)
    assert alignment(balanced_angles(even)) < 0.95
    given = (0.4, *[0.4 + math.pi] * 3)  # asked for, it is kept
    chosen = balls(count=4, unbalance=2 * 0.01, angles=given)
    assert balanced_angles(chosen) == pytest.approx(given)


@pytest.mark.parametrize("count", [2, 3, 4, 7])
@pytest.mark.parametrize("share", [0.0, 0.3, 0.99, 0.9999, 1.0])
def test_balance_is_found_from_zero_unbalance_to_the_capacity(count, share):
    assembly = balls(count=count, unbalance=share * count * 0.01)
    left = residual_unbalance(assembly, WeightTable.of(assembly), balanced_angles(assembly))
    assert np.abs(left).max() < 1e-11 * count * 0.01


@pytest.mark.parametrize("share", [0.0, 1e-12, 1e-9, 1e-7, 1e-5, 1.0 - 1e-12, 1.0])
@pytest.mark.parametrize("angles", [(2.0, 4.0), (0.3, 0.3), (0.3, 1.0)])
def test_two_weights_balance_however_little_or_much_they_have_to(share, angles):
    assembly = balls(unbalance=0.02 * share, angles=angles)
    left = residual_unbalance(assembly, WeightTable.of(assembly), balanced_angles(assembly))
    assert abs(left[0]) < 2e-12 * 0.04


@pytest.mark.parametrize("count", [2, 3, 4, 7])
@pytest.mark.parametrize("share", [0.0, 0.3, 0.7, 0.99, 0.9999])
def test_weights_of_finite_size_balance_apart_from_zero_unbalance_to_their_packed_moment(
    count, share
):
    alpha = 0.7 * math.pi / (2.0 * count)
    packed = 0.01 * math.sin(count * alpha) / math.sin(alpha)  # Goncharov 2017 (5)
    base = balls(count=count, unbalance=share * packed)
    assembly = Assembly(base.rotor, (replace(base.balancers[0], half_angle=alpha),))
    angles = balanced_angles(assembly)
    left = residual_unbalance(assembly, WeightTable.of(assembly), angles)
    assert np.abs(left).max() < 1e-11 * count * 0.01
    between = np.diff(np.sort(angles % math.tau), append=np.min(angles % math.tau) + math.tau)
    assert between.min() > 2.0 * alpha - 1e-6
    beyond = replace(assembly, rotor=balls(count=count, unbalance=1.0001 * packed).rotor)
    with pytest.raises(CannotBalance, match=f"its {count} weights can make at most") as refusal:
        balanced_angles(beyond)
    needs, makes = (float(number) for number in re.findall(r"([\d.]+) g m", str(refusal.value)))
    assert makes == pytest.approx(1e3 * packed, rel=5e-4)  # four digits or more
    assert needs > makes


def test_weights_that_cannot_balance_are_refused_with_both_numbers():
    with pytest.raises(CannotBalance, match=r"21 g m.*at most 20 g m") as caught:
        growth_rates(balls(unbalance=0.021), 3.0)
    assert caught.value.needed == pytest.approx(0.021)
    assert caught.value.capacity == pytest.approx(0.02)
    with pytest.raises(CannotBalance, match="no less than"):
        growth_rates(balls(count=1, unbalance=0.005), 3.0)
    two = two_stations(isotropic=True)
    with pytest.raises(CannotBalance, match=r"whatever the weights are, \d+ % of its force"):
        growth_rates(Assembly(two.rotor, two.balancers[:1]), 3.0)


def test_liquid_alone_has_dubovik_roots_and_limit():
    rotor = LinearRotor.planar(10.0, 1e5, 60.0, 40.0, 1e-3)
    liquid = Liquid(0.1, 0.08, 0.1, 1000.0)
    assembly = Assembly(rotor, (Mounted("liquid", liquid),))
    window = LiquidWindow.of(assembly)
    speeds = [50.0, 180.0, 250.0]
    expected = [window.roots(w)[0].real for w in speeds]
    assert growth_rates(assembly, speeds) == pytest.approx(expected, rel=1e-9)
    crossings = balancing_boundaries(assembly, 20.0, 400.0)
    assert [c.above for c in crossings] == ["unstable"]
    assert crossings[0].speed == pytest.approx(window.upper, rel=1e-8)


def test_bands_far_narrower_than_the_scan_are_found():
    # the second band above n3 closes as mu_w grows towards 0.755
    assembly = Dimensionless(0.1, 0.25, 0.5, 0.7553, 7.0, 0.5).assembly()
    fine = balancing_boundaries(assembly, 10.0, 13.0, narrowest=0.002)
    coarse = balancing_boundaries(assembly, 10.0, 13.0, narrowest=0.5)
    assert [c.above for c in fine] == ["unstable", "stable"]
    assert fine[1].speed - fine[0].speed < 0.03
    assert [c.speed for c in coarse] == pytest.approx([c.speed for c in fine], rel=1e-8)


def test_a_band_wider_than_the_stated_width_is_not_missed():
    assembly = Dimensionless(0.01, 1.0, 2.0, 0.5, 7.0, 0.5).assembly()
    found = balancing_boundaries(assembly, 0.5, 9.0, narrowest=2.0)
    assert [c.above for c in found] == ["stable", "unstable", "stable"]


def test_an_extremely_stiff_axis_is_a_rigid_one():
    speeds = [0.5, 0.98, 1.05, 3.0]
    rigid = growth_rates(balls(stiffness=(1.0, 1e8)), speeds)
    assert growth_rates(balls(stiffness=(1.0, 1e10)), speeds) == pytest.approx(rigid, rel=2e-5)
    assert (is_stable(balls(stiffness=(1.0, 1e12)), speeds) == (rigid < 0.0)).all()


def test_fast_motions_are_not_taken_for_damped():
    # an axis of negative damping whose frequency is 10^4 times the speed; weights next to nothing
    assembly = balls(stiffness=(1.0, 1e8), damping=(0.5, -0.2), mass=1e-6, drag=3e-7, unbalance=0.0)
    assert growth_rates(assembly, 1.5)[0] == pytest.approx(0.1 / 0.98, rel=1e-4)
    # with weights: against a frequency that is followed turn by turn
    slow, fast = (growth_rates(balls(stiffness=(1.0, k), damping=(0.5, -0.2)), 1.5)[0]
                  for k in (1e4, 1e8))  # fmt: skip
    assert fast == pytest.approx(slow, rel=1e-3)


def test_drag_of_any_size_locks_the_weights_smoothly():
    speeds = [0.5, 3.0, 6.0]
    slow = [growth_rates(balls(drag=d), speeds) * d for d in (1e2, 1e4, 1e6)]
    assert slow[1] == pytest.approx(slow[0], rel=1e-2)
    assert slow[2] == pytest.approx(slow[1], rel=1e-2)


def test_an_undamped_rotor_without_weights_is_neither_stable_nor_critical():
    assembly = Assembly(LinearRotor.planar(1.0, (1.0, 49.0)))
    assert not is_stable(assembly, [0.5, 3.0]).any()
    assert balancing_boundaries(assembly, 0.5, 9.0) == []


def test_wrong_speeds_are_refused():
    for speed in (0.0, -1.0, math.nan):
        with pytest.raises(ValueError, match="rad/s"):
            growth_rates(balls(), speed)
    with pytest.raises(OverflowError, match="1e-300 rad/s: no double holds"):
        growth_rates(balls(), [1e-300, 1.0])
    with pytest.raises(ValueError, match="ascending"):
        balancing_boundaries(balls(), 3.0, 2.0)


def test_a_map_solves_its_points_in_batches(monkeypatch):
    """2,000 points: fifty times fewer solves than one by one, which is what makes maps quick."""
    batches, solve = [], np.linalg.solve

    def counted(a, b):
        if np.ndim(a) == 3:
            batches.append(len(a))
        return solve(a, b)

    monkeypatch.setattr(np.linalg, "solve", counted)
    drags = np.geomspace(1e-3, 1e-1, 40)
    growth = growth_map([balls(drag=d) for d in drags], np.linspace(0.5, 9.0, 50))
    assert np.isfinite(growth).all()
    assert np.mean(batches) > 50.0
