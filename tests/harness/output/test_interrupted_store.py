"""A study that is interrupted while it keeps a store, and goes on from it."""

import json
import os
import signal
import sqlite3
import subprocess
import sys
import time
from contextlib import closing

from autobalancer import Scene

GREEN = {"kind": "planar", "mass": 1.0, "stiffness": 1.0, "damping": 0.02, "unbalance": 0.01}
BALLS = {"name": "balls", "kind": "balls", "count": 2, "mass": 0.03267, "track_radius": 1.0,
         "drag": 0.001}  # fmt: skip


def kept(store) -> int:
    """Parts that a store holds."""
    if not store.exists():
        return 0
    try:
        with closing(sqlite3.connect(f"file:{store}?mode=ro", uri=True)) as base:
            return base.execute("select count(*) from outcome").fetchone()[0]
    except sqlite3.OperationalError:  # it is being made
        return 0


def test_motions_that_ctrl_c_ends_go_on_from_their_store_to_the_same_result(tmp_path, answering):
    scene = Scene(rotor=GREEN, balancer=[BALLS], speed=3.0).save(tmp_path / "green.toml")
    store, first, last = (tmp_path / name for name in ("kept.store", "first.json", "last.json"))
    line = [sys.executable, "-m", "autobalancer.harness", "motions", str(scene),
            "--speeds", "2", "4", "3", "--starts", "rest", "-n", "100"]  # fmt: skip
    group = subprocess.Popen(
        [*line, "--store", str(store)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        start_new_session=True, preexec_fn=answering,
    )  # fmt: skip
    try:
        while not kept(store) and group.poll() is None:
            time.sleep(0.01)
        os.killpg(group.pid, signal.SIGINT)
        _, errors = group.communicate(timeout=3000.0)
    finally:
        if group.poll() is None:
            os.killpg(group.pid, signal.SIGKILL)
            group.wait()
    assert (group.returncode, errors.strip()) == (130, "interrupted")
    assert 0 < kept(store) < 12
    for target, more in ((first, ["--store", str(store)]), (last, [])):
        ended = subprocess.run([*line, *more, "--json", str(target)], capture_output=True)
        assert ended.returncode == 0, ended.stderr
    assert kept(store) == 12
    assert json.loads(first.read_text()) == json.loads(last.read_text())
