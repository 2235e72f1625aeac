"""The composite against an integration of the same equations in one piece in C, at equal errors.

python -m tests.one_piece
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from autobalancer.harness import load_scene
from autobalancer.harness.output.machine import machine
from autobalancer.harness.output.table import Sheet
from autobalancer.harness.precision.measure import TARGETS, precision
from autobalancer.harness.precision.methods import one_file_methods
from tests.one_piece.integrator import OnePiece

STEPS = tuple(round(4 * 1.12**k) for k in range(36))  # a revolution
ROUNDS = 9


def main() -> None:
    """Print times by error, and their ratios."""
    scene = load_scene("two_balls")
    with tempfile.TemporaryDirectory(prefix="autobalancer-") as folder:
        whole = OnePiece(scene, Path(folder))
        errors = {steps: whole.error(steps) for steps in dict.fromkeys(STEPS)}
        ways = one_file_methods() + one_file_methods(5)
        found = precision(scene, seconds=20.0, methods=ways)
        rows = []
        for target in TARGETS:
            one = found.cheapest(target, coupled=True, one_file=True)
            steps = next((n for n, error in errors.items() if error <= target), None)
            if one is None or one.seconds is None or steps is None:
                continue
            seconds = min(whole.seconds(steps) for _ in range(ROUNDS))
            chosen = (f"{steps} steps", f"{one.method.family}, {one.method.setting}")
            times = (f"{1e3 * seconds:.3f}", f"{1e3 * one.seconds:.3f}")
            rows.append([f"{target:g}", *chosen, *times, f"{one.seconds / seconds:.1f}"])
    columns = ("error", "in one piece in C", "composite", "ms", "ms", "ratio")
    print(f"{scene.name}\n\n{Sheet(columns, rows, 'lllrrr').markdown()}\n\n{machine()}")


if __name__ == "__main__":
    main()
