"""The composite against integrations of the same equations in one piece, at equal errors: in C, and
by SciPy.

python -m tests.one_piece
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from autobalancer.harness import Scene, load_scene
from autobalancer.harness.accuracy.precision.measure import TARGETS, Point, precision
from autobalancer.harness.accuracy.precision.methods import one_file_methods
from autobalancer.harness.output.machine import machine
from autobalancer.harness.output.table import Sheet
from tests.one_piece.integrator import OnePiece
from tests.one_piece.solvers import WAYS, solvers

STEPS = tuple(round(4 * 1.12**k) for k in range(36))  # a revolution
ROUNDS = 9
Cells = list[list[str]]


def main() -> None:
    """Print times by error, and their ratios."""
    scene = load_scene("two_balls")
    found = precision(scene, seconds=20.0, methods=one_file_methods() + one_file_methods(5))
    ones = {target: found.cheapest(target, coupled=True, one_file=True) for target in TARGETS}
    reached = {target: one for target, one in ones.items() if one is not None and one.seconds}
    columns = ("error", "composite", "ms", "in C", "ms", "ratio")
    in_c = Sheet(columns, _in_c(scene, reached), "llrlrr")
    columns = ("error", "SciPy", "method", "ms", "times the composite's")
    by_scipy = Sheet(columns, _by_scipy(scene, reached), "lllrr")
    print(scene.name, in_c.markdown(), by_scipy.markdown(), machine(), sep="\n\n")


def _in_c(scene: Scene, reached: dict[float, Point]) -> Cells:
    with tempfile.TemporaryDirectory(prefix="autobalancer-") as folder:
        whole = OnePiece(scene, Path(folder))
        errors = {steps: whole.error(steps) for steps in dict.fromkeys(STEPS)}
        rows = []
        for target, one in reached.items():
            steps = next(n for n, error in errors.items() if error <= target)
            seconds = min(whole.seconds(steps) for _ in range(ROUNDS))
            said = f"{one.method.family}, {one.method.setting}"
            times = (f"{1e3 * one.seconds:.3f}", f"{steps} steps", f"{1e3 * seconds:.3f}")
            rows.append([f"{target:g}", said, *times, f"{one.seconds / seconds:.1f}"])
    return rows


def _by_scipy(scene: Scene, reached: dict[float, Point]) -> Cells:
    rows = []
    for way in WAYS:
        every = solvers(scene, way)
        for target, one in reached.items():
            best = min((s for s in every if s.error <= target), key=lambda s: s.seconds)
            times = (f"{1e3 * best.seconds:.2f}", f"{best.seconds / one.seconds:.0f}")
            rows.append([f"{target:g}", way.said, best.method, *times])
    return rows


if __name__ == "__main__":
    main()
