"""Shaft with discs on two supports: Filimonikhin 2011 (1), Dubovik 2006 (5), Euler-Bernoulli."""

from __future__ import annotations

import numpy as np
import pytest

from autobalancer.models.harmonic_balance import unbalance_response
from autobalancer.models.linear.modes import modes
from autobalancer.models.papers.influence import influence
from autobalancer.models.rotor import LinearRotor
from autobalancer.models.shaft import beam_compliance, bending_rows

STATIONS = (0.0, 0.3, 0.5, 0.9, 1.0, 1.25)
SHAFT = {
    "stations": STATIONS,
    "masses": (1.0, 0.4, 2.0, 1.5, 0.7, 0.9),
    "supports": (2, 5),
    "support_stiffness": ((3e5, 5e5), (2e5, 1e5)),
    "support_damping": ((50.0, 20.0), (10.0, 80.0)),
    "bending_stiffness": 8e3,
}


def flexible(**changes):
    return LinearRotor.flexible(**{**SHAFT, **changes})


def supported_beam(a, b, span):
    """E I times deflection at a by a unit force at b, origin at the left support, by handbook."""
    a, b = min(a, b), max(a, b)
    if a < 0.0 and b > span:
        return -a * (b - span) * span / 6
    if b <= 0.0 or a >= span:  # both on one overhang: distances from its support
        near, far = sorted((-a, -b) if b <= 0.0 else (a - span, b - span))
        return near * far * span / 3 + near**2 * (3 * far - near) / 6
    if a < 0.0:
        return a * (span - b) * (span**2 - (span - b) ** 2) / (6 * span)
    if b > span:
        return -(b - span) * a * (span**2 - a**2) / (6 * span)
    return a * (span - b) * (2 * span * b - a**2 - b**2) / (6 * span)


def test_influence_coefficients_are_the_handbooks_overhangs_included():
    p, q = 1, 4
    loads = [z - STATIONS[p] for j, z in enumerate(STATIONS) if j not in (p, q)]
    span = STATIONS[q] - STATIONS[p]
    expected = [[supported_beam(a, b, span) for b in loads] for a in loads]
    np.testing.assert_allclose(beam_compliance(STATIONS, (p, q), 1.0), expected, rtol=1e-12)


@pytest.mark.parametrize("supports", [(1, 6), (2, 5), (5, 2)])
def test_motion_satisfies_filimonikhins_equations(supports):
    """The printed system (1) without weights, evaluated with the accelerations of the matrices."""
    rotor = flexible(supports=supports)
    p, q = supports[0] - 1, supports[1] - 1
    z, m = np.array(STATIONS), np.array(SHAFT["masses"])
    share = (z - z[p]) / (z[q] - z[p])
    rng = np.random.default_rng(3)
    x, v = rng.normal(size=(2, len(z)))
    inertia = m * np.linalg.solve(rotor.mass, -rotor.damping_x @ v - rotor.stiffness_x @ x)
    k, c = np.array(SHAFT["support_stiffness"])[:, 0], np.array(SHAFT["support_damping"])[:, 0]
    scale = np.abs(inertia).sum()
    assert ((1 - share) * inertia).sum() + c[0] * v[p] + k[0] * x[p] == pytest.approx(
        0.0, abs=1e-10 * scale
    )
    assert (share * inertia).sum() + c[1] * v[q] + k[1] * x[q] == pytest.approx(
        0.0, abs=1e-10 * scale
    )
    bent = np.delete(np.arange(len(z)), [p, q])
    delta = beam_compliance(z, (p, q), SHAFT["bending_stiffness"])
    bending = x[bent] - (1 - share[bent]) * x[p] - share[bent] * x[q]
    np.testing.assert_allclose(delta @ inertia[bent] + bending, 0.0, atol=1e-10)


def jeffcott(internal_damping):
    """One disc at mid-span, supports 1e9 times as stiff as the shaft, and Dubovik's rotor."""
    span, bending, disc = 0.8, 2e3, 5.0
    c = 48 * bending / span**3
    stiff = ((1e9 * c, 1e9 * c), (1e9 * c, 1e9 * c))
    shaft = LinearRotor.flexible(
        stations=(0.0, span / 2, span),
        masses=(1e-3, disc, 1e-3),
        supports=(1, 3),
        support_stiffness=stiff,
        bending_stiffness=bending,
        internal_damping=internal_damping,
        unbalances=[(span / 2, 1e-3, 0.7)],
    )
    disc_only = LinearRotor.planar(
        disc, c, internal_damping=internal_damping, unbalance=1e-3, unbalance_angle=0.7
    )
    return shaft, disc_only


