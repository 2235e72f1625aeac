"""`autobalancer build`: native units for all platforms, or what was asked for instead."""

from __future__ import annotations

import math
import zipfile
from pathlib import Path

import pytest
from fmpy import read_model_description
from typer.testing import CliRunner

from autobalancer.fmus.native.build import compile as compiler
from autobalancer.harness.__main__ import program

pytestmark = pytest.mark.slow

pytest.importorskip("ziglang", reason="no compiler: ziglang is not installed")


def invoke(*arguments):
    return CliRunner().invoke(program(), ["build", *map(str, arguments)])


def folders(path: Path) -> set[str]:
    with zipfile.ZipFile(path) as archive:
        return {n.split("/")[1] for n in archive.namelist() if n.startswith("binaries/")}


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_scene_is_one_file_on_request(tmp_path, fmi):
    chosen = ("--platform", "x86_64-linux")
    outcome = invoke("two_balls", "--one-file", "--fmi", fmi, "-o", tmp_path, *chosen)
    assert outcome.exit_code == 0, outcome.output
    description = read_model_description(str(tmp_path / "two_balls.fmu"))
    assert description.modelName == "two_balls"
    proposed = description.defaultExperiment  # 20 revolutions at 3 rad/s, in 20 steps each
    found = float(proposed.stopTime), float(proposed.stepSize)
    assert found == pytest.approx((20 * 2 * math.pi / 3, 2 * math.pi / 3 / 20), rel=1e-14)
    starts = {v.name: v.start for v in description.modelVariables}
    assert float(starts["rotor.mass"]) == 0.95
    said = {v.name: v.description for v in description.modelVariables}
    assert said["weights.mass"] == "Mass m of each weight (weights) (above 0 kg)"
    assert float(starts["coupling.tolerance"]) == 1e-4


def test_one_file_needs_a_scene_that_it_can_couple(tmp_path):
    assert "give the scene whose units" in invoke("--one-file", "-o", tmp_path).output
    assert not list(tmp_path.glob("*.fmu"))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--python", "--platform", "x86_64-linux"], "native units"),
        (["nowhere"], "nowhere"),
        (["two_balls", "--one-file", "--python"], "has no Python units"),
        (["two_balls", "--one-file", "--platform", "amiga"], "platform = 'amiga'"),
        (["two_balls", "--ssp", "--platform", "amiga"], "platform = 'amiga'"),
    ],
)
def test_what_cannot_be_built_is_refused_and_nothing_is_left(tmp_path, arguments, message):
    outcome = invoke("-o", tmp_path / "new", *arguments)
    assert outcome.exit_code != 0
    assert message in str(outcome.exception) + outcome.output
    assert list(tmp_path.iterdir()) == []


def test_without_compiler_the_command_says_what_to_do(tmp_path, monkeypatch):
    monkeypatch.setattr(compiler, "BINARIES", tmp_path / "bin")
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    outcome = invoke("-o", tmp_path / "units")
    assert outcome.exit_code != 0
    said = str(outcome.exception) + outcome.output
    assert f"pip install ziglang=={compiler.COMPILER}" in said
    assert "--python" in said
