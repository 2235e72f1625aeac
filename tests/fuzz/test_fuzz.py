"""What is mangled is done, or refused in words; many more by `python -m tests.fuzz KIND COUNT`."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

# of each kind how many, from which on; the line before the fourth waits 10 s for a cluster;
# interrupts: lines that do not end before they are told to
DRAWN = {
    "scenes": (30, 0),
    "assignments": (40, 0),
    "lines": (12, 4),
    "interrupts": (5, 40),
    "fmus": (20, 0),
    "states": (25, 0),
}
CODE = f"""
from tests.fuzz.__main__ import WRONG, many
wrong = [many(kind, *counts)[WRONG] for kind, counts in {DRAWN}.items()]
raise SystemExit(sum(wrong) > 0)
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="commands run in forks")
def test_what_is_mangled_is_done_or_refused(tmp_path):
    ended = subprocess.run(
        [sys.executable, "-c", CODE],
        cwd=Path(__file__).parents[2],
        env={**os.environ, "TMPDIR": str(tmp_path)},
        stdout=subprocess.PIPE,
        text=True,
    )
    assert ended.returncode == 0, ended.stdout
    assert not list(tmp_path.iterdir())
