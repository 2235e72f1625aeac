"""A map that is killed continues to the same bytes as an undisturbed one."""

from __future__ import annotations

import filecmp
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from autobalancer.harness import load_scene

pytestmark = pytest.mark.slow

CODE = "from autobalancer.harness.__main__ import main; main()"
X, Y, POINTS = "speed=0.5:12:6", "weights.drag=1e-4:1:9:log", 4


def begin(store: Path) -> subprocess.Popen[str]:
    line = ["map", "filimonikhina", "--x", X, "--y", Y, "--cosim", str(POINTS), "-o", str(store)]
    return subprocess.Popen(
        [sys.executable, "-c", CODE, *line],
        env={**os.environ, "TMPDIR": str(store.parent)},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def files(store: Path) -> dict[str, Path]:
    return {str(p.relative_to(store)): p for p in store.rglob("*") if p.is_file()}


def finished_points(store: Path) -> dict[str, int]:
    """When the chunks of finished points were written [ns]."""
    done = {p.name for p in (store / "point_done" / "c").glob("*")}
    chunks = (store / "cosim_growth" / "c").glob("*")
    return {p.name: p.stat().st_mtime_ns for p in chunks if p.name in done}


def test_a_killed_map_continues_to_the_same_bytes_and_does_nothing_twice(tmp_path):
    pytest.importorskip("zarr")
    right, store = tmp_path / "undisturbed.zarr", tmp_path / "killed.zarr"
    load_scene("filimonikhina").map(X, Y, cosim=POINTS, store=right)
    run, limit = begin(store), time.monotonic() + 300.0
    while not finished_points(store) and time.monotonic() < limit:
        time.sleep(0.005)
    run.kill()
    run.communicate()  # also waits for the workers, which hold its output
    before = finished_points(store)
    assert before
    run = begin(store)
    said, _ = run.communicate()
    assert run.returncode == 0, said
    after = finished_points(store)
    assert len(after) == POINTS
    assert {name: after[name] for name in before} == before
    ours, theirs = files(store), files(right)
    assert ours.keys() == theirs.keys()
    assert all(filecmp.cmp(theirs[name], ours[name], shallow=False) for name in ours)
