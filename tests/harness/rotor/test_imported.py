"""Rotors from elsewhere: by matrices, and from models of ROSS."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import autobalancer as ab
from autobalancer.harness.rotor.imported import _judged

SPEED = 4000.0 * np.pi / 30.0
MASS, STIFFNESS = np.diag([2.0, 8.0]), np.array([[6e5, -4e5], [-4e5, 4.5e5]])


def by_matrices(**more):
    given = {"mass": MASS, "stiffness": STIFFNESS, "damping": np.diag([80.0, 40.0])} | more
    return ab.Rotor.from_matrices(**given)


def test_a_rotor_by_matrices_runs_in_both_engines_is_saved_and_built(tmp_path):
    rotor = by_matrices(unbalances=[{"position": 1.0, "amount": 1e-4}])
    balls = ab.Balls(count=2, mass=0.01, track_radius=0.05, drag=0.1, at=2)
    scene = ab.Scene(rotor=rotor, balancer=[balls], speed=700.0, run={"revolutions": 12})
    one, several = scene.run(), scene.run(separate=True)
    size = np.abs(one["rotor.station[2].x"]).max()
    for name in ("rotor.station[1].x", "rotor.station[2].y"):
        assert several[name][-1] == pytest.approx(one[name][-1], abs=2e-4 * size)
    assert ab.load(scene.save(tmp_path / "s.toml")).rotor == scene.rotor
    assert scene.build(tmp_path / "units", one_file=True).files
    own = np.sqrt(np.linalg.eigvals(np.linalg.solve(MASS, STIFFNESS)).real)
    assert scene.rotor().critical == pytest.approx(np.sort(own), rel=1e-9)


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"mass": [[1.0, 2.0], [2.0, 1.0]]}, "mass_matrix.*positive definite"),
        ({"stiffness": np.eye(3)}, "stiffness_matrix.*has the shape"),
        ({"gyroscopic": np.eye(3)}, "gyroscopic_matrix.*has the shape"),
        ({"planes": np.eye(3)}, "plane_rows.*must be rows of 2 numbers"),
        ({"planes": []}, "plane_rows.*must be rows of 2 numbers"),
        ({"stations": [0.0, 0.0]}, "stations.*must be 2 different places"),
        ({"supports": [3]}, "supports"),
        ({"unbalances": [{"position": 0.5, "amount": 1e-4}]}, "must be the place of a plane"),
    ],
)
def test_matrices_that_are_no_rotor_are_refused_by_their_key(more, words):
    with pytest.raises(ab.SceneError, match=words):
        by_matrices(**more)


@pytest.fixture(scope="module")
def ross():
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("NUMBA_DISABLE_JIT", "1")  # it would compile what runs for a moment
        yield pytest.importorskip("ross", reason="needs ross-rotordynamics")


def friswell(rs, elements, discs, bearings):
    """A shaft of Friswell 2010, 5.9: steel, 1.5 m, 50 mm; discs of 70 mm, bore 50 mm."""
    steel = rs.Material("shaft", rho=7810.0, E=211e9, G_s=81.2e9)
    shaft = [
        rs.ShaftElement(L=1.5 / elements, idl=0.0, odl=0.05, material=steel)
        for _ in range(elements)
    ]
    made = [
        rs.DiskElement.from_geometry(n=n, material=steel, width=0.07, i_d=0.05, o_d=size)
        for n, size in discs
    ]
    terms = {"kxx": 1e6, "kyy": 1e6, "cxx": 0.0, "cyy": 0.0}
    held = [rs.BearingElement(n=n, **terms | own) for n, own in bearings]
    return rs.Rotor(shaft, made, held)


def frequencies(table, speed):
    """Eigenvalues with a rising natural frequency, one of each pair."""
    rotor = table.build()
    mass, damping, stiffness = rotor.real_coefficients(speed)
    still = np.linalg.solve(mass, np.hstack([-stiffness, -damping]))
    n = len(mass)
    values = np.linalg.eigvals(np.vstack([np.eye(n, 2 * n, n), still]))
    values = values[values.imag > 1e-6]
    return values[np.argsort(np.abs(values))]


HERTZ = 2.0 * np.pi
CASES = {
    "5.9.1": ({}, SPEED, [85.389, 87.796, 251.785, 294.713, 600.179, 827.075], ()),
    "5.9.2": ({"kyy": 8e5}, SPEED, [82.325, 86.864, 239.639, 287.243, 583.398], ()),
    "5.9.3": (
        {"kyy": 2e5}, SPEED,
        [f * HERTZ for f in (8.545, 13.771, 22.354, 44.063, 78.745, 120.333)], (),
    ),
    "5.9.4 at rest": (
        {"kxy": 5e5, "kyx": 5e5}, 0.0,
        [f * HERTZ for f in (11.663, 14.801, 33.970, 49.192, 97.944, 126.569)], (),
    ),
    "5.9.4": (
        {"kxy": 5e5, "kyx": 5e5}, SPEED,
        [f * HERTZ for f in (11.652, 14.788, 33.155, 49.686, 89.401, 133.722)], (),
    ),
    "5.9.5": (
        {"cxx": 3e3, "cyy": 3e3}, SPEED,
        [f * HERTZ for f in (13.697, 14.092, 43.607, 52.177, 122.338)],
        (-4.083, -4.742, -74.097, -78.804),
    ),
    "cross": (
        {"kxy": 2e5, "kyx": -2e5, "cxx": 3e3, "cyy": 3e3}, SPEED,
        [f * HERTZ for f in (13.953, 13.972, 46.765, 49.422, 139.147, 141.319)],
        (-6.868, -1.152, -90.006, -63.258),
    ),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_friswells_rotors_of_ross_keep_their_frequencies_within_a_thousandth(ross, case):
    """Own Timoshenko elements, 24 of them, have these values; the model is reduced to ten."""
    own, speed, expected, decays = CASES[case]
    model = friswell(ross, 24, [(8, 0.28), (16, 0.35)], [(0, own), (24, own)])
    reduced = ab.Rotor.from_ross(model, [8, 16], speed=SPEED)
    found = frequencies(reduced.table, speed)[: len(expected)]
    assert np.abs(found) == pytest.approx(expected, rel=1e-3)
    assert found.real[: len(decays)] == pytest.approx(decays, abs=2e-3)
    assert reduced.error < 1e-3
    assert "reduced to 10 displacements" in str(reduced)


@pytest.mark.slow
def test_the_overhung_rotor_of_ross_keeps_its_six_frequencies_and_turns_with_balls(ross):
    own = {"kxx": 1e7, "kyy": 1e7}
    model = friswell(ross, 6, [(6, 0.35)], [(0, own), (4, own)])
    reduced = ab.Rotor.from_ross(
        model, [6], speed=SPEED, unbalances=[{"position": 1.5, "amount": 1e-3}]
    )
    found = np.abs(frequencies(reduced.table, SPEED))[:6]
    assert found == pytest.approx([76.190, 103.909, 565.991, 634.234, 647.749, 1174.197], rel=1e-4)
    balls = ab.Balls(count=2, mass=0.05, track_radius=0.1, drag=1.0)
    scene = ab.Scene(rotor=reduced.table, balancer=[balls], speed=SPEED, run={"revolutions": 5})
    assert scene.run().estimated_error < 1e-4


def test_a_node_that_does_not_exist_is_refused(ross):
    model = friswell(ross, 6, [(6, 0.35)], [(0, {}), (4, {})])
    with pytest.raises(ab.UserError, match="must be a node of the model, 0 to 6"):
        ab.Rotor.from_ross(model, [7], speed=SPEED)


def test_the_balance_is_judged_at_the_outer_bearings_in_whatever_order_they_are_given():
    places = np.array([0.0, 0.2, 0.5, 0.9])
    model = SimpleNamespace(places=places, bearings=(1, 3, 2))
    assert _judged(places, model) == [2, 4]
