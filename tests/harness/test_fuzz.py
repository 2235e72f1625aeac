"""Mangled scenes, assignments and command lines: no traceback, and no exit code but 0, 1 and 2."""

from __future__ import annotations

import random

import pytest
from typer.testing import CliRunner

from autobalancer.harness.cli import app
from autobalancer.harness.scene import bundled_scenes, load_scene

MANGLED = [
    *["0", "-1", "1e-300", "1e300", "nan", "inf", "true", '""', '"\\u001b[31m"', "[]", "{}"],
    *["[[1.0]]", "99999999999999999999", "1979-05-27", "[1.0, 2.0, 3.0]", "1_0", "'", "=", "1e14"],
]
WORDS = [
    *["run", "check", "map", "speeds", "rotor", "build", "two_balls", "liquid_touch", "nowhere"],
    *["--set", "run.revolutions=0.1", "rotor.mass=-1", "a=b=c", "run.record=[", "--x", "--y"],
    *["speed=1:2:3", "weights.drag=1e-9:1:2:log", "speed=0:1:2", "speed=1:2:2001", "--range"],
    *["1", "2", "-5", "nan", "inf", "--method", "floquet", "", ",", "--narrowest", "1e-9"],
    *["--at-most", "2h", "soon", "-o", "/nowhere/x.csv", "/proc/x.png", "--json", "/", "\x1b[0m"],
]
SHORT = ["--set", "run.revolutions=0.1"]


def refused_or_done(arguments: list[str]) -> None:
    outcome = CliRunner().invoke(app, arguments)
    unforeseen = outcome.exception is not None and not isinstance(outcome.exception, SystemExit)
    assert not unforeseen, (arguments, outcome.exception)
    assert outcome.exit_code in (0, 1, 2), arguments
    assert "\x1b[31m" not in outcome.output, arguments


@pytest.mark.parametrize("seed", range(60))
def test_a_mangled_scene_is_run_or_refused(tmp_path, seed):
    draw = random.Random(seed)
    lines = load_scene(draw.choice(bundled_scenes())).path.read_text("utf-8").splitlines()
    for _ in range(draw.randint(1, 3)):
        place = draw.randrange(len(lines))
        kind = draw.random()
        if kind < 0.6 and "=" in lines[place]:
            lines[place] = f"{lines[place].partition('=')[0]}= {draw.choice(MANGLED)}"
        elif kind < 0.8:
            lines[place] = lines[place][: draw.randint(0, len(lines[place]))]
        else:
            lines.insert(place, draw.choice(lines))
    path = tmp_path / "mangled.toml"
    path.write_text("\n".join(lines), encoding="utf-8")
    refused_or_done(["run", str(path), *SHORT, "--at-most", "5s"])


@pytest.mark.parametrize("seed", range(60))
def test_a_mangled_command_line_is_done_or_refused(tmp_path, monkeypatch, seed):
    monkeypatch.chdir(tmp_path)
    draw = random.Random(seed)
    words = draw.choices(WORDS, k=draw.randint(1, 8))
    if "check" in words[:1]:
        words[0] = "run"  # all scenes: minutes
    if words[:1] == ["build"]:
        words += ["nowhere"]
    refused_or_done(words)


@pytest.mark.parametrize("seed", range(60))
def test_a_mangled_assignment_is_run_or_refused(seed):
    draw = random.Random(seed)
    keys = ["rotor.mass", "rotor.stiffness", "rotor.unbalance", "weights.drag", "weights.mass"]
    keys += ["weights.angles", "operation.speed", "run.initial.x", "coupling.order", "title"]
    key, value = draw.choice(keys), draw.choice(MANGLED)
    refused_or_done(["run", "two_balls", *SHORT, "--set", f"{key}={value}", "--at-most", "5s"])
