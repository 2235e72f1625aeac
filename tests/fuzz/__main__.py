"""Mangled scenes, command lines, interrupts: done or refused in words.

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
from tests.fuzz import lines
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


def run_scene(draw: random.Random, folder: Path) -> int:
    """A command on a mangled scene."""
    lines.furnish(draw, folder)
    return refuse_wrong(lines.line(draw, "given/scene.toml"), folder)


def run_line(draw: random.Random, folder: Path) -> int:
    """Any command line."""
    lines.furnish(draw, folder)
    return refuse_wrong(lines.line(draw), folder)


def interrupt_line(draw: random.Random, folder: Path) -> int:
    """Any command line, with a signal at some moment."""
    lines.furnish(draw, folder)
    return refuse_wrong(lines.line(draw), folder, draw)


KINDS: dict[str, Callable[[random.Random, Path], int]] = {
    "scenes": run_scene,
    "lines": run_line,
    "interrupts": interrupt_line,
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
