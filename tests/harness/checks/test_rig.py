"""Rows of the measured rig of Rodrigues et al. 2010."""

from __future__ import annotations

import pytest

from autobalancer.harness import load_scene
from autobalancer.harness.checks.rig import GROUPS, check_rig

pytestmark = pytest.mark.slow


def test_every_row_holds_but_the_authors_curve_without_balls():
    """That one misses by little, where modes cancel: harness/manual/results/bristol.md.

    The way down takes a minute more; `autobalancer check bristol` has it too.
    """
    rig, groups = load_scene("bristol"), sorted({*GROUPS} - {"way down"})
    rows = [row for name in groups for row in check_rig(rig, rows_of=name)]
    assert len(rows) == 34
    missed = [row for row in rows if not row.holds]
    assert {row.source.split(", ")[-1] for row in missed} == {"Fig. 8a"}
    assert max(row.error for row in missed) < 0.053
