"""Tables of the manual's results: what a command prints, with the command, the day and the machine.

`python -m tests.studies.tables [NAME...]` writes NAME.md, or all, in harness/manual/results/tables.
"""

from __future__ import annotations

import re
import subprocess
import sys
from datetime import date
from pathlib import Path
from tempfile import TemporaryDirectory

from autobalancer.harness.output.machine import machine

FOLDER = Path(__file__).parents[2] / "harness" / "manual" / "results" / "tables"
FILE = "FILE"  # what a command writes; else its output counts
COMMANDS = {
    "precision_two_balls": "autobalancer precision two_balls --markdown FILE",
    "precision_run_up": "autobalancer precision run_up --markdown FILE",
    "stress": "autobalancer stress --markdown FILE",
    "omissions": "python -m tests.studies.omissions",
    "tools": "python -m tests.studies.tools",
    "bristol_quantities": "python -m tests.studies.rig.quantities",
    "bristol_variants": "python -m tests.studies.rig",
    "bristol_check": "python -m tests.studies bristol_check",
    "one_piece": "python -m tests.studies one_piece",
    "run_time": "python -m tests.studies run_time",
}


def write(name: str) -> None:
    """Run a table's command, and replace all below the title of its page."""
    path = FOLDER / f"{name}.md"
    title = re.search(r"^# .*$", path.read_text(encoding="utf-8"), re.MULTILINE)
    assert title is not None, f"{path}: has no title"
    with TemporaryDirectory() as folder:
        made = Path(folder) / "table.md"
        program, *arguments = COMMANDS[name].replace(FILE, str(made)).split()
        module = ["-m", "autobalancer.harness"] if program == "autobalancer" else []
        done = subprocess.run(
            [sys.executable, *module, *arguments], stdout=subprocess.PIPE, encoding="utf-8"
        )
        assert done.returncode == 0, f"{COMMANDS[name]}: exit code {done.returncode}"
        text = made.read_text(encoding="utf-8") if FILE in COMMANDS[name] else done.stdout
    head = f"---\nsearch:\n  exclude: true\n---\n\n{title[0]}\n\nOutput of `{COMMANDS[name]}`, "
    path.write_text(f"{head}{date.today()}, on {machine()}.\n\n{text}", encoding="utf-8")


if __name__ == "__main__":
    for each in sys.argv[1:] or COMMANDS:
        write(each)
