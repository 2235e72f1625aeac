"""The table of what other tools make of the FMUs and packages.

python -m tests.studies.tools
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from autobalancer.harness.output.machine import machine
from autobalancer.harness.output.table import Sheet
from tests.studies.tools.measure import SCENE, TOOLS, Bench, every_run

STEPS = (5, 20, 40, 1000)


def main() -> None:
    """Print the table, and why something does not run."""
    rows, notes = [], []
    with tempfile.TemporaryDirectory(prefix="autobalancer-") as folder:
        bench = Bench(Path(folder))
        for tool, what in every_run():
            found = [bench.run(tool, what, steps) for steps in STEPS]
            errors = ["-" if one.error is None else f"{one.error:.1e}" for one in found]
            last = found[-1].seconds
            rows.append([tool.name, what, *errors, "-" if last is None else f"{1e6 * last:.0f} us"])
            notes += [f"{tool.name}, {what}: {found[0].said}"] if found[0].said else []
    columns = ("tool", "what", *(f"{n} steps" for n in STEPS), "a step")
    absent = ", ".join(tool.name for tool in TOOLS if not tool.present)
    print(f"{SCENE}\n\n{Sheet(columns, rows, 'll' + (len(columns) - 2) * 'r').markdown()}\n")
    print(*notes, f"Not on this machine: {absent or 'none'}", machine(), sep="\n")


if __name__ == "__main__":
    main()
