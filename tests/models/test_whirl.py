"""The whirl that weights leave, against the full equations in fixed axes and closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from autobalancer.models.assembly import Assembly, Mounted, SpeedProfile
from autobalancer.models.papers.capacity import capacity
from autobalancer.models.papers.influence import influence
from autobalancer.models.reference.coupled import Monolith
from autobalancer.models.rotor import LinearRotor
from autobalancer.models.weights import Weights
from autobalancer.models.whirl.search import NotCovered, main_whirl, whirl_boundaries, whirl_growth
from autobalancer.models.whirl.steady import NoWhirl
from autobalancer.models.whirl.variation import multipliers, neutral_turns

pytestmark = pytest.mark.slow

STIFF = {"isotropic": ((90.0, 90.0), (60.0, 60.0)), "anisotropic": ((90.0, 60.0), (60.0, 45.0))}


def couple(kind, count=2, *, planes=(0.4,), internal=0.0, offset=0j, drag=0.02):
    """A rigid rotor with a static unbalance and a couple, weights on one plane or two."""
    stiffness = STIFF[kind]
    rotor = LinearRotor.two_support(
        mass=1.0,
        inertia=0.06,
        polar_inertia=0.02,
        span=1.0,
        stiffness=stiffness,
        damping=[[0.02 * k for k in support] for support in stiffness],
        planes=planes,
        unbalances=((0.5, 1.5e-3, 0.3), (0.0, 4e-4, 1.4), (1.0, 4e-4, 4.5)),
    )
    rotor = replace(rotor, internal_damping=internal * np.array([[1.0, -1.0], [-1.0, 1.0]]))
    device = Weights(count, 0.02 / count, 0.1, drag, 1.4)
    angles = tuple(0.4 + 2.0 * math.pi * k / count + 0.2 * k * k for k in range(count))
    balancers = [Mounted(f"weights{i}", device, i, angles, (), offset) for i in range(len(planes))]
    return Assembly(rotor, tuple(balancers))


CASES = {
    "isotropic": (couple("isotropic"), 30.0),
    "anisotropic": (couple("anisotropic"), 30.0),
    "anisotropic, below": (couple("anisotropic"), 6.0),
    "anisotropic, unstable": (couple("anisotropic"), 11.0),
    "internal damping": (couple("anisotropic", internal=0.3), 25.0),
    "track off centre": (couple("anisotropic", offset=2e-4 - 1e-4j), 30.0),
    "three weights, all together": (couple("anisotropic", 3), 6.0),
    "two planes, tracks off centre": (couple("anisotropic", planes=(0.3, 0.4), offset=5e-4), 30.0),
}


def after_a_revolution(assembly, speed, state, rtol=1e-12):
    """The equations in fixed axes, integrated on their own; angles less the turn of the rotor."""
    system = Monolith(assembly, SpeedProfile.constant(speed))
    time = 2.0 * math.pi / speed
    run = solve_ivp(system.array_rhs, (0.0, time), state, "DOP853", rtol=rtol, atol=1e-3 * rtol)
    end = run.y[:, -1]
    end[4 * system.stations : (len(end) + 4 * system.stations) // 2] -= 2.0 * math.pi
    return end


def state_of(whirl):
    """State of the equations in fixed axes, rotor at angle 0."""
    place, velocity = whirl.rotor_at(0.0)
    theta, rate, _ = whirl.weights_at(np.zeros(1))
    lateral = [place.real, place.imag, velocity.real, velocity.imag]
    return np.concatenate([*lateral, theta[0], whirl.speed + rate[0]])


def scales(whirl):
    n, count = whirl.z.shape[1], len(whirl.angles)
    size, w = whirl.amplitude.max(), whirl.speed
    return np.repeat([size, size * w, 1.0, w], [2 * n, 2 * n, count, count])


@pytest.mark.parametrize("case", CASES)
def test_a_whirl_returns_after_a_revolution_of_the_full_equations(case):
    assembly, speed = CASES[case]
    whirl = main_whirl(assembly, speed).whirl
    state = state_of(whirl)
    moved = (after_a_revolution(assembly, speed, state) - state) / scales(whirl)
    assert np.abs(moved).max() < 1e-8


@pytest.mark.parametrize("case", CASES)
def test_multipliers_are_those_of_the_full_equations(case):
    assembly, speed = CASES[case]
    whirl = main_whirl(assembly, speed).whirl
    state, scale, step = state_of(whirl), scales(whirl), 1e-5

    def after(moved):
        # neighbours take the same steps: their errors cancel, and 1e-9 is left of the multipliers
        return after_a_revolution(assembly, speed, state + moved * scale, rtol=1e-10)

    columns = [
        (after(step * e) - after(-step * e)) / (2.0 * step * scale) for e in np.eye(len(state))
    ]
    expected = np.linalg.eigvals(np.array(columns).T)
    found = multipliers(whirl)
    assert len(found) == len(expected) - neutral_turns(whirl).shape[1]
    for value in found:
        assert np.abs(expected - value).min() < 1e-6


def test_a_whirl_that_is_left_is_told_from_one_that_is_kept():
    signs = {case: main_whirl(*of).stable for case, of in CASES.items()}
    assert not signs.pop("anisotropic, unstable")
    assert not signs.pop("two planes, tracks off centre")
    assert all(signs.values())


def test_on_an_isotropic_rotor_the_plane_rests_and_the_rest_turns_about_it():
    """Two weights make the moment that keeps their plane at rest; influence coefficients say it."""
    assembly, speed = couple("isotropic"), 30.0
    whirl = main_whirl(assembly, speed).whirl
    rotor = assembly.loaded_rotor
    stations = influence(rotor, speed, np.eye(2))[0] @ rotor.unbalance
    by_weights = influence(rotor, speed)[0]
    moment = -(rotor.planes @ stations) / (rotor.planes @ by_weights)
    found = 0.001 * np.exp(1j * whirl.angles).sum()
    assert found == pytest.approx(complex(moment[0, 0]), rel=1e-9)
    expected = np.abs(stations + by_weights[:, 0] * moment[0, 0])
    np.testing.assert_allclose(whirl.amplitude, expected, rtol=1e-9)
    assert np.abs(whirl.theta - whirl.angles).max() < 1e-12


def planar(unbalance, count=3, half_angle=0.0, angles=None):
    rotor = LinearRotor.planar(1.0, 100.0, 2.0, unbalance=unbalance, unbalance_angle=0.3)
    device = Weights(count, 0.01, 0.1, 0.02, 1.4)
    spread = angles or tuple(2.0 * math.pi * k / count for k in range(count))
    return Assembly(rotor, (Mounted("balls", device, 0, spread, (), 0j, half_angle),))


@pytest.mark.parametrize("half_angle", [0.0, 0.1])
@pytest.mark.parametrize("speed", [6.0, 15.0, 30.0])
def test_beyond_their_reach_all_weights_stand_together_where_nothing_drives_them(speed, half_angle):
    """Angle psi of the group: sin(psi - g + d) = -(S/U) sin d, d the phase of the stiffness."""
    unbalance, assembly = 0.005, planar(0.005, half_angle=half_angle)
    found = main_whirl(assembly, speed)
    reach = capacity(0.01, 0.1, 0.1 * math.sin(half_angle), 3) if half_angle else 0.003
    dynamic = 100.0 - 1.03 * speed**2 + 2j * speed
    delta = np.angle(dynamic)
    turned = math.asin(-reach / unbalance * math.sin(delta))
    sizes = [
        abs(unbalance + reach * np.exp(1j * psi)) * speed**2 / abs(dynamic)
        for psi in (turned - delta, math.pi - turned - delta)
    ]
    assert found.stable
    # below resonance they add to the unbalance, above it they take from it
    expected = max(sizes) if speed < 10.0 else min(sizes)
    assert found.whirl.amplitude[0] == pytest.approx(expected, rel=1e-9)
    assert len(found.whirl.angles) == (1 if half_angle else 3)
    assert np.ptp(found.whirl.angles) < 1e-9


def test_weights_that_would_be_driven_apart_do_not_stand_side_by_side():
    """A rig's two balls on a track 5 um off centre: joined they would keep still at 160 rad/s."""
    rotor = LinearRotor.planar(1.28, (43000.0, 31600.0), (10.75, 7.9), unbalance=3.72e-5)
    device = Weights(2, 0.44e-3, 0.0428, 7.8e-3, 1.4)
    mounted = Mounted("balls", device, 0, (-0.2, 0.2), (), 5e-6, math.asin(2.38 / 42.8))
    found = main_whirl(Assembly(rotor, (mounted,)), 160.0)
    assert len(found.whirl.angles) == 2
    assert not found.stable


