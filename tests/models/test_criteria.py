"""Closed forms of Dubovik 2006 and Filimonikhina 2017 against each other and plain numerics."""

import math
from dataclasses import replace

import numpy as np
import pytest

from autobalancer.models.assembly import Assembly, Mounted
from autobalancer.models.criteria import Criterion
from autobalancer.models.liquid import Liquid
from autobalancer.models.papers.dimensionless import Dimensionless
from autobalancer.models.papers.tables import TABLE_1, TABLE_2
from autobalancer.models.papers.window import LiquidWindow
from autobalancer.models.rotor import LinearRotor
from autobalancer.models.weights import Weights
from tests.studies.papers import coefficients, positive_roots

LIQUID = Liquid(chamber_radius=0.1, float_radius=0.08, height=0.1, density=1000.0)


def window(**changes):
    values = {
        "rotor_mass": 10.0,
        "stiffness": 1e5,
        "external_damping": 60.0,
        "internal_damping": 40.0,
        "unbalance": 1e-3,
        "liquid": LIQUID,
    }
    return LiquidWindow(**{**values, **changes})


def test_roots_are_those_of_the_quartic_with_the_corrected_constant():
    case, w = window(), 130.0
    m, p, chi, c = case.moving_mass, 40.0, 60.0, 1e5
    a4 = c**2 + (p * w) ** 2  # the print has chi instead of p
    quartic = [m * m, 2 * m * (p + chi), (p + chi) ** 2 + 2 * c * m, 2 * c * (p + chi), a4]
    expected = np.sort_complex(np.roots(quartic))
    ours = np.array([root for s in case.roots(w) for root in (s, s.conjugate())])
    assert np.sort_complex(ours) == pytest.approx(expected, rel=1e-9)


def test_growth_changes_sign_at_the_upper_limit():
    case = window()
    assert case.upper == pytest.approx(2.5 * math.sqrt(1e5 / case.moving_mass), rel=1e-14)
    assert case.roots(case.upper * (1 - 1e-6))[0].real < 0.0
    assert case.roots(case.upper * (1 + 1e-6))[0].real > 0.0


def test_liquid_lessens_bending_above_the_lower_limit_whatever_the_damping():
    for chi in (0.0, 60.0, 1e4):
        case = window(external_damping=chi)
        for factor, less in ((0.99, False), (1.01, True)):
            w = factor * case.lower
            assert (case.bending(w) < case.bending_without(w)) is less


@pytest.mark.parametrize("speed", [20.0, 87.0, 130.0])
def test_bending_and_phase_solve_the_equations_of_steady_motion(speed):
    case = window()
    z = case.bending(speed) * np.exp(1j * case.phase(speed))
    stiffness = 1e5 - 1j * speed * 40.0  # internal damping acts on the turning shaft only
    left = -case.moving_mass * speed**2 * z + 100.0 * 1j * speed * z + stiffness * z
    assert left == pytest.approx(1e-3 * speed**2, rel=1e-12)


def test_without_internal_damping_there_is_no_upper_limit():
    case = window(internal_damping=0.0)
    assert case.upper is None
    assert not case.empty
    assert case.roots(1e5)[0].real < 0.0


def test_window_closes_at_the_stated_external_damping():
    mu = window().mu
    edge = 40.0 * (math.sqrt(2.0 * mu / (1.0 + mu)) - 1.0)  # (1 + chi/p)^2 = 2 mu/(1 + mu)
    assert window(external_damping=edge * 0.999).empty
    assert not window(external_damping=edge * 1.001).empty
    assert window(external_damping=0.0).empty


@pytest.mark.parametrize("unbalance", [1e-4, 1e-3, 0.5])
@pytest.mark.parametrize("chi", [5.0, 200.0, 1e4])
def test_touching_speeds_are_where_bending_exceeds_the_gap(unbalance, chi):
    close = replace(LIQUID, float_radius=0.099)
    case, gap = window(unbalance=unbalance, external_damping=chi, liquid=close), close.gap
    speeds = np.linspace(0.5, 3000.0, 400_001)
    inside = np.zeros(len(speeds), bool)
    for low, high in case.touching_speeds():
        inside |= (speeds > low) & (speeds < (math.inf if high is None else high))
        assert case.bending(low) == pytest.approx(gap, rel=1e-9)
    assert np.array_equal(inside, case.bending(speeds) > gap)


