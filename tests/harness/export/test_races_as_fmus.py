"""Machines with lobes as FMUs of both versions, for co-simulation and model exchange."""

from __future__ import annotations

import numpy as np
import pytest
from fmpy import simulate_fmu

from autobalancer.models.monolith import simulate
from tests.harness.master.test_races import machine

SIGNALS = ["rotor.x", "balls.weight[1].angle", "balls.F_xi"]


@pytest.mark.parametrize("version", ["2", "3"])
def test_one_file_moves_as_an_integration_in_one_piece(version, tmp_path, invoke):
    scene = machine()
    file = scene.save(tmp_path / "fan.toml")
    options = ("--one-file", "--fmi", version, "--platform", "x86_64-linux", "-o", tmp_path)
    outcome = invoke("build", file, *options)
    assert outcome.exit_code == 0, outcome.output
    times = np.linspace(0.0, 0.3, 61)
    truth = simulate(scene.assembly(), scene.profile(), times, rtol=1e-11)
    for kind in ("CoSimulation", "ModelExchange"):
        found = simulate_fmu(
            str(tmp_path / "fan.fmu"), stop_time=0.3, output_interval=0.005, fmi_type=kind,
            output=SIGNALS, relative_tolerance=1e-8,
        )  # fmt: skip
        for name in SIGNALS:
            error = np.abs(found[name] - truth[name]).max() / np.ptp(truth[name])
            assert error < 1e-6, (kind, name)
