"""What is mangled is done, or refused in words; many more by `python -m tests.fuzz KIND COUNT`."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

COUNTS = {
    "scenes": 60,
    "assignments": 60,
    "lines": 15,
    "interrupts": 8,
    "fmus": 40,
    "states": 40,
}


@pytest.mark.skipif(not hasattr(os, "fork"), reason="commands run in forks")
@pytest.mark.parametrize("kind", COUNTS)
def test_what_is_mangled_is_done_or_refused(tmp_path, kind):
    ended = subprocess.run(
        [sys.executable, "-m", "tests.fuzz", kind, str(COUNTS[kind])],
        cwd=Path(__file__).parents[2],
        env={**os.environ, "TMPDIR": str(tmp_path)},
        stdout=subprocess.PIPE,
        text=True,
    )
    assert ended.returncode == 0, ended.stdout
    assert not list(tmp_path.iterdir())
