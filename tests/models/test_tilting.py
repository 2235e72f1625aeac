"""Discs that tilt on a flexible shaft, against published numbers and closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

from autobalancer.models.assembly import Assembly, Mounted
from autobalancer.models.linear.critical import critical_speeds
from autobalancer.models.linear.modes import modes
from autobalancer.models.papers.influence import influence
from autobalancer.models.rotor import LinearRotor
from autobalancer.models.stability import growth_rates
from autobalancer.models.tilting import tilting_shaft
from autobalancer.models.weights import Weights

E, G, DENSITY = 211e9, 81.2e9, 7810.0  # steel of Friswell et al. 2010, 5.9
DIAMETER, LENGTH = 0.05, 1.5
AREA, SECOND = math.pi * DIAMETER**2 / 4.0, math.pi * DIAMETER**4 / 64.0
NU = E / (2.0 * G) - 1.0
SHEAR = 6.0 * (1.0 + NU) / (7.0 + 6.0 * NU) * G * AREA
RPM = math.pi / 30.0


def disc(diameter, thickness=0.07, bore=0.05):
    """Mass, transverse and polar inertia."""
    mass = DENSITY * math.pi * thickness * (diameter**2 - bore**2) / 4.0
    square = diameter**2 + bore**2
    return mass, mass / 48.0 * (3.0 * square + 4.0 * thickness**2), mass / 8.0 * square


def shaft(elements, discs, supports, stiffness, *, shear=True, rotary=False, damping=0.0, **more):
    """A shaft whose mass is lumped at the ends of equal elements, with discs {place: disc}."""
    z = np.linspace(0.0, LENGTH, elements + 1)
    piece = LENGTH / elements * np.array([0.5, *[1.0] * (elements - 1), 0.5])
    masses = DENSITY * AREA * piece
    across = rotary * DENSITY * SECOND * piece
    along = 2.0 * across
    for place, (mass, transverse, polar) in discs.items():
        at = int(np.argmin(np.abs(z - place)))
        masses[at] += mass
        across[at] += transverse
        along[at] += polar
    numbers = [int(np.argmin(np.abs(z - place))) + 1 for place in supports]
    return LinearRotor.flexible(
        stations=z.tolist(),
        masses=masses.tolist(),
        supports=numbers,
        support_stiffness=[stiffness] * 2,
        support_damping=[[damping] * 2] * 2,
        bending_stiffness=E * SECOND,
        transverse_inertias=across.tolist(),
        polar_inertias=along.tolist(),
        shear_stiffness=SHEAR if shear else None,
        **more,
    )


def overhung(elements=6, **options):
    """Friswell 5.9.9."""
    return shaft(elements, {1.5: disc(0.35)}, (0.0, 1.0), [1e7] * 2, **options)


@pytest.mark.parametrize(
    ("shear", "rpm", "expected"),
    [
        (True, 0.0, [89.871, 89.871, 633.291, 633.291, 834.069, 834.069]),
        (True, 4000.0, [76.018, 103.545, 568.570, 636.552, 651.121, 1177.142]),
        (False, 0.0, [89.974, 89.974, 634.898, 634.898, 835.601, 835.601]),
        (False, 4000.0, [76.085, 103.698, 570.488, 638.118, 652.591, 1178.337]),
    ],
)
def test_an_overhung_disc_has_the_frequencies_of_an_independent_assembly(shear, rpm, expected):
    """Friswell 5.9.9 with the shaft's mass at seven stations."""
    found = modes(overhung(shear=shear), rpm * RPM).natural_frequencies[:6]
    assert found == pytest.approx(expected, abs=6e-4)


@pytest.mark.parametrize(
    ("rpm", "expected"),
    [
        (0.0, [90.143, 90.143, 630.503, 630.503, 830.312, 830.312]),
        (4000.0, [76.190, 103.908, 565.947, 634.002, 647.530, 1173.591]),
    ],
)
def test_finer_lumps_come_within_0_1_percent_of_48_consistent_elements(rpm, expected):
    """ROSS has 90.14, 630.73, 830.43 and 76.19, 103.91, 565.99, 634.23, 647.75, 1174.2 with six."""
    found = modes(overhung(48, rotary=True), rpm * RPM).natural_frequencies[:6]
    assert found == pytest.approx(expected, rel=1e-3)


A, B = disc(0.28), disc(0.35)


