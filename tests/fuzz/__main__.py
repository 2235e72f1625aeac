"""Mangled scenes, assignments, command lines, interrupts: done or refused in words.

    python -m tests.fuzz KIND COUNT [FIRST]

Each is drawn from its number, the seed, and says it where it went wrong.
"""

from __future__ import annotations

import gc
import os
import random
import sys
import tempfile
from collections import Counter
from collections.abc import Callable
from functools import cache
from pathlib import Path

import typer

os.environ["OPENBLAS_NUM_THREADS"] = "1"  # a fork takes no threads along
os.environ["DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT"] = "3s"  # where no cluster is, none comes

from autobalancer.harness.master.plan import plan
from autobalancer.harness.master.unit_files import find_or_build
from autobalancer.harness.scene import bundled_scenes, load_scene
from tests.fuzz import lines, scenes
from tests.fuzz.judge import Wrong, refuse_wrong

LOADED = [  # by some command or other, which would otherwise load it anew each time
    *["matplotlib.backends.backend_agg", "matplotlib.backends.backend_svg", "scipy.stats"],
    *["matplotlib.backends.backend_pdf", "scipy.signal", "scipy.optimize", "scipy.integrate"],
    *["autobalancer.harness.master.run", "autobalancer.harness.stability.map_command"],
    *["autobalancer.harness.accuracy.precision.methods", "autobalancer.harness.checks.registry"],
    *["tomli_w", "rich.progress", "rich.table", "rich.markdown", "typer.rich_utils", "jinja2"],
]
WRONG = "wrong"
TOLD = 500  # cases between two words of progress
SHORT = ["--set", "run.revolutions=0.1"]
BRIEF = ["--at-most", "2s"]
ON_SCENE = [
    *[["run", *SHORT, *BRIEF]] * 40,
    ["rotor", *BRIEF],
    ["rotor", "--campbell", "c.png", "--response", "r.svg", "--range", "1", "50", *BRIEF],
    ["check", *BRIEF],
    ["build", "-o", "built", "--platform", "x86_64-linux"],
    ["build", "-o", "built", "--platform", "x86_64-linux", "--one-file", "--ssp"],
    ["build", "-o", "built", "--platform", "x86_64-linux", "--ssp"],
    ["speeds", "--range", "0.5", "5", "--method", "criterion,floquet", *BRIEF],
    ["map", "--x", "speed=0.5:9:2", "--y", "rotor.mass=0.5:2:2", "--csv", "m.csv", *BRIEF],
    ["balance", *BRIEF],
    ["scatter", "--vary", "rotor.mass=uniform(0.9,1.1)", "-n", "3", *BRIEF],
    ["run", *SHORT, *BRIEF, "--verify", "--json", "f.json"],
    ["run", *SHORT, *BRIEF, "-o", "s.csv", "--plot", "p.pdf", "--weights", "w.png"],
]


def a_scene(draw: random.Random, folder: Path) -> int:
    (folder / "given").mkdir()
    scenes.scene(draw, folder / "given/scene.toml")
    command, *options = draw.choice(ON_SCENE)
    return refuse_wrong([command, "given/scene.toml", *options], folder)


def an_assignment(draw: random.Random, folder: Path) -> int:
    some = [word for _ in range(draw.randint(1, 3)) for word in ("--set", scenes.assignment(draw))]
    command = draw.choice(["run", "run", "run", "rotor"])
    short = SHORT if command == "run" and draw.random() < 0.9 else []
    return refuse_wrong([command, draw.choice(lines.QUICK), *short, *some, *BRIEF], folder)


def a_command_line(draw: random.Random, folder: Path) -> int:
    lines.furnish(draw, folder)
    return refuse_wrong(lines.line(draw), folder)


def an_interrupt(draw: random.Random, folder: Path) -> int:
    lines.furnish(draw, folder)
    return refuse_wrong(lines.line(draw), folder, draw)


KINDS: dict[str, Callable[[random.Random, Path], int]] = {
    "scenes": a_scene,
    "assignments": an_assignment,
    "lines": a_command_line,
    "interrupts": an_interrupt,
}


@cache
def _prepare() -> None:
    """Do once what every command would do alike: half the time of most."""
    for module in LOADED:
        __import__(module)
    typer.main.get_command = cache(typer.main.get_command)
    lines.commands()
    for name in bundled_scenes():
        find_or_build(plan(load_scene(name)).units)
    gc.freeze()  # else the collector writes on every page that processes share


def _counted(codes: Counter[str]) -> str:
    return ", ".join(f"{n} times {code}" for code, n in sorted(codes.items()))


def many(kind: str, count: int, first: int) -> Counter[str]:
    """How many cases ended with which exit code, or were wrong: those are told as they come."""
    _prepare()
    codes: Counter[str] = Counter()
    for seed in range(first, first + count):
        if seed > first and (seed - first) % TOLD == 0:
            print(f"{kind} {first} to {seed - 1}: {_counted(codes)}", flush=True)
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name) / "here"
            folder.mkdir()
            try:
                codes[str(KINDS[kind](random.Random(seed), folder))] += 1
            except Wrong as error:
                codes[WRONG] += 1
                print(f"{kind} {seed}: {error}", flush=True)
    return codes


if __name__ == "__main__":
    if sys.argv[1:2] == [] or sys.argv[1] not in KINDS:
        raise SystemExit(f"{__doc__}\nKIND: {', '.join(KINDS)}")
    kind, count, first = sys.argv[1], int(sys.argv[2]), int((sys.argv[3:] or ["0"])[0])
    codes = many(kind, count, first)
    print(f"{kind} {first} to {first + count - 1}: {_counted(codes)}")
    raise SystemExit(codes[WRONG] > 0)
