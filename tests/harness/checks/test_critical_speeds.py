"""Published critical speeds beside the co-simulated ones."""

from __future__ import annotations

import math

import pytest

from autobalancer.harness import load_scene
from autobalancer.harness.checks.critical_speeds import check_critical_speeds, run_from_rest
from autobalancer.harness.errors import SceneError

pytestmark = pytest.mark.slow


def published(scene):
    rows = [
        row for each in scene.checks if each.published for row in check_critical_speeds(scene, each)
    ]
    return [row for row in rows if "published" in row.quantity]


@pytest.fixture
def scene():
    return load_scene("two_plane_rodrigues")


def test_two_planes_balance_above_the_speeds_of_the_chart(scene):
    """Rodrigues et al. 2008, Fig. 7: its terms of second order grow with the eccentricity."""
    rows = published(scene)
    assert [row.expected for row in rows] == [2.0860, 2.4824, 3.532]
    assert all(row.holds for row in rows)
    errors = [row.error for row in rows]
    assert errors == sorted(errors)
    assert errors[2] > 5e-3


def test_a_published_speed_that_is_not_there_does_not_hold(scene):
    table = {"kind": "critical_speeds", "range": [3.6, 3.8], "published": [3.7]}
    alone = scene.without().with_check(table)
    (row,) = published(alone)
    assert not row.holds
    assert row.measured != row.measured  # NaN: none found


def test_a_run_from_rest_in_balance_is_refused_as_it_loses_nothing():
    start = {"rotor.unbalance": 0.0, "weights.angles": [0.5, 0.5 + math.pi]}
    with pytest.raises(SceneError, match=r"in balance at the start: .*weights\.angles"):
        run_from_rest(load_scene("two_balls").replace(start), 3.0, 2)
