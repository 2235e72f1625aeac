"""The rotors against ROSS, an independent finite-element rotor code (PyPI: ross-rotordynamics)."""

from __future__ import annotations

import numpy as np
import pytest

from autobalancer.models.linear.modes import modes
from autobalancer.models.papers.influence import influence
from autobalancer.models.rotor import LinearRotor

pytestmark = pytest.mark.slow

TOLERANCE = 1e-3
LIGHT = 1e-3  # kg/m^3: the shaft of the models has no mass; 1e-6 of the discs' here
YOUNG, DIAMETER = 2.1e11, 0.03
BENDING = YOUNG * np.pi * DIAMETER**4 / 64
STATIONS, MASSES = (0.0, 0.35, 1.0), (3.0, 8.0, 2.0)


@pytest.fixture(scope="module", autouse=True)
def _interpreted():
    """Numba would compile for ten seconds what runs for a moment."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("NUMBA_DISABLE_JIT", "1")
        yield


def finite_elements(stations, discs, bearings, young=YOUNG, elements_a_bay=4):
    """Rotor of slender beam elements without shear or rotary inertia; nodes of the stations."""
    rs = pytest.importorskip("ross", reason="needs ross-rotordynamics")  # seconds to import
    # no shear in the elements; Poisson's ratio of steel
    steel = rs.Material("light", rho=LIGHT, E=young, Poisson=0.3)
    lengths = np.repeat(np.diff(stations), elements_a_bay) / elements_a_bay
    shaft = [
        rs.ShaftElement(
            L=length,
            idl=0.0,
            odl=DIAMETER,
            material=steel,
            shear_effects=False,
            rotary_inertia=False,
            gyroscopic=False,
        )
        for length in lengths
    ]
    nodes = [elements_a_bay * j for j in range(len(stations))]
    return (
        rs.Rotor(
            shaft,
            [rs.DiskElement(n=nodes[j], **disc) for j, disc in discs],
            [rs.BearingElement(n=nodes[j], **bearing) for j, bearing in bearings],
        ),
        nodes,
    )


def bearing(stiffness, damping):
    return {"kxx": stiffness[0], "kyy": stiffness[1], "cxx": damping[0], "cyy": damping[1]}


def lateral_modes(rotor, nodes, speed, count):
    """The `count` slowest lateral modes: eigenvalues (count,) and shapes (count, 2, nodes)."""
    found = rotor.run_modal(speed, num_modes=2 * rotor.ndof - 2, sparse=False)
    per_node = rotor.number_dof
    place = found.evectors[: rotor.ndof].T.reshape(-1, len(rotor.nodes), per_node)[:, nodes, :2]
    whole = np.linalg.norm(found.evectors[: rotor.ndof], axis=0)
    sideways = np.linalg.norm(place.reshape(len(place), -1), axis=1) > 1e-3 * whole
    keep = np.flatnonzero(sideways & (found.evalues.imag > 0.0))
    keep = keep[np.argsort(np.abs(found.evalues[keep]))][:count]
    return found.evalues[keep], place[keep].transpose(0, 2, 1)


def assurance(shapes, others):
    """Modal assurance criterion of shapes in pairs, 1 for the same shape."""
    a, b = (s.reshape(len(s), -1) for s in (shapes, others))
    square = np.abs((a.conj() * b).sum(axis=1)) ** 2
    return square / ((np.abs(a) ** 2).sum(axis=1) * (np.abs(b) ** 2).sum(axis=1))


SHAFTS = {
    "three discs": (STATIONS, MASSES, (1, 3)),
    "disc overhung": ((0.0, 0.4, 0.9, 1.2), (2.0, 7.0, 3.0, 4.0), (1, 3)),
}
SUPPORTS = {
    "anisotropic": (((4e6, 7e6), (5e6, 3e6)), ((300.0, 200.0), (100.0, 400.0))),
    "soft": (((2e5, 3e5), (1e5, 4e5)), ((80.0, 20.0), (30.0, 60.0))),
}


def flexible_pair(shaft, supports):
    stations, masses, ends = SHAFTS[shaft]
    stiffness, damping = SUPPORTS[supports]
    ours = LinearRotor.flexible(
        stations=stations,
        masses=masses,
        supports=ends,
        support_stiffness=stiffness,
        support_damping=damping,
        bending_stiffness=BENDING,
    )
    theirs = finite_elements(
        stations,
        [(j, {"m": m, "Id": 0.0, "Ip": 0.0}) for j, m in enumerate(masses)],
        [(e - 1, bearing(k, c)) for e, k, c in zip(ends, stiffness, damping, strict=True)],
    )
    return ours, *theirs


@pytest.mark.parametrize("supports", SUPPORTS)
@pytest.mark.parametrize("shaft", SHAFTS)
def test_shaft_has_the_modes_of_the_finite_element_model(shaft, supports):
    ours, theirs, nodes = flexible_pair(shaft, supports)
    found = modes(ours, 100.0)
    values, shapes = lateral_modes(theirs, nodes, 100.0, 2 * ours.stations)
    assert len(found.eigenvalues) == len(values)
    np.testing.assert_allclose(found.eigenvalues, values, rtol=TOLERANCE)
    np.testing.assert_allclose(found.damping_ratios, -values.real / np.abs(values), rtol=TOLERANCE)
    np.testing.assert_allclose(assurance(found.shapes, shapes), 1.0, atol=TOLERANCE)


@pytest.mark.parametrize("speed", [50.0, 237.0, 1200.0])
def test_unbalance_response_is_that_of_the_finite_element_model(speed):
    ours, theirs, nodes = flexible_pair("three discs", "soft")
    result = theirs.run_unbalance_response(nodes[1], 1e-3, 0.0, np.array([speed]))
    place = result.forced_resp[:, 0].reshape(len(theirs.nodes), -1)[nodes, :2].T
    np.testing.assert_allclose(
        influence(ours, speed)[:, :, 1] * 1e-3, place, rtol=TOLERANCE, atol=1e-12
    )
