"""The picture of a run shows the way across stops, their gaps, and where they were touched."""

from __future__ import annotations

import numpy as np
import pytest

import autobalancer as ab
from autobalancer.harness.result.stop_panel import stop_panel

pytestmark = pytest.mark.filterwarnings(
    "ignore::autobalancer.harness.scene.plausible.ImplausibleWarning"
)


@pytest.fixture(scope="module")
def run():
    scene = ab.load("washing_machine_stops").without_balancers()
    return scene.replace({"operation.run_up.seconds": 16, "run.duration": 8}).run()


def test_the_way_is_that_of_the_tub_and_the_gap_is_where_it_was_touched(run):
    panel = stop_panel(run.scene, run.time, run.signals)
    way, marks, gap = panel.lines
    tub = np.hypot(run["rotor.station[2].x"], run["rotor.station[2].y"])
    np.testing.assert_allclose(way.points[1], 1e3 * tub, rtol=1e-12)
    assert way.label.startswith("ring at tub.foot[1], 0-peak ")
    assert (gap.label, gap.points[1].tolist()) == ("gap, 10 mm", [10.0, 10.0])
    began = np.interp(marks.points[0], run.time, 1e3 * tub)
    assert (len(began), marks.label) == (1, "touched once")
    assert began == pytest.approx(np.full(len(began), 10.0), abs=0.2)


def test_a_run_without_stops_or_without_the_motion_has_no_such_panel(run):
    scene = ab.load("two_balls")
    assert stop_panel(scene, run.time, run.signals) is None
    assert stop_panel(run.scene, run.time, {"rotor.station[2].x": run.time}) is None


def test_the_picture_of_the_run_has_the_panel(run, tmp_path):
    assert "way across stops" in [panel.axes[1].name for panel in run.plot().panels]
