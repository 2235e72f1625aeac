"""Records of run-ups in C against the same run of the harness."""

from __future__ import annotations

import numpy as np
import pytest

from autobalancer.harness import SimulationError, UserError, cosimulate, load_scene
from autobalancer.harness.master.sweep import sweep_alike


@pytest.fixture
def scene():
    changes = {"operation.run_up.seconds": 2.0, "coupling.steps_per_rev": 80}
    return load_scene("run_up").replace(changes)


def test_a_record_holds_the_largest_amplitude_of_its_time(scene):
    changed = scene.replace({"weights.drag": 1.7 * scene.balancer[0].drag})
    found = sweep_alike([scene, changed], 0.5)
    assert found.amplitude.shape == (2, 4, 1)
    for one, amplitude in zip((scene, changed), found.amplitude, strict=True):
        run = cosimulate(one, record=["rotor.x", "rotor.y"])
        size = np.hypot(run["rotor.x"], run["rotor.y"])
        for number in range(4):
            inside = (run.time > 0.5 * number) & (run.time <= 0.5 * (number + 1))
            assert amplitude[number, 0] == pytest.approx(
                size[inside].max(), rel=5e-3
            )  # 200 samples
    rise = scene.operation.run_up
    assert found.speeds[0] == pytest.approx(rise.start + (rise.to - rise.start) / 8.0)


def test_a_rise_shorter_than_a_record_is_refused(scene):
    with pytest.raises(UserError, match=r"run_up.seconds: must be 3 s or more"):
        sweep_alike([scene], 3.0)


def test_a_run_that_fails_is_an_error_with_its_reason(scene):
    heavy = {"weights.mass": 50.0, "weights.inertia_as_force": True}
    with pytest.raises(SimulationError, match=r"run_up: .* too long .* loop gain 11\.6"):
        sweep_alike([scene.replace({**heavy, "coupling.scheme": "compensated"})], 0.5)
