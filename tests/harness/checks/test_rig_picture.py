"""The picture of the rig: which panel shows what, and sweeps without their start from rest."""

from __future__ import annotations

import numpy as np
import pytest

from autobalancer.harness import load_scene
from autobalancer.harness.checks import rig_picture


@pytest.fixture
def sweeps(monkeypatch):
    """Speeds (low, high) of the sweeps that the picture asks for; none is run."""
    asked = []

    def swept(_scene, washers, low, high, _falling):
        asked.append((low, high))
        return {number: (np.array([low, high]), np.ones(2)) for number in washers}

    monkeypatch.setattr(rig_picture, "swept", swept)
    return asked


def test_every_panel_says_how_many_washers_and_one_names_the_lines(sweeps):
    picture = rig_picture.plot_rig(load_scene("bristol"))
    assert [panel.title for panel in picture.panels[:4]] == [
        "0 washers, speed rising", "0 washers, speed falling",
        "1 washer, speed rising", "1 washer, speed falling",
    ]  # fmt: skip
    assert "washers" not in picture.title  # the scene has three
    named = [sum(bool(line.label) for line in panel.lines) for panel in picture.panels]
    assert named == [4] + [0] * 9


def test_sweeps_begin_beyond_what_is_shown(sweeps):
    """Where a sweep starts it starts from rest, and not with the vibration of that speed."""
    picture = rig_picture.plot_rig(load_scene("bristol"))
    low, high = picture.panels[0].axes[0].limits
    assert len(sweeps) == 4
    assert all(begin < low - 20.0 and high + 20.0 < end for begin, end in sweeps)
