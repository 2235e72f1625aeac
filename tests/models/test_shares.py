"""The confidence interval of a share, against SciPy's."""

from __future__ import annotations

import pytest
from scipy.stats import binomtest

from autobalancer.models.shares import wilson


@pytest.mark.parametrize(("count", "of"), [(0, 5), (5, 5), (3, 7), (1, 200), (999, 1000)])
def test_the_interval_of_a_share_is_that_of_scipy(count, of):
    expected = binomtest(count, of).proportion_ci(0.95, "wilson")
    assert wilson(count, of) == pytest.approx((expected.low, expected.high), abs=1e-12)


def test_a_scatter_and_a_study_of_motions_state_the_same_interval():
    from autobalancer.harness.motions import outcome
    from autobalancer.harness.scatter import report

    assert outcome.wilson is report.wilson is wilson
