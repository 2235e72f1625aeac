"""The error that a stiff machine states is true, whichever engine the unit chooses for it."""

from __future__ import annotations

import pytest

from autobalancer.harness import cosimulate
from tests.studies.stiff import NAMES, TOLERANCE, cases, true_error

CASES = dict(cases())


@pytest.mark.parametrize(
    ("name", "in_one_piece"),
    [("ky/kx 10000", True), ("ky/kx 1e+07", False), ("drag x 10000", False)],
)
def test_a_stiff_machine_errs_by_less_than_it_states(name, in_one_piece):
    """SciPy integrates equations of the study's own."""
    scene = CASES[name].replace({"run.revolutions": 1})
    run = cosimulate(scene, record=NAMES)
    assert (run.series_order > 0) == in_one_piece
    assert run.error_known
    assert true_error(scene, run) <= run.estimated_error <= TOLERANCE
