"""Mangled scenes, assignments, command lines, FMUs and states: done, or refused in words.

No traceback, no exit code but 0, 1 and 2, and no end by a signal.  Many more than below:

    python tests/harness/test_fuzz.py KIND COUNT [FIRST]
"""

from __future__ import annotations

import io
import os
import random
import subprocess
import sys
import tempfile
import traceback
import zipfile
from collections.abc import Callable
from functools import cache
from pathlib import Path

import fmpy
import pytest
from fmpy import fmi2
from fmpy.fmi1 import FMICallException
from typer.testing import CliRunner

from autobalancer.fmus.build import build
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


def a_scene(draw: random.Random, folder: Path) -> None:
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
    path = folder / "mangled.toml"
    path.write_text("\n".join(lines), encoding="utf-8")
    refused_or_done(["run", str(path), *SHORT, "--at-most", "5s"])


def a_command_line(draw: random.Random, folder: Path) -> None:
    os.chdir(folder)
    words = draw.choices(WORDS, k=draw.randint(1, 8))
    if "check" in words[:1]:
        words[0] = "run"  # all scenes: minutes
    if words[:1] == ["build"]:
        words += ["nowhere"]
    refused_or_done(words)


def an_assignment(draw: random.Random, _folder: Path) -> None:
    keys = ["rotor.mass", "rotor.stiffness", "rotor.unbalance", "weights.drag", "weights.mass"]
    keys += ["weights.angles", "operation.speed", "run.initial.x", "coupling.order", "title"]
    key, value = draw.choice(keys), draw.choice(MANGLED)
    refused_or_done(["run", "two_balls", *SHORT, "--set", f"{key}={value}", "--at-most", "5s"])


@cache
def _built(unit: str, **sizes: int) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        return build(unit, folder, platforms=[fmpy.platform_tuple], **sizes).read_bytes()


def _flipped(draw: random.Random, data: bytes) -> bytes:
    """Some bytes changed, a part gone, or a part twice."""
    changed, kind = bytearray(data), draw.random()
    first, last = sorted(draw.sample(range(len(data)), 2))
    if kind < 0.6:
        for _ in range(draw.choice((1, 1, 10))):
            changed[draw.randrange(len(data))] = draw.randrange(256)
    elif kind < 0.8:
        del changed[first : last if draw.random() < 0.5 else None]
    else:
        changed[first:first] = data[first:last]
    return bytes(changed)


def an_fmu(draw: random.Random, folder: Path) -> None:
    fmus = {"RotorOnSupports": _built("RotorOnSupports")}
    fmus["BallBalancer-weights-2"] = _built("BallBalancer", weights=2)
    name = draw.choice(list(fmus))
    if draw.random() < 0.5:
        fmus[name] = _flipped(draw, fmus[name])
    else:  # an archive that is sound, with a file that is not
        with zipfile.ZipFile(io.BytesIO(fmus[name])) as archive:
            files = {one: archive.read(one) for one in archive.namelist()}
        damaged = draw.choice([one for one in files if files[one][1:]])
        files[damaged] = _flipped(draw, files[damaged])
        whole = io.BytesIO()
        with zipfile.ZipFile(whole, "w") as archive:
            for one, data in files.items():
                archive.writestr(one, data)
        fmus[name] = whole.getvalue()
    for one, data in fmus.items():
        (folder / f"{one}.fmu").write_bytes(data)
    refused_or_done(["run", "two_balls", *SHORT, "--fmus", str(folder)])


def a_state(draw: random.Random, folder: Path) -> None:
    """A damaged state is refused, or the unit steps on from it; it does not end the process."""
    path = folder / "balls.fmu"
    path.write_bytes(_built("BallBalancer", weights=2))
    description = fmpy.read_model_description(str(path))
    unit = fmi2.FMU2Slave(
        guid=description.guid,
        unzipDirectory=fmpy.extract(str(path), str(folder / "unpacked")),
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="balls",
    )
    unit.instantiate()
    try:
        unit.setupExperiment()
        unit.enterInitializationMode()
        unit.exitInitializationMode()
        unit.doStep(0.0, 1e-3)
        state = unit.getFMUstate()
        data = unit.serializeFMUstate(state)
        try:
            unit.setFMUstate(unit.deSerializeFMUstate(_flipped(draw, data)))
            unit.doStep(1e-3, 1e-3)
        except FMICallException:
            unit.setFMUstate(state)
            unit.doStep(1e-3, 1e-3)
    finally:
        unit.freeInstance()


KINDS: dict[str, tuple[Callable[[random.Random, Path], None], int]] = {
    "scenes": (a_scene, 60),
    "lines": (a_command_line, 60),
    "assignments": (an_assignment, 60),
    "fmus": (an_fmu, 40),
    "states": (a_state, 40),
}


@pytest.mark.parametrize(
    ("kind", "seed"), [(kind, seed) for kind, (_, count) in KINDS.items() for seed in range(count)]
)
def test_what_is_mangled_is_done_or_refused(tmp_path, monkeypatch, kind, seed):
    monkeypatch.chdir(tmp_path)
    KINDS[kind][0](random.Random(seed), tmp_path)


def _some(kind: str, first: int, count: int) -> int:
    """How many seeds did wrong, told on the way."""
    wrong = 0
    for seed in range(first, first + count):
        with tempfile.TemporaryDirectory() as folder:
            try:
                KINDS[kind][0](random.Random(seed), Path(folder))
            except Exception:
                wrong += 1
                print(f"{kind} {seed}: {traceback.format_exc(limit=-2)}", flush=True)
            os.chdir("/")
    return wrong


def _many(kind: str, count: int, first: int) -> int:
    """Some at a time in a process of their own, so that its end by a signal is seen."""
    wrong = 0
    for start in range(first, first + count, 100):
        here = min(100, first + count - start)
        code = f"import runpy; f = runpy.run_path({os.path.abspath(__file__)!r})['_some']"
        end = f"raise SystemExit(f({kind!r}, {start}, {here}) > 0)"
        ended = subprocess.run([sys.executable, "-c", f"{code}; {end}"])
        if ended.returncode:
            wrong += 1
            print(
                f"{kind} {start} to {start + here - 1}: ended with {ended.returncode}", flush=True
            )
    return wrong


if __name__ == "__main__":
    kind, count, first = sys.argv[1], int(sys.argv[2]), int((sys.argv[3:] or [0])[0])
    hundreds = _many(kind, count, first)
    print(f"{kind} {first} to {first + count - 1}: {hundreds} hundreds with something wrong")
    raise SystemExit(hundreds > 0)
