"""Rigid rotor on two supports: Polushkin 2016 (8), (9) and its gyroscopic extension."""

from __future__ import annotations

import numpy as np
import pytest

from autobalancer.models.linear.critical import critical_speeds
from autobalancer.models.papers.influence import influence
from autobalancer.models.rotor import LinearRotor
from autobalancer.models.rotor_kinds import line_rows

MACHINE = {
    "mass": 12.0,
    "inertia": 0.7,
    "polar_inertia": 0.4,
    "span": 0.8,
    "com": 0.3,
    "stiffness": ((2e5, 3e5), (1e5, 4e5)),
    "damping": ((40.0, 30.0), (20.0, 10.0)),
    "planes": (0.1, 0.9, -0.2),
}


def rigid(**changes):
    return LinearRotor.two_support(**{**MACHINE, **changes})


def eigenvalues(mass, damping, stiffness):
    size = len(mass)
    inverse = np.linalg.inv(mass)
    system = np.block(
        [[np.zeros((size, size)), np.eye(size)], [-inverse @ stiffness, -inverse @ damping]]
    )
    return np.linalg.eigvals(system)


def by_centre(rotor_data, speed):
    """Eigenvalues with x, psi_x, y, psi_y of the centre of mass as coordinates."""
    d = rotor_data
    ends = (-d["com"], d["span"] - d["com"])
    mass = np.diag([d["mass"], d["inertia"], d["mass"], d["inertia"]])
    damping, stiffness = np.zeros((4, 4)), np.zeros((4, 4))
    for arm, k, c in zip(ends, d["stiffness"], d["damping"], strict=True):
        lever = np.outer([1.0, arm], [1.0, arm])
        for axis in range(2):
            part = slice(2 * axis, 2 * axis + 2)
            stiffness[part, part] += k[axis] * lever
            damping[part, part] += c[axis] * lever
    damping[1, 3] += d["polar_inertia"] * speed  # It psi_x'' + Ip w psi_y'
    damping[3, 1] -= d["polar_inertia"] * speed
    return eigenvalues(mass, damping, stiffness)


def test_mass_matrix_of_the_symmetric_rotor_is_polushkins():
    m, inertia, span = 12.0, 0.7, 0.8
    rotor = rigid(com=None)
    own, cross = m / 4 + inertia / span**2, m / 4 - inertia / span**2
    np.testing.assert_allclose(rotor.mass, [[own, cross], [cross, own]], rtol=1e-14)


@pytest.mark.parametrize("com", [0.4, 0.3, 0.0, -0.15, 1.1])
@pytest.mark.parametrize("speed", [0.0, 150.0, 900.0])
def test_support_coordinates_have_the_eigenvalues_of_centre_coordinates(com, speed):
    data = {**MACHINE, "com": com}
    expected = by_centre(data, speed)
    found = eigenvalues(*LinearRotor.two_support(**data).coefficients(speed))
    key = [np.sort_complex(np.round(v, 6)) for v in (found, expected)]
    np.testing.assert_allclose(key[0], key[1], rtol=1e-8)


def test_flat_body_has_no_conical_critical_speed():
    rotor = rigid(
        com=None, polar_inertia=1.2, stiffness=((2e5, 2e5), (2e5, 2e5)), damping=np.zeros((2, 2))
    )
    assert critical_speeds(rotor) == pytest.approx([np.sqrt(4e5 / 12.0)])


def test_force_on_a_plane_loads_the_supports_by_its_lever():
    rotor = rigid()
    for row, a in zip(rotor.planes, MACHINE["planes"], strict=True):
        at_supports = row * 1.0  # S^T F
        assert at_supports.sum() == pytest.approx(1.0)
        assert at_supports[1] * MACHINE["span"] == pytest.approx(a)


def test_unbalance_acts_as_the_same_unbalance_in_a_plane():
    rotor = rigid(unbalances=[(0.9, 2e-3, 0.4), (-0.2, 1e-3, 2.0)])
    speed = 120.0
    per_plane = influence(rotor, speed)
    expected = per_plane @ np.array([0.0, 2e-3 * np.exp(0.4j), 1e-3 * np.exp(2.0j)])
    mass, damping, stiffness = rotor.coefficients(speed)
    u = np.concatenate([rotor.unbalance, -1j * rotor.unbalance])
    phasor = np.linalg.solve(
        stiffness - speed**2 * mass + 1j * speed * damping, speed**2 * u
    ).reshape(2, 2)
    np.testing.assert_allclose(phasor, expected, rtol=1e-12)


def test_far_above_resonance_the_rotor_turns_about_its_axis_of_inertia():
    """A static unbalance in the plane of the centre of mass shifts the axis by U/m."""
    rotor = rigid(polar_inertia=0.0)
    k = influence(rotor, 1e6, line_rows([MACHINE["com"]], MACHINE["span"]))
    np.testing.assert_allclose(k[0, :, 0], -1.0 / MACHINE["mass"], rtol=1e-5)