def test_window_of_an_assembly_takes_its_numbers():
    rotor = LinearRotor.planar(10.0, 1e5, 60.0, 40.0, 1e-3, 0.4)
    assert LiquidWindow.of(Assembly(rotor, (Mounted("liquid", LIQUID),))) == window()
    with pytest.raises(ValueError, match="exactly one balancer"):
        LiquidWindow.of(Assembly(rotor))
    with pytest.raises(ValueError, match="equal stiffness"):
        LiquidWindow.of(Assembly(LinearRotor.planar(10.0, (1e5, 2e5)), (Mounted("l", LIQUID),)))


@pytest.mark.parametrize("row", TABLE_1 + TABLE_2)
def test_criterion_roots_are_the_printed_ones(row):
    criterion = Criterion.of(Dimensionless.of_row(row).assembly())
    assert criterion.critical_speeds == pytest.approx(row.criterion, abs=6e-4)
    assert positive_roots(criterion) == len(row.criterion)


def test_roots_agree_with_the_polynomial_and_their_number_with_the_discriminant():
    rng = np.random.default_rng(1)
    for _ in range(300):
        criterion = Criterion(*10.0 ** rng.uniform(-1.0, 1.0, 4))
        roots = np.roots(coefficients(criterion))
        expected = np.sort(np.sqrt(roots[(np.abs(roots.imag) < 1e-9) & (roots.real > 0)].real))
        assert criterion.critical_speeds == pytest.approx(expected, rel=1e-6)
        assert positive_roots(criterion) == len(expected)


def test_coefficients_expand_the_factored_polynomial():
    criterion = Criterion(1.3, 4.0, 0.7, 0.2)
    for w in (0.5, 2.0, 7.0):
        assert np.polyval(coefficients(criterion), w * w) == pytest.approx(criterion.value(w))


def test_equal_stiffness_has_one_critical_speed_whatever_the_damping():
    for damping in ((0.0, 0.0), (0.3, 2.0), (100.0, 0.0)):
        criterion = Criterion(2.0, 2.0, *damping)
        assert criterion.critical_speeds == (2.0,)
        assert positive_roots(criterion) == 1
        assert criterion.value(1.9) > 0.0 > criterion.value(2.1)


def test_roots_keep_their_digits_beside_an_extremely_stiff_axis():
    soft, _, stiff = Criterion(1.0, 1e6, 1e-3, 0.0).critical_speeds
    assert soft == pytest.approx(1.0, abs=1e-12)
    assert stiff == pytest.approx(1e6, rel=1e-12)


def test_criterion_says_what_holds_above_each_speed():
    assert [c.above for c in Criterion(1.0, 7.0).crossings] == ["stable", "unstable", "stable"]
    assert [c.above for c in Criterion(1.0, 7.0, 6.0, 4.0).crossings] == ["stable"]


def test_criterion_refuses_rotors_it_is_not_for():
    with pytest.raises(ValueError, match="internal damping"):
        Criterion.of(Assembly(LinearRotor.planar(1.0, 1.0, 0.1, 0.1)))


def test_dimensionless_form_converts_both_ways():
    device = Weights(count=3, mass=0.02, track_radius=0.3, drag=0.01, kappa=1.4)
    rotor = LinearRotor.planar(4.0, (900.0, 2500.0), (3.0, 5.0), unbalance=0.007)
    form, w_x = Dimensionless.of(Assembly(rotor, (Mounted("w", device, 0, (0.0, 2.0, 4.0)),)))
    assert w_x == pytest.approx(math.sqrt(900.0 / 4.06))
    assert form.eps == pytest.approx(0.06 / (1.4 * 4.06))
    assert form.mu_w == pytest.approx(0.01 / (1.4 * 0.02 * w_x))
    back = form.assembly(total_mass=4.06, frequency=w_x, track_radius=0.3)
    assert float(back.rotor.mass[0, 0]) == pytest.approx(4.0)
    assert float(back.rotor.stiffness_y[0, 0]) == pytest.approx(2500.0)
    assert float(back.rotor.damping_x[0, 0]) == pytest.approx(3.0)
    assert complex(back.rotor.unbalance[0]) == pytest.approx(0.007)
    assert back.balancers[0].device.drag == pytest.approx(0.01)
