"""Mangled scenes, command lines, interrupts: done or refused in words.

    python -m tests.studies.fuzz KIND COUNT [FIRST]

Each is drawn from its number, the seed, and says it where it went wrong.
"""

from __future__ import annotations

import os
import random
import sys
import tempfile
from collections import Counter
from pathlib import Path

os.environ["DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT"] = "3s"  # where no cluster is, none comes

from tests.studies.fuzz import lines
from tests.studies.fuzz.judge import Wrong, refuse_wrong

KINDS = ("scenes", "lines", "interrupts")
WRONG = "wrong"


def run(kind: str, seed: int) -> int:
    """Exit code of a command on a mangled scene, of any command, or of one that is interrupted.

    Raises:
        Wrong: see `refuse_wrong`.
    """
    draw = random.Random(seed)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "here"
        folder.mkdir()
        lines.furnish(draw, folder)
        line = lines.line(draw, "given/scene.toml" if kind == "scenes" else "")
        return refuse_wrong(line, folder, draw if kind == "interrupts" else None)


def many(kind: str, count: int, first: int) -> Counter[str]:
    """How many cases ended with which exit code, or were wrong: those are printed as they come."""
    codes: Counter[str] = Counter()
    for seed in range(first, first + count):
        try:
            codes[str(run(kind, seed))] += 1
        except Wrong as error:
            codes[WRONG] += 1
            print(f"{kind} {seed}: {error}", flush=True)
    return codes


if __name__ == "__main__":
    if sys.argv[1:2] == [] or sys.argv[1] not in KINDS:
        raise SystemExit(f"{__doc__}\nKIND: {', '.join(KINDS)}")
    kind, count, first = sys.argv[1], int(sys.argv[2]), int((sys.argv[3:] or ["0"])[0])
    codes = many(kind, count, first)
    counted = ", ".join(f"{n} times {code}" for code, n in sorted(codes.items()))
    print(f"{kind} {first} to {first + count - 1}: {counted}")
    raise SystemExit(codes[WRONG] > 0)
