"""Bodies that carry a rotor, hang on it or fly freely: closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from autobalancer.models.bodies import Body, Foot, with_bodies
from autobalancer.models.forces import forces, hand_weight, largest
from autobalancer.models.linear.critical import critical_speeds
from autobalancer.models.linear.modes import modes
from autobalancer.models.linear.rigid import rigid_rates
from autobalancer.models.papers.influence import influence
from autobalancer.models.rotor import LinearRotor


def response(rotor, speed):
    return influence(rotor, speed, np.eye(rotor.stations)) @ rotor.unbalance


def on_a_tub(damped=True, internal=0.0, unbalance=0.01, feet=6e4):
    c = (40.0, 200.0) if damped else (0.0, 0.0)
    rotor = LinearRotor.planar(10.0, 4e4, c[0], internal, unbalance)
    stands = (Foot(0.0, (feet, feet), (c[1], c[1])),) if feet else ()
    return with_bodies(rotor, [0.0], [0.0], [Body("tub", 30.0, feet=stands)], "tub")


@pytest.mark.parametrize(
    ("speed", "rotor", "tub", "floor"),
    [
        (20.0, 0.22382037, 0.10160584, 6.10988294),
        (40.0, 2.06708990, 1.56489608, 94.72469955),
        (80.0, 5.21054569, 2.22476042, 138.15027743),
        (200.0, 1.11502694, 0.04131010, 2.97891371),
    ],
)
def test_disc_tub_and_floor_answer_the_unbalance_as_two_masses_do(speed, rotor, tub, floor):
    machine = on_a_tub()
    motion = response(machine, speed)
    assert 1e3 * np.abs(motion[0]) == pytest.approx([rotor, tub], rel=1e-7)
    found = {one.name: one for one in forces(machine, motion, speed)}
    assert list(found) == ["support[1]", "tub.foot[1]"]
    assert found["tub.foot[1]"].amplitude == pytest.approx(floor, rel=1e-8)


def test_two_masses_have_their_natural_frequencies_and_a_free_pair_its_one():
    found = modes(on_a_tub(damped=False), 0.0).natural_frequencies
    assert found == pytest.approx([36.51483717, 36.51483717, 77.45966692, 77.45966692], rel=1e-9)
    free = on_a_tub(damped=False, feet=0.0)
    assert modes(free, 0.0).natural_frequencies[2:] == pytest.approx([73.02967434] * 2, rel=1e-9)
    assert critical_speeds(free) == pytest.approx([73.02967434], rel=1e-9)


def test_internal_damping_acts_on_the_motion_relative_to_the_tub():
    """Unstable above 237.4371 rad/s; of the absolute motion it would be 150.67."""
    machine = on_a_tub(internal=30.0)
    threshold = brentq(lambda w: machine.free_rates(w).real.max(), 50.0, 1000.0)
    assert threshold == pytest.approx(237.437100, rel=1e-8)


def tilting_tub():
    rotor = LinearRotor.two_support(
        mass=12.0, inertia=0.5, polar_inertia=0.3, span=0.4,
        stiffness=[[5e4, 5e4]] * 2, planes=[0.3], unbalances=[(0.3, 2e-3, 0.0)],
    )  # fmt: skip
    feet = tuple(Foot(z, (2e4, 2e4)) for z in (0.0, 0.4))
    tub = Body("tub", 30.0, inertia=1.2, centre=0.2, feet=feet)
    return with_bodies(rotor, [0.0, 0.4], [0.3], [tub], "tub")


def test_a_tub_tilts_with_the_frequencies_of_the_polynomial():
    rates = np.linalg.eigvals(tilting_tub().first_order(150.0)).imag
    expected = [
        *(-109.91006785, -30.32782527, 30.32782527, 109.91006785),
        *(-89.37147315, -17.51795403, 44.79552374, 152.09390343),
    ]
    assert np.sort(rates) == pytest.approx(np.sort(expected), rel=1e-8)


def test_unbalance_beside_the_middle_moves_rotor_tub_and_feet_as_computed_apart():
    machine = tilting_tub()
    motion = response(machine, 150.0)
    expected = [-3.93136807, 3.33655646, 0.73483515, -0.62365541]
    assert 1e3 * motion[0].real == pytest.approx(expected, rel=1e-8)
    found = {one.name: one.amplitude for one in forces(machine, motion, 150.0)}
    assert found["tub.foot[1]"] == pytest.approx(14.69670307, rel=1e-8)
    assert found["tub.foot[2]"] == pytest.approx(12.47310825, rel=1e-8)


@pytest.mark.parametrize(
    ("ratio", "tuning", "damping", "peak"),
    [(0.05, 0.975658, 0.136383, 6.214679), (0.2, 0.909593, 0.269858, 2.962519)],
)
def test_the_best_absorber_of_a_rotor_has_the_peak_of_the_exact_minimum(
    ratio, tuning, damping, peak
):
    """Largest M |z|/U over all speeds; Warburton's fixed points are near it."""
    speeds = np.linspace(0.5, 1.6, 1101)

    def largest_amplitude(design):
        f, zeta = design
        own = ratio * f * f
        damper = 2.0 * zeta * ratio * f
        rotor = LinearRotor.planar(1.0, 1.0, unbalance=1.0)
        absorber = Body(
            "absorber", ratio, feet=(Foot(0.0, (own, own), (damper, damper)),), on="rotor"
        )
        machine = with_bodies(rotor, [0.0], [0.0], [absorber])
        return max(abs(response(machine, w)[0, 0]) for w in speeds)

    assert largest_amplitude((tuning, damping)) == pytest.approx(peak, rel=2e-5)
    for other in ((1.01, 1.0), (0.99, 1.0), (1.0, 1.05), (1.0, 0.95)):
        assert largest_amplitude((other[0] * tuning, other[1] * damping)) > peak


