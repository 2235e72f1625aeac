"""Writes the pages of the reference that are stale: `python -m tests.studies.reference`."""

from __future__ import annotations

from typer.main import get_command

from autobalancer.harness.__main__ import program
from autobalancer.harness.manual.reference import write


def main() -> None:
    """Write the pages and say which have changed."""
    print("written:", ", ".join(write(get_command(program()))) or "none, all are up to date")


if __name__ == "__main__":
    main()
