"""Natural frequencies, damping, whirl and critical speeds of turning rotors."""

from __future__ import annotations

import numpy as np
import pytest

from autobalancer.models.linear.critical import critical_speeds
from autobalancer.models.linear.modes import campbell, modes
from autobalancer.models.papers.influence import influence
from autobalancer.models.rotor import LinearRotor


def drum(stiffness=((9e4, 9e4), (9e4, 9e4)), damping=0.0, polar_inertia=0.5, com=None):
    return LinearRotor.two_support(
        mass=10.0,
        inertia=0.8,
        polar_inertia=polar_inertia,
        span=0.6,
        com=com,
        stiffness=stiffness,
        damping=np.full((2, 2), damping),
        planes=(0.1, 0.5),
    )


ANISOTROPIC = ((9e4, 2e5), (7e4, 1.6e5))


def test_damping_ratio_and_frequency_of_one_disc():
    rotor = LinearRotor.planar(2.0, (50.0, 200.0), (4.0, 8.0))
    found = modes(rotor, 0.0)
    assert found.natural_frequencies == pytest.approx([5.0, 10.0])
    assert found.damping_ratios == pytest.approx([4.0 / 20.0, 8.0 / 40.0])
    assert found.eigenvalues.imag == pytest.approx(np.array([5.0, 10.0]) * np.sqrt(1 - 0.04))
    assert found.directions == ("planar", "planar")


def test_natural_frequencies_are_those_of_the_loaded_masses():
    rotor = LinearRotor.planar(1.5, (6.0, 24.0))
    assert modes(rotor, 0.0).natural_frequencies == pytest.approx([2.0, 4.0])
    assert modes(rotor.with_added_mass([4.5]), 0.0).natural_frequencies == pytest.approx([1, 2])


def test_overdamped_motions_have_no_frequency():
    rotor = LinearRotor.planar(1.0, (1.0, 4.0), (4.0, 0.0))
    found = modes(rotor, 0.0)
    expected = sorted([-2 + np.sqrt(3), -2 - np.sqrt(3)], key=abs)
    assert found.eigenvalues == pytest.approx([expected[0], 2j, expected[1]])


def test_isotropic_rotor_seen_as_anisotropic_has_the_same_modes():
    one = modes(drum(damping=20.0, com=0.25), 200.0)
    slightly = drum(damping=20.0, com=0.25, stiffness=((9e4, 9e4), (9e4, 9e4 * (1 + 1e-12))))
    assert not slightly.isotropic
    other = modes(slightly, 200.0)
    np.testing.assert_allclose(one.eigenvalues, other.eigenvalues, rtol=1e-8)
    np.testing.assert_allclose(np.abs(one.whirl), 1.0)
    np.testing.assert_allclose(one.whirl, other.whirl, atol=1e-6)
    for a, b in zip(one.shapes, other.shapes, strict=True):
        overlap = abs(np.vdot(a, b)) ** 2 / (np.vdot(a, a) * np.vdot(b, b)).real
        assert overlap == pytest.approx(1.0, abs=1e-6)


def test_shapes_satisfy_the_equation_of_motion():
    rotor = drum(stiffness=ANISOTROPIC, damping=30.0, com=0.2)
    mass, damping, stiffness = rotor.coefficients(150.0)
    found = modes(rotor, 150.0)
    for value, shape in zip(found.eigenvalues, found.shapes, strict=True):
        residual = (value**2 * mass + value * damping + stiffness) @ shape.ravel()
        assert np.abs(residual).max() < 1e-9 * np.abs(stiffness).max()
        assert np.abs(shape).max() == pytest.approx(1.0)


def test_gyroscopic_coupling_turns_planar_modes_into_forward_and_backward_whirl():
    rotor = drum(stiffness=ANISOTROPIC)
    assert set(modes(rotor, 0.0).directions) == {"planar"}
    assert modes(rotor, 400.0).directions.count("forward") == 2
    assert modes(rotor, 400.0).directions.count("backward") == 2


def test_campbell_follows_each_mode_through_crossings():
    """Backward conical whirl falls through the bounce frequency, which does not change."""
    k, inertia, polar = 1.8e4, 0.8, 0.5
    rotor = LinearRotor.two_support(
        mass=1.0,
        inertia=inertia,
        polar_inertia=polar,
        span=0.6,
        stiffness=((k, k), (k, k)),
        planes=(),
    )
    tilt, bounce = k * 0.6**2 / 2, np.sqrt(2 * k)
    speeds = np.linspace(0.0, 900.0, 46)
    root = np.sqrt((polar * speeds) ** 2 + 4 * inertia * tilt)
    forward = (root + polar * speeds) / (2 * inertia)
    backward = (root - polar * speeds) / (2 * inertia)
    assert forward[0] < bounce < forward[-1]
    tracks = campbell(rotor, speeds).eigenvalues.imag.T
    expected = [forward, backward, np.full_like(speeds, bounce)]
    for curve in expected:
        assert min(np.abs(track / curve - 1).max() for track in tracks) < 1e-9


def test_campbell_refuses_modes_that_come_and_go():
    rotor = LinearRotor.planar(1.0, 1.0, 1.99, internal_damping=0.1)
    anisotropic = LinearRotor.planar(1.0, (1.0, 1.01), 1.95, internal_damping=0.5)
    assert len(campbell(rotor, [0.0, 1.0]).eigenvalues) == 2
    with pytest.raises(ValueError, match="overdamped"):
        campbell(anisotropic, [0.0, 10.0])


def test_campbell_needs_speeds():
    with pytest.raises(ValueError, match="at least one"):
        campbell(drum(), [])


@pytest.mark.parametrize("stiffness", [((9e4, 9e4), (6e4, 6e4)), ANISOTROPIC])
def test_critical_speeds_are_where_a_mode_turns_with_the_rotor(stiffness):
    rotor = drum(stiffness=stiffness, com=0.2)
    speeds = critical_speeds(rotor)
    assert len(speeds) == (2 if rotor.isotropic else 4)
    for speed in speeds:
        found = modes(rotor, speed)
        near = np.argmin(np.abs(found.natural_frequencies - speed))
        assert found.natural_frequencies[near] == pytest.approx(speed, rel=1e-9)
        if rotor.isotropic:
            assert found.directions[near] == "forward"


def test_unbalance_response_peaks_at_the_critical_speeds():
    rotor = drum(stiffness=ANISOTROPIC, damping=0.2, com=0.2)
    for speed in critical_speeds(rotor):
        beside, at = (np.abs(influence(rotor, speed * f)).max() for f in (1.01, 1.0))
        assert at > 5 * beside


@pytest.mark.parametrize("stiffness", [((9e4, 9e4), (9e4, 9e4)), ANISOTROPIC])
@pytest.mark.parametrize("damping", [0.0, 1e-7, -1e-7])
def test_undamped_modes_are_neutral_and_damping_however_small_is_told_from_none(stiffness, damping):
    found = modes(drum(stiffness=stiffness, damping=damping), 150.0)
    expected = "neutral" if damping == 0.0 else "stable" if damping > 0.0 else "unstable"
    assert set(found.states) == {expected}
    assert (found.damping_ratios == 0.0).all() == (damping == 0.0)


def test_internal_damping_alone_destabilises_above_the_critical_speed():
    rotor = LinearRotor.planar(1.0, (100.0, 100.0), internal_damping=1e-6)
    assert "unstable" in modes(rotor, 10.001).states
    assert "unstable" not in modes(rotor, 9.999).states
