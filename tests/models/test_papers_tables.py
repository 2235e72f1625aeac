"""Rows of Tables 1 and 2 of Filimonikhina 2017 from the coupled units."""

import pytest

from autobalancer.harness import SceneError, load_scene
from autobalancer.harness.checks.filimonikhina import check_row, variant
from autobalancer.harness.checks.filimonikhina import rows_of as compared
from autobalancer.models.papers.dimensionless import Dimensionless
from autobalancer.models.papers.tables import TABLE_1, TABLE_2

pytestmark = pytest.mark.slow

TABLES = (TABLE_1, TABLE_2)


def rows_of(table: int, number: int):
    """Rows of the check for one row of a table, counted from 1."""
    scene = load_scene("filimonikhina_tables")
    index = number - 1 + (table == 2) * len(TABLE_1)
    return list(check_row(scene, index))


def test_every_row_becomes_a_scene_with_its_parameters_in_the_scale_of_the_scene():
    scene = load_scene("filimonikhina_tables").replace(
        {
            "rotor.mass": 9.9,
            "rotor.stiffness": [90.0, 4410.0],
            "rotor.damping": [15.0, 30.0],
            "weights.mass": 0.05,
            "weights.track_radius": 0.1,
        }
    )
    for row in (*TABLE_1, *TABLE_2):
        scaled, w_x = variant(scene, row)
        found, frequency = Dimensionless.of(scaled.assembly())
        assert w_x == frequency == pytest.approx(3.0)
        assert float(scaled.assembly().loaded_rotor.mass[0, 0]) == pytest.approx(10.0)
        wanted = Dimensionless.of_row(row)
        for name in ("eps", "mu_xi", "mu_eta", "mu_w", "n_eta", "unbalance"):
            assert getattr(found, name) == pytest.approx(getattr(wanted, name), rel=1e-12), name


@pytest.mark.parametrize(("table", "number"), [(1, 4), (2, 8)])
def test_a_row_holds_paper_floquet_and_cosimulation(table, number):
    rows = rows_of(table, number)
    assert all(row.quantity.startswith(f"Table {table} row {number} ") for row in rows)
    assert all(row.holds for row in rows), [r for r in rows if not r.holds]
    printed = [r for r in rows if "in the paper's interval" in r.quantity]
    measured = [r for r in rows if "critical speed" in r.quantity]
    assert len(printed) == len(measured) == len(TABLES[table - 1][number - 1].intervals)
    assert max(row.error for row in measured) < 1e-3


def test_a_band_that_the_paper_does_not_report_is_shown_by_a_run():
    rows = rows_of(2, 5)
    assert all(row.holds for row in rows)
    (found,) = [row for row in rows if "FINDING" in row.quantity]
    assert "unstable again from 5.3982 to 7.9641" in found.quantity
    assert found.measured.startswith("not balanced")


def test_an_interval_that_is_wrong_does_not_hold():
    scene = load_scene("filimonikhina_tables")
    from dataclasses import replace

    wrong = replace(TABLE_2[7], intervals=((9.60, 9.65),))
    rows = list(compared(0, *variant(scene, wrong), wrong))
    (printed,) = [r for r in rows if "in the paper's interval" in r.quantity]
    assert not printed.holds


def test_other_weights_than_the_papers_are_refused():
    scene = load_scene("filimonikhina_tables").replace({"weights.kind": "balls"})
    with pytest.raises(SceneError, match="two pendulums"):
        variant(scene, TABLE_1[0])