def assert_low_modes(found, expected):
    """0.1 % of the first four; the shaft's own mass, which is lumped here, moves the next ones."""
    assert found[:4] == pytest.approx(expected[:4], rel=1e-3)
    assert found[4 : len(expected)] == pytest.approx(expected[4:], rel=8e-3)


@pytest.mark.parametrize(
    ("stiffness", "damping", "rpm", "expected"),
    [
        ([1e6, 1e6], 0.0, 0.0, [86.658, 86.658, 274.313, 274.313, 716.786]),
        ([1e6, 1e6], 0.0, 4000.0, [85.389, 87.796, 251.785, 294.713, 600.179, 827.075]),
        ([1e6, 8e5], 0.0, 4000.0, [82.325, 86.864, 239.639, 287.243, 583.398]),
        ([1e6, 2e5], 0.0, 4000.0, [53.692, 86.525, 140.457, 276.858, 494.770, 756.076]),
        ([1e6, 1e6], 3e3, 4000.0, [86.063, 88.542, 273.991, 327.837, 768.675]),
    ],
    ids=["5.9.1 at rest", "5.9.1", "5.9.2", "5.9.3", "5.9.5"],
)
def test_two_discs_between_bearings_have_the_frequencies_of_friswell(
    stiffness, damping, rpm, expected
):
    rotor = shaft(36, {0.5: A, 1.0: B}, (0.0, 1.5), stiffness, damping=damping, rotary=True)
    found = modes(rotor, rpm * RPM)
    assert_low_modes(found.natural_frequencies, expected)
    if damping:
        rates = np.sort(found.eigenvalues.real[:4])[::-1]
        assert rates == pytest.approx([-4.083, -4.742, -74.097, -78.804], rel=8e-3)


@pytest.mark.parametrize(
    ("stiffness", "damping", "rpm", "hertz"),
    [
        ([[1e6, 5e5], [5e5, 1e6]], 0.0, 0.0, [11.663, 14.801, 33.970, 49.192, 97.944, 126.569]),
        ([[1e6, 5e5], [5e5, 1e6]], 0.0, 4e3, [11.652, 14.788, 33.155, 49.686, 89.401, 133.722]),
        ([[1e6, 2e5], [-2e5, 1e6]], 3e3, 4e3, [13.953, 13.972, 46.765, 49.422, 139.147, 141.319]),
    ],
    ids=["symmetric, at rest", "symmetric", "whirling"],
)
def test_cross_terms_of_the_bearings_move_the_frequencies_of_friswell(
    stiffness, damping, rpm, hertz
):
    """5.9.4 and a row with kxy = -kyx: 24 consistent elements."""
    bearings = [(k, stiffness, (damping * np.eye(2)).tolist()) for k in (1, 2)]
    rotor = shaft(36, {0.5: A, 1.0: B}, (0.0, 1.5), [0.0, 0.0], rotary=True, bearings=bearings)
    found = modes(rotor, rpm * RPM)
    assert_low_modes(found.natural_frequencies / math.tau, hertz)


def test_a_disc_at_the_end_of_a_clamped_shaft_whirls_as_stodola_and_green_say():
    length, stiffness, mass, across, along = 0.5, 6e3, 10.0, 0.08, 0.15
    arm = math.sqrt(across / mass)
    beam = tilting_shaft(np.array([0.0, length]), [arm, arm], stiffness, None, np.linalg.solve)
    free = [1, 3]  # displacement and arm of the second station; the first one is clamped
    tilt = np.array([[-1.0, 1.0]]) / arm
    rotor = LinearRotor.from_matrices(
        mass=np.diag([mass, 0.0]) + across * tilt.T @ tilt,
        stiffness=beam.stiffness[np.ix_(free, free)],
        gyroscopic=along * tilt.T @ tilt,
    )
    expected = {
        0.0: [115.81121994, 115.81121994, 802.61308321, 802.61308321],
        200.0: [102.72299151, 128.71640330, 652.47986027, 1001.48644848],
        400.0: [90.26896974, 140.71680089, 546.06532916, 1245.61749801],
    }
    for speed, values in expected.items():
        found = modes(rotor, speed)
        assert found.natural_frequencies == pytest.approx(values, rel=1e-10)
        if speed:
            assert found.directions == ("backward", "forward") * 2


