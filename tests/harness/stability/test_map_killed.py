"""A map that is killed continues to the same outcomes as an undisturbed one."""

from __future__ import annotations

import os
import sqlite3
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
    line = ["map", "filimonikhina", "--x", X, "--y", Y, "--store", str(store)]
    return subprocess.Popen(
        [sys.executable, "-c", CODE, *line],
        env={**os.environ, "TMPDIR": str(store.parent)},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def stored(store: Path) -> dict[int, bytes]:
    """Outcomes by number."""
    if not store.exists():
        return {}
    with sqlite3.connect(store) as file:
        begun = file.execute("SELECT * FROM sqlite_master WHERE name = 'outcome'").fetchall()
        rows = file.execute("SELECT item, value FROM outcome").fetchall() if begun else []
    return dict(rows)


def finished_strips(store: Path) -> set[int]:
    """Numbers of the strips that are finished."""
    return set(stored(store))


def test_a_killed_map_continues_to_the_same_outcomes_and_does_nothing_twice(tmp_path):
    right, store = tmp_path / "undisturbed", tmp_path / "killed"
    load_scene("filimonikhina").map(X, Y, store=right)
    run = begin(store)
    while not finished_strips(store) and run.poll() is None:
        time.sleep(0.005)
    run.kill()
    run.communicate()  # also waits for the workers, which hold its output
    before = finished_strips(store)
    assert before
    with sqlite3.connect(store) as file:  # what is written again takes another row
        rows = dict(file.execute("SELECT item, rowid FROM outcome"))
    run = begin(store)
    said, _ = run.communicate()
    assert run.returncode == 0, said
    with sqlite3.connect(store) as file:
        after = dict(file.execute("SELECT item, rowid FROM outcome"))
    assert len(after) == 40
    assert {item: after[item] for item in rows} == rows
    assert stored(store) == stored(right)
