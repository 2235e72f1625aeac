"""A map killed at any moment: gone on with, it is byte for byte that of an undisturbed run.

python tests/harness/stability/test_map_killed.py [KILLS]    2,000 points, 200 also co-simulated
"""

from __future__ import annotations

import filecmp
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

CODE = "from autobalancer.harness.__main__ import main; main()"
TINY, SMALL = (10, 24), (50, 40)


def begin(store: Path, cosim: int, grid: tuple[int, int] = SMALL) -> subprocess.Popen[str]:
    axes = ["--x", f"speed=0.5:12:{grid[0]}", "--y", f"weights.drag=1e-4:1:{grid[1]}:log"]
    wanted = [*axes, "--cosim", str(cosim), "-o", str(store), "--at-most", "1d"]
    return subprocess.Popen(
        [sys.executable, "-c", CODE, "map", "filimonikhina", *wanted],
        env={**os.environ, "TMPDIR": str(store.parent)},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def files(store: Path) -> dict[str, Path]:
    return {str(p.relative_to(store)): p for p in store.rglob("*") if p.is_file()}


def worked_on(store: Path) -> dict[str, int]:
    """When the chunks of finished points were written [ns]."""
    done = {p.name for p in (store / "point_done" / "c").glob("*")}
    chunks = (store / "cosim_growth" / "c").glob("*")
    return {p.name: p.stat().st_mtime_ns for p in chunks if p.name in done}


def same(one: Path, other: Path) -> bool:
    theirs, ours = files(one), files(other)
    return theirs.keys() == ours.keys() and all(
        filecmp.cmp(theirs[name], ours[name], shallow=False) for name in ours
    )


def undisturbed(folder: Path, cosim: int, grid: tuple[int, int] = SMALL) -> tuple[Path, float]:
    """A map that is let alone, and its seconds."""
    store, begun = folder / "undisturbed.zarr", time.monotonic()
    run = begin(store, cosim, grid)
    said, _ = run.communicate()
    assert run.returncode == 0, said
    assert not cosim or "co-simulated points agree" in said, said
    return store, time.monotonic() - begun


def kill(run: subprocess.Popen[str], store: Path, moment: float | None) -> bool:
    """End a run after so many seconds, or when it has finished points; False: it was faster."""
    until, had = time.monotonic() + (moment or 600.0), worked_on(store)
    while run.poll() is None and time.monotonic() < until:
        if moment is None and worked_on(store).keys() > had.keys():
            break
        time.sleep(0.005)
    ended = run.poll() is None
    run.kill()
    return ended


def killed(
    right: Path, alone: float, cosim: int, kills: int, seed: int, grid: tuple[int, int] = SMALL
) -> int:
    """How many maps `kills` ends took, half of them at random; all maps are the `right` one."""
    draw, maps, kept, store = random.Random(seed), 0, 0, right.with_name("killed.zarr")
    while kills or store.exists():
        before = worked_on(store)
        run = begin(store, cosim, grid)
        if kills and kill(run, store, draw.uniform(0.2, 0.6 * alone) if kills % 2 else None):
            kills -= 1
            print(f"{kills} kills to come, {len(before)} points kept", flush=True)
        said, _ = run.communicate()  # also waits for the workers, which hold its output
        after = worked_on(store)
        assert {name: after[name] for name in before} == before  # nothing was done twice
        kept = max(kept, len(before))
        if run.returncode >= 0:
            assert run.returncode == 0, said
            assert same(right, store)
            shutil.rmtree(store)
            maps += 1
    assert kept
    return maps


FEW = 4  # co-simulated points


@pytest.fixture(scope="module")
def right(tmp_path_factory) -> tuple[Path, float]:
    pytest.importorskip("zarr")
    return undisturbed(tmp_path_factory.mktemp("maps"), FEW, TINY)


def test_a_killed_map_goes_on_to_the_same_bytes_and_does_nothing_twice(right):
    assert killed(*right, FEW, kills=2, seed=1, grid=TINY) >= 1


if __name__ == "__main__":
    times = int(sys.argv[1]) if sys.argv[1:] else 50
    with tempfile.TemporaryDirectory() as folder:
        maps = killed(*undisturbed(Path(folder), 200), 200, times, 1)
        print(f"{times} kills: {maps} maps, all the same bytes")
