"""The ring part filled with liquid against closed forms, exact solutions and other integrations.

Numbers without a formula beside them are those of an independent program, which shares no code with
this: exact viscous solution by Bessel functions, waves of finite size by collocation, grids.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from autobalancer.models.assembly import Assembly, Mounted, SpeedProfile
from autobalancer.models.boundaries import balancing_regions
from autobalancer.models.linear.critical import critical_speeds
from autobalancer.models.linear.ring_band import critical_speed, ring_of, unstable_band
from autobalancer.models.monolith import simulate
from autobalancer.models.ring import Ring
from autobalancer.models.rotor import LinearRotor
from autobalancer.models.stability import growth_rates
from autobalancer.models.weights import Weights

DRUM = Ring(0.25, 0.2, 0.05, 1000.0)


def ring_of_shares(mass_ratio: float, hollow: float, damping: float = 0.0) -> Ring:
    """A ring of liquid of this mass [kg], with f = `hollow`."""
    area = math.pi * (1.0 - hollow)
    return Ring(1.0, math.sqrt(hollow), 1.0, mass_ratio / area, damping)


def assembly(ring: Ring, mass=1.0, stiffness=1.0, damping=0.0, unbalance=0.0) -> Assembly:
    rotor = LinearRotor.planar(mass, stiffness, damping, unbalance=unbalance)
    return Assembly(rotor, (Mounted("ring", ring),))


@pytest.mark.parametrize(
    ("displacement", "moment", "grid"),
    [(0.02, 0.19635, 0.19636), (0.05, 0.49087, 0.49089), (0.06, 0.56826, 0.56829),
     (0.08, 0.68352, 0.68357), (0.1, 0.77814, 0.77818), (0.3, 1.53424, 1.53431)],
)  # fmt: skip
def test_moment_of_the_liquid_is_that_of_a_grid_of_points(displacement, moment, grid):
    assert DRUM.moment(displacement) == pytest.approx(moment, abs=6e-6)
    assert DRUM.moment(displacement) == pytest.approx(grid, rel=2e-4)
    n = 400
    points = (np.arange(n) + 0.5) / n * 2.0 - 1.0
    x, y = np.meshgrid(points, points)
    inside = x**2 + y**2 < 1.0
    at, across, surface = (
        displacement + 0.25 * x, 0.25 * y, DRUM.surface_radius(displacement)
    )  # fmt: skip
    wet = inside & (at**2 + across**2 > surface**2)
    counted = 1000.0 * 0.05 * (at * wet).sum() * (0.5 / n) ** 2
    assert DRUM.moment(displacement) == pytest.approx(counted, rel=1e-3)


def test_drying_begins_at_the_gap_and_ends_in_a_segment():
    assert DRUM.onset_moment == pytest.approx(0.314159, abs=1e-6)
    assert DRUM.relative_moment(DRUM.gap) == pytest.approx(DRUM.onset_moment, rel=1e-12)
    assert DRUM.surface_radius(0.06) == pytest.approx(0.20176, abs=5e-6)
    assert DRUM.surface_radius(0.1) == pytest.approx(0.22039, abs=5e-6)
    assert DRUM.surface_radius(0.3) == pytest.approx(0.38415, abs=5e-6)
    for displacement, moment in ((0.1, 0.42471), (5.0, 0.48286)):
        assert DRUM.relative_moment(displacement) == pytest.approx(moment, abs=6e-6)
    assert DRUM.capacity == pytest.approx(0.482896, abs=1e-6)
    assert DRUM.relative_moment(500.0) == pytest.approx(DRUM.capacity, rel=1e-5)


def test_most_unbalance_is_undone_before_drying_with_a_surface_at_two_thirds():
    best = max(np.linspace(0.01, 0.24, 231), key=lambda b: Ring(0.25, b, 0.05, 1e3).onset_moment)
    assert best == pytest.approx(2.0 / 3.0 * 0.25, abs=1e-3)


@pytest.mark.parametrize(
    ("whirl", "inviscid", "viscous"),
    [(30.0, 0.939215, 0.93922), (60.0, -0.210084, -0.20976), (130.0, 3.524743, 3.52494),
     (-50.0, 0.963719, 0.96372)],
)  # fmt: skip
def test_force_is_that_of_the_exact_viscous_liquid_of_small_viscosity(whirl, inviscid, viscous):
    share = DRUM.force(whirl, 100.0) / (DRUM.liquid_mass * whirl**2)
    assert share.real == pytest.approx(inviscid, abs=6e-7)
    assert share.real == pytest.approx(viscous, abs=4e-4)


def test_synchronous_force_is_that_of_a_full_chamber():
    full = 1000.0 * math.pi * 0.25**2 * 0.05 * 100.0**2
    assert DRUM.force(100.0, 100.0).real == pytest.approx(full, rel=1e-13)


@pytest.mark.parametrize(
    ("whirl", "linear", "simulated", "within"),
    [(1.0, 2.77778, 2.77777, 2e-5), (0.3, -0.09498, -0.09498, 2e-5), (1.3, 3.94491, 3.94491, 2e-5),
     (0.5, -0.60976, -0.60976, 2e-5), (-0.5, -0.05669, -0.05669, 2e-5),
     (2.2, -4.25457, -4.25562, 2e-3)],
)  # fmt: skip
def test_wave_is_that_of_a_nonlinear_simulation(whirl, linear, simulated, within):
    found = DRUM.response(whirl, 1.0).real
    assert found == pytest.approx(linear, abs=6e-6)
    assert found == pytest.approx(simulated, abs=within)


@pytest.mark.parametrize(
    ("ratio", "hollow", "critical", "low", "high"),
    [(0.1, 0.25, 0.93934, 1.37807, 1.70708), (0.1, 0.5, 0.91287, 1.19400, 1.68824),
     (0.1, 0.64, 0.88465, 1.07762, 1.66607), (0.1, 0.81, 0.80943, 0.89415, 1.62871),
     (0.2, 0.5, 0.84515, 1.07013, 1.70705), (0.5, 0.5, 0.70711, 0.86168, 1.65739),
     (0.02, 0.5, 0.98058, 1.36778, 1.60753)],
)  # fmt: skip
def test_band_in_closed_form_is_that_of_the_eigenvalues(ratio, hollow, critical, low, high):
    ring = ring_of_shares(ratio, hollow)
    machine = assembly(ring)
    assert critical_speed(*ring_of(machine)) == pytest.approx(critical, abs=6e-6)
    assert critical_speeds(machine.loaded_rotor)[0] == pytest.approx(
        critical_speed(*ring_of(machine)), rel=1e-9
    )
    band = unstable_band(*ring_of(machine))
    assert band == pytest.approx((low, high), abs=6e-6)
    rates = growth_rates(machine, [band[0] * 0.9999, band[0] * 1.0001,
                                   band[1] * 0.9999, band[1] * 1.0001])  # fmt: skip
    assert (rates > 1e-5).tolist() == [False, True, True, False]


def test_growth_rates_and_whirls_are_those_of_the_quartic():
    for speed, damping, growth, whirl in (
        (45.0, 0.0, 3.28180, 34.22799), (60.0, 0.0, 6.20547, 40.31167),
        (60.0, 1.2, 6.09111, 40.32829), (120.0, 1.2, 0.11593, 77.52004),
        (120.0, 0.06, 0.31222, 77.52070),
    ):  # fmt: skip
        ring = Ring(0.25, 0.2, 0.05, 1000.0, damping)
        machine = assembly(ring, 10.0, 2.5e4, 40.0)
        rates = machine.loaded_rotor.free_rates(speed)
        most = rates[rates.real.argmax()]
        assert (most.real, most.imag) == pytest.approx((growth, whirl), abs=6e-6)
        assert growth_rates(machine, speed)[0] == pytest.approx(most.real, rel=1e-9)
    rates = assembly(DRUM, 10.0, 2.5e4, 40.0).loaded_rotor.free_rates(60.0) / 1j
    stated = [-43.28105743 + 1.51443209j, 39.88391325 + 7.37827842j, 40.31166539 - 6.20547179j,
              126.03232735 + 0.60357295j]  # fmt: skip
    assert np.sort_complex(rates) == pytest.approx(np.array(stated), abs=1e-7)


@pytest.mark.parametrize(
    ("ratio", "share", "low", "high"),
    [(0.01, 0.01, 1.042, 1.776), (0.01, 0.05, 1.074, 1.664), (0.01, 0.2, 1.010, 1.762),
     (0.05, 0.01, 0.894, 2.454), (0.05, 0.05, 1.048, 1.764), (0.05, 0.2, 1.094, 1.618),
     (0.1, 0.01, 0.804, 3.326), (0.1, 0.05, 1.006, 1.918), (0.1, 0.2, 1.120, 1.600)],
)  # fmt: skip
def test_band_with_both_dampings_begins_and_ends_as_the_eigenvalues_say(ratio, share, low, high):
    def unstable(speed: float) -> bool:
        ring = ring_of_shares(0.1, 0.64, share * speed)
        return bool(growth_rates(assembly(ring, damping=2.0 * ratio), speed)[0] > 1e-7)

    step = 0.004  # the stated ones are those of a grid
    assert [unstable(w) for w in (low - step, low + step)] == [False, True]
    assert [unstable(w) for w in (high - step, high + step)] == [True, False]


def test_one_damping_alone_makes_nearly_all_speeds_unstable():
    of_supports = growth_rates(assembly(ring_of_shares(0.1, 0.64), damping=0.1), [0.5, 3.0, 5.0])
    of_waves = growth_rates(assembly(ring_of_shares(0.1, 0.64, 0.05)), [0.7, 3.0, 5.0])
    assert (of_supports > 0.0).all()
    assert (of_waves > 0.0).tolist() == [False, True, True]


@pytest.mark.parametrize(
    ("viscosity", "share", "exact"), [(1e-6, 0.00110, 0.01944), (1e-4, 0.01098, 0.20978)]
)
def test_damping_by_the_wall_layer_is_near_the_exact_viscous_one(viscosity, share, exact):
    ring = Ring(0.25, 0.2, 1.0, 1000.0, viscosity=viscosity)
    assert ring.damping(100.0) / 100.0 == pytest.approx(share, abs=6e-6)
    held = LinearRotor.planar(1e12, 1e18).with_ring(ring, 0)  # a ring that does not give way
    rates = held.free_rates(100.0) / 1j
    slow = rates[np.abs(rates - 70.2).argmin()]
    assert slow.imag == pytest.approx(exact, rel=0.1)


@pytest.mark.parametrize(
    ("viscosity", "speed", "exact", "within"),
    [(1e-6, 60.0, 3.76394, 0.014), (1e-6, 70.0, 4.68680, 0.014), (1e-6, 90.0, 0.13899, 0.014),
     (1e-4, 70.0, 4.58442, 0.13), (1e-4, 90.0, -0.08655, 0.13)],
)  # fmt: skip
def test_growth_of_a_whole_rotor_is_near_that_with_the_exact_viscous_liquid(
    viscosity, speed, exact, within
):
    ring = Ring(0.25, 0.2, 1.0, 1000.0, viscosity=viscosity)
    mass = 10.0 * ring.liquid_mass
    machine = assembly(ring, mass, mass * 50.0**2, 2.0 * 0.01 * mass * 50.0)
    assert growth_rates(machine, speed)[0] == pytest.approx(exact, abs=within)


def test_unlike_supports_and_a_film_of_viscosity_agree_with_growth_in_time():
    ring = Ring(0.25, 0.2, 0.05, 1000.0, viscosity=1e-4)
    rotor = LinearRotor.planar(10.0, (2.5e4, 2.9e4), 40.0, unbalance=1e-3)
    machine = Assembly(rotor, (Mounted("ring", ring),))
    regions = balancing_regions(machine, 20.0, 150.0)
    assert [c.above for c in regions.crossings][:1] == ["unstable"]
    speed = 60.0
    times = np.array([0.0, 1.5, 3.0])
    motion = simulate(machine, SpeedProfile.constant(speed), times)
    grown = math.log(abs(motion.wave("ring")[2]) / abs(motion.wave("ring")[1])) / 1.5
    assert grown == pytest.approx(growth_rates(machine, speed)[0], rel=0.02)


def test_run_up_follows_the_equations_written_out_for_this_test():
    """In turning axes with all terms of w', apart from the code's fixed axes."""
    ring = Ring(0.25, 0.2, 0.05, 1000.0, 0.4)
    mass, stiffness, damping, unbalance, rise = 10.0, 2.5e4, 40.0, 0.01, 70.0
    f, liquid = ring.hollow, ring.liquid_mass

    def rhs(t, s):
        z, v, y, u = s[:4] + 1j * s[4:]
        w, d = rise * t, 0.4
        turned = np.exp(0.5j * rise * t * t)
        right = np.array([
            unbalance * (w * w - 1j * rise) * turned - damping * v - stiffness * z,
            4j * w * u + 2.0 * w * w * y - d * (u - 1j * w * y),
        ])  # fmt: skip
        a, second = np.linalg.solve([[mass + liquid, liquid * f], [1.0, 1.0 + f]], right)
        rates = np.array([v, a, u, second])
        return np.concatenate([rates.real, rates.imag])

    times = np.linspace(0.0, 1.0, 21)
    solved = solve_ivp(rhs, (0.0, 1.0), np.zeros(8), t_eval=times, rtol=1e-10, atol=1e-14)
    machine = assembly(ring, mass, stiffness, damping, unbalance)
    motion = simulate(machine, SpeedProfile.run_up(0.0, rise, 1.0), times, rtol=1e-10)
    z = motion.x[:, 0] + 1j * motion.y[:, 0]
    expected = solved.y[0] + 1j * solved.y[4]
    assert np.abs(z - expected).max() < 1e-7 * np.abs(expected).max()
    waves = (solved.y[2] + 1j * solved.y[6]) * np.exp(-1j * motion.angle)
    assert np.abs(motion.wave("ring") - waves).max() < 1e-7 * np.abs(waves).max()


def test_balls_beside_a_ring_have_the_growth_of_their_motion_in_time():
    ring = Ring(0.25, 0.2, 0.05, 1000.0, 1.0)
    rotor = LinearRotor.planar(10.0, 2.5e4, 40.0, unbalance=0.02)
    balls = Weights(2, 0.15, 0.1, 0.5, 1.4)
    moved = (2.3018, 3.9812)  # beside pi -+ 0.8411, where they balance
    machine = Assembly(rotor, (Mounted("ring", ring), Mounted("balls", balls, 0, moved)))
    speed = 60.0
    rate = growth_rates(machine, speed)[0]
    motion = simulate(machine, SpeedProfile.constant(speed), [0.0, 0.6, 0.9])
    grown = math.log(abs(motion.wave("ring")[2]) / abs(motion.wave("ring")[1])) / 0.3
    assert grown == pytest.approx(rate, rel=0.03)
