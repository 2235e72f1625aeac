"""Tables of the manual that no command prints: `python -m tests.studies NAME` prints Markdown."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import replace
from itertools import product

import autobalancer as ab
from autobalancer.harness.accuracy.precision.report import cheapest
from autobalancer.harness.checks.report import text
from autobalancer.harness.output.table import Sheet
from autobalancer.models.readable import rounded

SCENES = ("two_balls", "three_mass_shaft", "two_plane_rodrigues", "drum", "balls_and_liquid")
SECONDS = 60.0  # of measuring, per scene
ROUNDS = 5  # of which the fastest counts
CHOICES: dict[str, tuple[dict[str, object], dict[str, bool]]] = {
    "`tolerance = 1e-3`": ({"coupling.tolerance": 1e-3}, {}),
    "`tolerance = 1e-6`": ({"coupling.tolerance": 1e-6}, {}),
    "`--separate`": ({}, {"separate": True}),
    "`steps_per_rev = 40`": ({"coupling.steps_per_rev": 40}, {}),
    '`units = "python"`, 40 steps': (
        {"coupling.steps_per_rev": 40, "coupling.units": "python"},
        {},
    ),
}


def one_piece() -> Sheet:
    """Cheapest way to an error: one file, separate FMUs, SciPy on one system."""
    tables = [cheapest(ab.load(name).precision(SECONDS)) for name in (*SCENES, "liquid_disc")]
    return replace(tables[0], rows=[row for each in tables for row in each.rows])


def bristol_check() -> Sheet:
    """Every row of the measured rig."""
    rows = [
        (
            each.quantity,
            text(each.expected, 4),
            text(each.measured, 4),
            "-" if each.error is None else f"{each.error:.1%}",
            "-" if each.tolerance is None else f"{each.tolerance:.0%}",
            "yes" if each.holds else "**NO**",
        )
        for each in ab.load("bristol").check().rows
    ]
    columns = ("quantity", "rig or authors", "co-simulated", "error", "tolerance", "holds")
    return Sheet(columns, rows, "lrrrrl")


def run_time() -> Sheet:
    """Processor time of `scene.run()` by what is chosen, over that with the default tolerance."""
    rows = []
    for name, choice in product(SCENES, CHOICES):
        scene = ab.load(name).replace({"coupling.tolerance": 1e-4})
        changes, options = CHOICES[choice]
        base = _fastest(scene.run)
        changed = scene.replace(changes)
        spent = _fastest(lambda changed=changed, options=options: changed.run(**options))
        times = rounded(1e3 * base, 3), rounded(1e3 * spent, 3), rounded(spent / base, 2)
        rows.append((name, choice, *times))
    return Sheet(("scene", "choice", "default [ms]", "chosen [ms]", "ratio"), rows, "llrrr")


def _fastest(run: Callable[[], object]) -> float:
    """Processor seconds of the fastest of some runs, loading left out."""
    run()
    spent = []
    for _ in range(ROUNDS):
        start = time.process_time()
        run()
        spent.append(time.process_time() - start)
    return min(spent)


STUDIES = {study.__name__: study for study in (one_piece, bristol_check, run_time)}

if __name__ == "__main__":
    print(STUDIES[sys.argv[1]]().markdown())
