"""Machines as they are built, as FMUs for model exchange: the motion is that of the scene."""

from __future__ import annotations

import math

import numpy as np
import pytest
from fmpy import platform_tuple, simulate_fmu

import autobalancer as ab

SCENES = (
    "overhung_fan", "washing_machine_tub", "angle_grinder", "small_turbine", "rubber_drive",
    "washing_machine_stops", "oval_fan", "washing_machine_ring",
)  # fmt: skip


@pytest.mark.parametrize("name", SCENES)
def test_a_built_machine_moves_in_another_solver_as_its_scene_does(name, tmp_path):
    scene = ab.load(name)
    seconds = 1.0 if scene.profile().changes else 6.0 * math.tau / scene.profile().end
    scene = scene.replace({"run.revolutions": None, "run.duration": seconds})
    numbered = [f"station[{k}]." for k in range(1, len(scene.rotor.points) + 1)]
    prefixes = numbered if len(numbered) > 1 else [""]
    names = [f"rotor.{prefix}{axis}" for prefix in prefixes for axis in "xy"]
    run = scene.run(record=names)
    scene.build(tmp_path, one_file=True, platforms=[platform_tuple])
    found = simulate_fmu(
        str(tmp_path / f"{name}.fmu"), fmi_type="ModelExchange", stop_time=seconds,
        relative_tolerance=1e-8, output=names, output_interval=seconds / 50.0,
    )  # fmt: skip
    sizes = max(np.abs(run[each]).max() for each in names)
    for each in names:
        assert found[each][-1] == pytest.approx(run[each][-1], abs=3e-5 * sizes)
