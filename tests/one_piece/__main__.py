"""The composite against integrations of the same equations in one piece, at equal errors: in C, and
by SciPy with a right-hand side in plain numbers and in arrays.

python -m tests.one_piece
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from autobalancer.harness import load_scene
from autobalancer.harness.output.machine import machine
from autobalancer.harness.output.table import Sheet
from autobalancer.harness.precision.measure import TARGETS, precision
from autobalancer.harness.precision.methods import monolith_methods, one_file_methods
from tests.one_piece.in_arrays import solvers
from tests.one_piece.integrator import OnePiece

STEPS = tuple(round(4 * 1.12**k) for k in range(36))  # a revolution
ROUNDS = 9


def main() -> None:
    """Print times by error, and their ratios."""
    scene = load_scene("two_balls")
    with tempfile.TemporaryDirectory(prefix="autobalancer-") as folder:
        whole = OnePiece(scene, Path(folder))
        errors = {steps: whole.error(steps) for steps in dict.fromkeys(STEPS)}
        ways = one_file_methods() + one_file_methods(5) + monolith_methods()
        found = precision(scene, seconds=20.0, methods=ways)
        arrays = solvers(scene)
        rows, by_scipy = [], []
        for target in TARGETS:
            one = found.cheapest(target, coupled=True, one_file=True)
            steps = next((n for n, error in errors.items() if error <= target), None)
            if one is None or one.seconds is None or steps is None:
                continue
            seconds = min(whole.seconds(steps) for _ in range(ROUNDS))
            chosen = (f"{steps} steps", f"{one.method.family}, {one.method.setting}")
            times = (f"{1e3 * seconds:.3f}", f"{1e3 * one.seconds:.3f}")
            rows.append([f"{target:g}", *chosen, *times, f"{one.seconds / seconds:.1f}"])
            plain = found.cheapest(target, coupled=False)
            _, slow, how = min((a for a in arrays if a[0] <= target), key=lambda a: a[1])
            if plain is None or plain.seconds is None:
                continue
            fast = f"{plain.method.name.removeprefix('monolith ')}, {plain.method.setting}"
            times = (f"{1e3 * plain.seconds:.2f}", f"{1e3 * slow:.1f}")
            ratios = (f"{s / one.seconds:.0f}" for s in (plain.seconds, slow))
            by_scipy.append([f"{target:g}", fast, how, *times, *ratios])
    columns = ("error", "in one piece in C", "composite", "ms", "ms", "ratio")
    print(f"{scene.name}\n\n{Sheet(columns, rows, 'lllrrr').markdown()}\n")
    columns = ("error", "SciPy, plain numbers", "SciPy, arrays", "ms", "ms", "times", "times")
    print(f"{Sheet(columns, by_scipy, 'lllrrrr').markdown()}\n\n{machine()}")


if __name__ == "__main__":
    main()
