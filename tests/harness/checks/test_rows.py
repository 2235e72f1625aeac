"""Rows of checks: which hold, and how they are written."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from autobalancer.harness.checks.liquid_window import sign_change
from autobalancer.harness.checks.report import as_json, table, verdict
from autobalancer.harness.checks.row import Row, Rows
from autobalancer.harness.errors import SimulationError
from autobalancer.harness.output.files import write_json

pytestmark = pytest.mark.slow

ROWS = Rows("scene", "check")


def number(expected: float, measured: float, tolerance: float = 1e-3, **options) -> Row:
    return ROWS.number("a | b", expected, measured, tolerance, "paper", **options)


def test_row_holds_up_to_its_tolerance_of_the_expected_value():
    assert number(2.0, 2.0019).holds
    assert not number(2.0, 2.0021).holds
    assert number(2.0, 2.0021).error == pytest.approx(1.05e-3)
    assert not number(2.0, 2.0019, scale=1.0).holds


def test_where_zero_is_expected_the_error_is_that_of_the_measured_value():
    assert number(0.0, 9e-4).holds
    assert number(0.0, 2e-3).error == 2e-3
    assert not number(0.0, 2e-3).holds


def test_a_measured_value_that_is_not_a_number_does_not_hold():
    assert not number(1.0, math.nan).holds
    assert not number(math.inf, math.inf).holds
    assert not number(1.0, math.inf).holds


def test_worst_point_of_a_curve_is_the_one_that_is_not_a_number():
    row = ROWS.number("curve", [1.0, 2.0, 0.0], [1.5, math.nan, 0.0], 1.0, "paper")
    assert row.expected == 2.0
    assert not row.holds
    assert ROWS.number("curve", [1.0, 2.0, 0.0], [1.5, 2.0, 0.0], 1.0, "paper").error == 0.5


def test_json_has_words_where_it_has_no_numbers(tmp_path):
    rows = [
        number(1.0, math.nan),
        Row("s", "c", "q", "none", math.inf, None, None, True, 0.1, "p"),
    ]
    write_json(as_json(rows), tmp_path / "rows.json")
    document = json.loads(
        (tmp_path / "rows.json").read_text(encoding="utf-8"), parse_constant=pytest.fail
    )
    assert document["holds"] is False
    assert [row["measured"] for row in document["rows"]] == ["nan", "inf"]
    assert document["rows"][1]["error"] is None


def test_nothing_checked_does_not_hold():
    assert as_json([])["holds"] is False
    assert verdict([]) == "Nothing was checked."


def test_a_report_marks_the_row_that_fails():
    rows = [number(1.0, 2.0, 0.1)]
    assert verdict(rows) == "1 of 1 rows do NOT hold."
    assert table(rows, "scene").rows[0][2:7] == ["1", "2", "1", "0.1", "NO"]


def test_sign_change_is_found_from_a_guess_that_is_off():
    assert sign_change(lambda w: w**2 - 2.0, 3.0, "root") == pytest.approx(2.0**0.5, rel=1e-9)


@pytest.mark.parametrize("function", [lambda w: 0.0, lambda w: 1.0, lambda w: math.nan])
def test_a_function_without_a_sign_changes_none(function):
    with pytest.raises(SimulationError, match=r"root was not found between 0.25 and 4 rad/s"):
        sign_change(function, 1.0, "root")


def test_a_product_that_underflows_still_changes_its_sign():
    assert np.isclose(sign_change(lambda w: 1e-200 * (w - 1.01), 1.0, "root"), 1.01)