@pytest.mark.parametrize(
    ("ratio", "expected"), [(0.01, 1.75172), (0.1, 1.94329), (0.3, 2.38599), (10.0, 3.42090)]
)
def test_a_thin_overhung_disc_has_the_forward_critical_speed_in_closed_form(ratio, expected):
    arm = math.sqrt(ratio)
    beam = tilting_shaft(np.array([0.0, 1.0]), [arm, arm], 1.0, None, np.linalg.solve)
    tilt = np.array([[-1.0, 1.0]]) / arm
    rotor = LinearRotor.from_matrices(
        mass=np.diag([1.0, 0.0]) + ratio * tilt.T @ tilt,
        stiffness=beam.stiffness[np.ix_([1, 3], [1, 3])],
        gyroscopic=2.0 * ratio * tilt.T @ tilt,
    )
    assert critical_speeds(rotor) == pytest.approx([expected], abs=6e-6)


def test_a_disc_askew_answers_as_one_on_an_angular_spring():
    """In the middle it tilts alone: psi = (It - Ip) tau w^2/(kt - (It - Ip) w^2)."""
    length, bending, support, speed, askew = 0.8, 5e3, 2e5, 150.0, 1e-3
    across, along = 0.02, 0.035
    rotor = LinearRotor.flexible(
        stations=[0.0, length / 2.0, length],
        masses=[1e-9, 4.0, 1e-9],
        supports=[1, 3],
        support_stiffness=[[support] * 2] * 2,
        bending_stiffness=bending,
        transverse_inertias=[0.0, across, 0.0],
        polar_inertias=[0.0, along, 0.0],
        skews=[(2, askew, 0.3)],
    )
    (x, _) = influence(rotor, speed, np.eye(rotor.stations)) @ rotor.unbalance
    psi = (x[3] - x[1]) / math.sqrt(across / 4.0)
    spring = 1.0 / (length / (12.0 * bending) + 2.0 / (support * length**2))
    couple = (across - along) * askew * speed**2 * np.exp(0.3j)
    assert psi == pytest.approx(couple / (spring - (across - along) * speed**2), rel=1e-7)


def test_discs_with_hardly_any_inertia_are_points():
    options = {
        "stations": [0.0, 0.2, 0.5, 0.9],
        "masses": [0.5, 3.0, 2.0, 1.0],
        "supports": [1, 3],
        "support_stiffness": [[2e5, 3e5]] * 2,
        "support_damping": [[20.0, 30.0]] * 2,
        "bending_stiffness": 4e3,
        "internal_damping": 5.0,
        "unbalances": [(0.35, 1e-3, 0.4), (0.9, 2e-3, 0.0)],
    }
    points = LinearRotor.flexible(**options)
    tilting = LinearRotor.flexible(
        **options, transverse_inertias=[0.0, 1e-5, 0.0, 0.0], polar_inertias=[0.0] * 4
    )
    expected, found = modes(points, 120.0), modes(tilting, 120.0)
    assert found.eigenvalues[:8] == pytest.approx(expected.eigenvalues, rel=1e-4)
    responses = [influence(r, 90.0, np.eye(r.stations)) @ r.unbalance for r in (points, tilting)]
    assert responses[1][:, :4] == pytest.approx(responses[0], rel=1e-4)


def test_a_body_has_no_more_polar_than_twice_its_transverse_inertia():
    with pytest.raises(ValueError, match=r"station 2: must be 0 to twice the transverse inertia"):
        LinearRotor.flexible(
            stations=[0.0, 0.5, 1.0],
            masses=[1.0] * 3,
            supports=[1, 3],
            support_stiffness=[[1e5] * 2] * 2,
            bending_stiffness=1e3,
            transverse_inertias=[0.0, 0.1, 0.0],
            polar_inertias=[0.0, 0.3, 0.0],
        )


def test_tilting_discs_change_the_limits_of_balancing():
    """Stability of two balls on an overhung disc follows the inertia of the disc."""

    def growth(across):
        rotor = LinearRotor.flexible(
            stations=[0.0, 0.6, 1.0],
            masses=[1.0, 1.0, 5.0],
            supports=[1, 2],
            support_stiffness=[[4e5] * 2] * 2,
            support_damping=[[200.0] * 2] * 2,
            bending_stiffness=3e3,
            unbalances=[(1.0, 2e-3, 0.0)],
            transverse_inertias=[0.0, 0.0, across],
            polar_inertias=[0.0, 0.0, 1.9 * across],
        )
        balls = Mounted("balls", Weights(2, 0.05, 0.1, 0.02, 1.4), 2, (2.0, 4.0))
        return float(growth_rates(Assembly(rotor, (balls,)), [120.0])[0])

    assert abs(growth(0.1) - growth(1e-5)) > 1e-2