@pytest.mark.parametrize("count", [3, 5])
def test_turns_that_change_nothing_are_left_out_by_structure(count):
    assembly = couple("isotropic", count)
    whirl = main_whirl(assembly, 30.0).whirl
    assert neutral_turns(whirl).shape[1] == count - 2
    assert abs(multipliers(whirl)[0]) < 1.0, "nothing that does not decay is left"


def test_a_stable_whirl_begins_where_its_growth_changes_sign():
    assembly = couple("anisotropic")
    found = whirl_boundaries(assembly, 20.0, 40.0)
    assert [c.above for c in found] == ["unstable", "stable"]
    for c in found:
        below, above = (whirl_growth(assembly, c.speed * (1.0 + d)) < 0.0 for d in (-1e-5, 1e-5))
        assert below != above == (c.above == "stable")


def test_a_rotor_without_weights_has_none_that_whirl():
    with pytest.raises(NoWhirl, match="no weights"):
        main_whirl(Assembly(couple("isotropic").rotor), 10.0)


@pytest.mark.parametrize("count", [3, 6])
def test_weights_that_share_a_moment_drift_as_slowly_as_it_says(count):
    """Two weights whirl as many do; of many the full equations show the drift, and no more."""
    assembly, speed = couple("anisotropic", count), 30.0
    whirl, growth = main_whirl(assembly, speed)
    assert growth < 0.0
    assert whirl.family.shape[1] == count - 2
    pair = main_whirl(couple("anisotropic"), speed).whirl
    np.testing.assert_allclose(whirl.amplitude, pair.amplitude, rtol=1e-4)
    places, state = [], state_of(whirl)
    for _ in range(20):
        state = after_a_revolution(assembly, speed, state)
        places.append(state[8 : 8 + count])
    moved = np.abs(places[-1] - places[9]).max() / (10 * 2.0 * math.pi / speed)
    assert moved == pytest.approx(whirl.drift, rel=0.02)
    back = (state - state_of(whirl))[:8] / scales(whirl)[:8]
    assert np.abs(back).max() < 1e-4


def test_weights_that_nothing_drags_drift_too_fast_for_a_whirl():
    with pytest.raises(NotCovered, match="drift among them"):
        main_whirl(couple("anisotropic", 3, drag=0.0), 30.0)
