"""Every row of the measured rig of Rodrigues et al. 2010."""

from __future__ import annotations

from autobalancer.harness import check, load_scene


def test_every_row_holds_but_the_authors_curve_without_balls():
    """That one misses by little, where modes cancel; and a run-down: harness/bristol.md."""
    rows = check(load_scene("bristol"))
    assert len(rows) == 40
    missed = [row for row in rows if not row.holds]
    assert [row.quantity for row in missed if not row.source.endswith("Fig. 8a")] == [
        "first resonance with balls on the way down, washers: 0 [mm]"
    ]
    missed = [row for row in missed if row.source.endswith("Fig. 8a")]
    assert max(row.error for row in missed) < 0.053