@pytest.mark.parametrize("speed", [20.0, 300.0])
def test_one_disc_on_stiff_supports_is_duboviks_planar_rotor(speed):
    shaft, planar = jeffcott(internal_damping=30.0)
    found = modes(shaft, speed).eigenvalues[:2]
    np.testing.assert_allclose(found, modes(planar, speed).eigenvalues, rtol=1e-8)
    np.testing.assert_allclose(
        influence(shaft, speed)[:, 1:2, 1:2], influence(planar, speed), rtol=1e-7
    )
    assert shaft.unbalance[1] == pytest.approx(planar.unbalance[0])


def test_internal_damping_is_proportional_to_the_shafts_stiffness():
    """The material's viscosity over E is one number, p/c with c the softest station's stiffness."""
    rotor = flexible(internal_damping=12.0)
    supports = np.diag([0, 3e5, 0, 0, 2e5, 0])
    softest = beam_compliance(STATIONS, (1, 4), SHAFT["bending_stiffness"]).diagonal().max()
    np.testing.assert_allclose(
        rotor.internal_damping,
        12.0 * softest * (rotor.stiffness_x - supports),
        atol=1e-9 * np.abs(rotor.internal_damping).max(),
    )


def test_internal_damping_leaves_rigid_motion_alone():
    damping = flexible(internal_damping=12.0).internal_damping
    for motion in (np.ones(6), np.array(STATIONS)):
        np.testing.assert_allclose(damping @ motion, 0.0, atol=1e-9 * np.abs(damping).max())


def test_compliance_given_as_numbers_is_the_same_shaft():
    delta = beam_compliance(STATIONS, (1, 4), SHAFT["bending_stiffness"])
    given = flexible(bending_stiffness=None, compliance=delta.tolist())
    np.testing.assert_allclose(given.stiffness_y, flexible().stiffness_y, rtol=1e-12)


def test_bending_is_measured_from_the_line_of_supports():
    rotor = flexible()
    for motion in (np.ones(6), np.array(STATIONS)):
        np.testing.assert_allclose(rotor.deflection @ motion, 0.0, atol=1e-15)
    np.testing.assert_array_equal(rotor.deflection, bending_rows(STATIONS, (1, 4)))


@pytest.mark.parametrize("place", [0.02, 0.3, 0.44, 0.7, 0.97, 1.2])
def test_unbalance_between_discs_is_that_of_a_disc_without_mass(place):
    unbalance = [(place, 1e-3, 0.4)]
    between = flexible(unbalances=unbalance)
    own = sorted({*STATIONS, place})
    masses = [dict(zip(STATIONS, SHAFT["masses"], strict=True)).get(z, 1e-9) for z in own]
    supports = [own.index(STATIONS[s - 1]) + 1 for s in SHAFT["supports"]]
    changes = {"stations": own, "masses": masses, "supports": supports}
    disc = flexible(**changes, unbalances=unbalance)
    kept = [own.index(z) for z in STATIONS]
    for speed in (50.0, 200.0, 900.0):
        expected = unbalance_response(disc, [speed])[0][:, kept]
        np.testing.assert_allclose(
            unbalance_response(between, [speed])[0], expected, rtol=1e-5,
            atol=1e-7 * abs(expected).max(),
        )  # fmt: skip


def test_discs_at_both_supports_only_vibrate_on_their_own():
    rotor = flexible(stations=(0.0, 1.0), masses=(2.0, 3.0), supports=(1, 2))
    np.testing.assert_array_equal(rotor.stiffness_x, np.diag([3e5, 2e5]))
    assert not (rotor.deflection @ np.array([1.0, 2.0])).any()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"masses": (1.0, 0.0, 2.0, 1.5, 0.7, 0.9)}, "masses = 0.0 at station 2"),
        ({"compliance": np.ones((4, 4))}, "positive definite"),
        ({"compliance": np.zeros((4, 4))}, "positive definite"),
        ({"compliance": -np.eye(4)}, "positive definite"),
        ({"compliance": np.triu(np.ones((4, 4)))}, "symmetric"),
    ],
)
def test_wrong_argument_is_named_with_its_value(change, message):
    with pytest.raises(ValueError, match=message):
        flexible(**change)


def test_shaft_that_cannot_bend_has_no_internal_damping():
    with pytest.raises(ValueError, match="cannot bend"):
        flexible(stations=(0.0, 1.0), masses=(2.0, 3.0), supports=(1, 2), internal_damping=1.0)
