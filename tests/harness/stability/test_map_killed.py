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
X, Y = "weights.mass=1e-3:6e-3:8", "weights.drag=1e-4:1:40:log"  # 40 strips


def begin(store: Path) -> subprocess.Popen[str]:
    line = ["map", "filimonikhina", "--x", X, "--y", Y, "-o", str(store)]
    return subprocess.Popen(
        [sys.executable, "-c", CODE, *line],
        env={**os.environ, "TMPDIR": str(store.parent)},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def files(store: Path) -> dict[str, Path]:
    return {str(p.relative_to(store)): p for p in store.rglob("*") if p.is_file()}


def finished_strips(store: Path) -> dict[str, int]:
    """When the chunks of finished strips were written [ns]."""
    done = {p.name for p in (store / "strip_done" / "c").glob("*")}
    chunks = (store / "growth" / "c").glob("*")
    return {p.name: p.stat().st_mtime_ns for p in chunks if p.name in done}


def test_a_killed_map_continues_to_the_same_bytes_and_does_nothing_twice(tmp_path):
    pytest.importorskip("zarr")
    right, store = tmp_path / "undisturbed.zarr", tmp_path / "killed.zarr"
    load_scene("filimonikhina").map(X, Y, store=right)
    run, limit = begin(store), time.monotonic() + 300.0
    while not finished_strips(store) and time.monotonic() < limit:
        time.sleep(0.005)
    run.kill()
    run.communicate()  # also waits for the workers, which hold its output
    before = finished_strips(store)
    assert before
    run = begin(store)
    said, _ = run.communicate()
    assert run.returncode == 0, said
    after = finished_strips(store)
    assert len(after) == 40
    assert {name: after[name] for name in before} == before
    ours, theirs = files(store), files(right)
    assert ours.keys() == theirs.keys()
    assert all(filecmp.cmp(theirs[name], ours[name], shallow=False) for name in ours)