def test_a_tool_in_hands_moves_alike_at_every_speed_and_has_a_still_point():
    """z = -U/M, psi = -U d/(It - Ip) of the whole tool, whatever the speed."""
    mass, across, along, moment, d, span = 2.5, 8e-3, 4e-4, 2e-5, 0.09, 0.1
    spinning = LinearRotor.two_support(
        mass=0.5, inertia=1e-3, polar_inertia=along, span=span, com=0.05,
        stiffness=[[1e12, 1e12]] * 2, unbalances=[(0.05 + d, moment, 0.0)],
    )  # fmt: skip
    # the rest has its centre at the rotor's, so that the whole has mass and inertia as given
    housing = Body("housing", mass - 0.5, inertia=across - 1e-3, centre=0.05)
    machine = with_bodies(spinning, [0.0, span], [], [housing], "housing")
    for speed in (500.0, 1000.0):
        x = response(machine, speed)[0, 2:]
        z, psi = x.mean(), (x[1] - x[0]) / span
        assert z == pytest.approx(-8.0e-6, rel=1e-4)
        assert psi == pytest.approx(-2.36842105e-4, rel=1e-4)
    for handle, acceleration in ((0.05, 19.842105), (-0.1, 15.684211)):
        assert speed**2 * abs(z + handle * psi) == pytest.approx(acceleration, rel=1e-4)
    still = -(across - along) / (mass * d)
    assert abs(z + still * psi) < 1e-4 * abs(z)


def test_a_free_tool_has_four_rigid_motions_and_precesses_by_its_polar_inertia():
    spinning = LinearRotor.two_support(
        mass=0.5, inertia=1e-3, polar_inertia=4e-4, span=0.1, com=0.05,
        stiffness=[[1e7, 1e7]] * 2,
    )  # fmt: skip
    housing = Body("housing", 2.0, inertia=7e-3, centre=0.05)
    machine = with_bodies(spinning, [0.0, 0.1], [], [housing], "housing")
    found = np.sort_complex(rigid_rates(machine, 1000.0))
    assert found == pytest.approx([0.0, 0.0, 0.0, 1000j * 4e-4 / 8e-3], abs=1e-6)
    assert rigid_rates(on_a_tub(), 1000.0).size == 0


