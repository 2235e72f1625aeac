"""Whole scenes: what the master couples is the same whichever units it couples."""

from __future__ import annotations

import shutil

import numpy as np
import pytest

from autobalancer.harness import bundled_scenes, cosimulate, load_scene
from autobalancer.harness.wiring import file_name, plan


@pytest.mark.parametrize("name", bundled_scenes())
def test_a_scene_moves_alike_on_native_and_python_units(fmus, tmp_path, name):
    """To 1e-12 of each signal's range over 20 revolutions, collisions and sticking included."""
    scene = load_scene(name).replace({"run.revolutions": 20})
    for unit in plan(scene):
        source = fmus.native(unit.model, **unit.options)
        shutil.copy(source, tmp_path / file_name(unit))
    expected = cosimulate(scene)
    found = cosimulate(scene, fmus=tmp_path)
    assert np.array_equal(found.time, expected.time)
    for signal in expected.signals:
        size = max(np.ptp(expected[signal]), 1e-3 * np.abs(expected[signal]).max())
        assert np.abs(found[signal] - expected[signal]).max() <= 1e-12 * size, signal
