"""Stability proved on bearings that change with the speed: tables and journal bearings."""

from __future__ import annotations

import numpy as np
import pytest

import autobalancer as ab

flint = pytest.importorskip("flint")

from autobalancer.harness import Scene as Core  # noqa: E402
from autobalancer.harness import UserError  # noqa: E402
from autobalancer.harness.stability.exact import system  # noqa: E402
from autobalancer.models.proof.certificate import Certificate  # noqa: E402
from autobalancer.models.proof.lines import piece_around  # noqa: E402
from autobalancer.models.stability import growth_rates  # noqa: E402

BALLS = {"name": "balls", "kind": "balls", "count": 2, "mass": 0.02, "track_radius": 0.08,
         "drag": 0.5, "angles": [1.0, 2.8]}  # fmt: skip
ROWS = [
    [50.0, 1e5, 2e3, -1e3, 1.2e5, 60, 5, 5, 80],
    [150.0, 1.4e5, 5e3, -6e3, 1.0e5, 80, 2, 1, 90],
    [300.0, 1.6e5, 9e3, -9e3, 2.0e5, 70, 2, 3, 60],
    [400.0, 1.5e5, 9e3, -9e3, 2.1e5, 60, 2, 3, 60],
]
JOURNAL = {"diameter": 0.02, "length": 0.008, "clearance": 4e-5, "viscosity": 0.01,
           "speeds": [300.0, 340.0]}  # fmt: skip


def planar(rows, **more):
    rotor = {"kind": "planar", "mass": 10.0, "unbalance": 1e-3, "bearings": [{"table": rows}]}
    return ab.Scene(rotor=rotor, speed=0.5 * (rows[0][0] + rows[-1][0]), **more)


def crossed(speed: float, cross: float) -> list[float]:
    """A row of k = 1e5 N/m, c = 60 N s/m and cross terms that drive forward whirl."""
    return [speed, 1e5, cross, -cross, 1e5, 60.0, 0.0, 0.0, 60.0]


def signs(scene, speeds: np.ndarray) -> set[str]:
    """Of the growth about balance, with the matrices of each speed, by integration."""
    assembly = scene.assembly()
    rates = [growth_rates(assembly.at_speed(w), np.array([w]))[0] for w in speeds.tolist()]
    return {"unstable" if rate > 0.0 else "stable" for rate in rates}


@pytest.fixture(autouse=True)
def _bits():
    with flint.ctx.workprec(128):
        yield


@pytest.mark.parametrize(
    "rows",
    [
        [crossed(400.0, 4000.0), crossed(800.0, 8000.0)],
        [crossed(400.0, 0.0), crossed(580.0, 5900.0), crossed(620.0, 6100.0), crossed(800.0, 9e4)],
        [crossed(400.0, 4000.0), crossed(600.0, 6000.0), crossed(800.0, 9000.0)],
    ],
    ids=["one line", "between rows", "at a row"],
)
def test_the_threshold_of_cross_terms_in_closed_form_is_enclosed(rows):
    """A round rotor whirls above q = c sqrt(k/M) = 6000 N/m, which these tables reach at 600."""
    proof = planar(rows).speeds(500.0, 700.0, "proved").proof
    ((band, crossing),) = proof.boundaries
    assert band.low < 600.0 < band.high
    assert crossing.above == "unstable"
    assert band.high - band.low < 1e-4
    assert [one.state for one in proof.bands] == ["stable", "undecided", "unstable"]


@pytest.mark.parametrize("balancer", [[], [BALLS]], ids=["bare", "balls"])
def test_growth_on_a_line_is_that_of_the_matrices_of_each_speed(balancer):
    core = Core.from_document(planar(ROWS, balancer=balancer).document)
    speeds = np.array([60.0, 149.0, 151.0, 222.0, 300.0, 399.0])
    found = [Certificate.of(system(core, (), w), w, 0).growth for w in speeds]
    assembly = core.assembly()
    expected = [growth_rates(assembly.at_speed(w), np.array([w]))[0] for w in speeds.tolist()]
    np.testing.assert_allclose(found, expected, rtol=1e-8)


def test_signs_by_floquet_are_those_that_are_proved_across_the_rows():
    scene = planar(ROWS, balancer=[BALLS])
    bands = scene.speeds(60.0, 390.0, "proved", narrowest=0.5).proof.bands
    assert {band.state for band in bands} == {"unstable", "undecided", "stable"}
    decided = [band for band in bands if band.state != "undecided"]
    assert sum(band.high - band.low for band in decided) > 0.95 * 330.0
    for band in decided:
        ends = np.array([band.low + 0.01, band.high - 0.01])
        assert signs(scene, ends) == {band.state}


def test_nothing_is_proved_of_speeds_beyond_the_line_of_a_certificate():
    core = Core.from_document(planar(ROWS).document)
    certificate = Certificate.of(system(core, (), 200.0), 200.0)
    assert certificate.piece == (150.0, 300.0) == piece_around(core.assembly().rotor, 200.0)
    assert certificate.state(190.0, 210.0) != "undecided"
    assert certificate.state(149.9, 210.0) == "undecided" == certificate.state(190.0, 300.1)


def test_a_limit_on_journal_bearings_is_proved():
    scene = ab.load("small_turbine")
    bearings = [{"support": k, "journal": JOURNAL} for k in (1, 2)]
    narrow = scene.replace({"rotor.bearings": bearings, "operation.speed": 320.0})
    proof = narrow.speeds(315.0, 330.0, "proved", narrowest=0.1).proof
    below, between, above = proof.bands
    assert (below.state, between.state, above.state) == ("unstable", "undecided", "stable")
    assert signs(narrow, np.array([below.high])) == {"unstable"}
    assert signs(narrow, np.array([above.low])) == {"stable"}


def test_cells_of_a_map_are_proved_across_rows():
    scene = planar(ROWS, balancer=[BALLS])
    cells = scene.map("speed=250:370:6", "balls.drag=0.4:0.5:2", "proved").cells
    assert (cells[:, 2] != 0).all()
    assert (cells != 0).mean() > 0.6
    middles = scene.map("speed=260:360:6", "balls.drag=0.425:0.475:2")
    decided = cells != 0
    assert ((cells == 1) == (middles.growth < 0.0))[decided].all()


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ("rotor.bearings[1].table", "takes no interval"),
        ("rotor.bearings[1].journal.viscosity", "takes no interval"),
        ("rotor.mass", r"give\s+rotor\.bearings\[1\]\.journal\.load"),
    ],
)
def test_tolerances_that_shape_a_table_are_refused_by_name(path, words):
    bearing = {"table": ROWS} if path.endswith("table") else {"journal": JOURNAL}
    rotor = {"kind": "planar", "mass": 10.0, "bearings": [bearing]}
    scene = ab.Scene(rotor=rotor, speed=310.0)
    with pytest.raises(UserError, match=words):
        scene.speeds(305.0, 320.0, "proved", within=f"{path}=5%")