def test_the_largest_distance_of_an_ellipse_is_found():
    turns = np.exp(1j * np.linspace(0.0, math.tau, 100001))
    pair = np.array([1.0 - 0.4j, 0.3 + 2.0j])
    path = (pair[:, None] * turns).real
    assert largest(pair) == pytest.approx(np.hypot(*path).max(), rel=1e-8)


def test_a_body_stands_on_something():
    rotor = LinearRotor.planar(1.0, 1.0)
    with pytest.raises(ValueError, match="'ground', 'tub'"):
        with_bodies(rotor, [0.0], [0.0], [Body("tub", 1.0)], "tube")
    with pytest.raises(ValueError, match="must be one of 'ground', 'rotor'"):
        with_bodies(rotor, [0.0], [0.0], [Body("tub", 1.0, on="tub")])


@pytest.mark.parametrize(
    ("band", "weight"),
    [(9, 0.873), (12, 0.896), (18, 0.256), (21, 0.127), (24, 0.0634), (30, 0.0135)],
)
def test_the_weight_of_a_handle_is_that_of_the_third_octaves(band, weight):
    """From 8 Hz (band 9) to 1000 Hz (30), at 10^(band/10) Hz."""
    assert hand_weight(10.0 ** (band / 10.0)) == pytest.approx(weight, abs=6e-4)


def test_the_tool_of_the_example_has_its_weighted_acceleration():
    assert 19.842105 * hand_weight(1000.0 / math.tau) == pytest.approx(1.98930, abs=2e-5)


@pytest.mark.parametrize("axis", [0, 1])
def test_a_body_with_one_free_axis_is_the_limit_of_feet_rigid_along_the_other(axis):
    rotor = LinearRotor.planar(10.0, (4e4, 5e4), (40.0, 30.0), unbalance=0.01)
    stiffness = [1e12, 1e12]
    stiffness[axis] = 6e4
    rigid = Body("base", 30.0, feet=(Foot(0.0, stiffness, (200.0, 200.0)),))
    one_way = Body("base", 30.0, feet=(Foot(0.0, (6e4, 6e4), (200.0, 200.0)),), free="xy"[axis])
    limit, found = (with_bodies(rotor, [0.0], [0.0], [body], "base") for body in (rigid, one_way))
    for speed in (20.0, 50.0, 80.0):
        expected, moved = response(limit, speed), response(found, speed)
        assert moved[1 - axis, 1] == 0.0
        assert moved == pytest.approx(expected, rel=1e-6, abs=1e-6 * np.abs(expected).max())
        names = {one.name: one for one in forces(found, moved, speed)}
        floor = next(one for one in forces(limit, expected, speed) if "foot" in one.name)
        assert abs(names["base.foot[1]"].force[axis]) == pytest.approx(
            abs(floor.force[axis]), rel=1e-6
        )
    own = modes(found, 0.0).natural_frequencies
    assert own == pytest.approx(modes(limit, 0.0).natural_frequencies[:3], rel=1e-6)
    assert critical_speeds(found) == pytest.approx(critical_speeds(limit)[:3], rel=1e-6)


def test_internal_damping_on_a_body_with_one_free_axis_is_refused():
    rotor = LinearRotor.planar(10.0, 4e4, internal_damping=5.0)
    body = Body("base", 30.0, feet=(Foot(0.0, (6e4, 6e4)),), free="y")
    with pytest.raises(ValueError, match="internal_damping: not on the body 'base'"):
        with_bodies(rotor, [0.0], [0.0], [body], "base")
