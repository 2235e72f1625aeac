"""Pages of the reference: an introduction, and below it what the code says of itself.

    python -m tests.studies.reference

writes them into the checkout.  They stand in the repository so that they can be read where the
repository is; tests/harness/test_reference_pages.py fails when they are stale.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from ..scene.reference import reference
from . import commands, messages, python, units

FOLDER = Path(__file__).with_name("reference")
MARK = "<!-- The rest of this page is written by `python -m tests.studies.reference`. -->\n"


def pages(program: Any) -> dict[str, str]:
    """Text of every page by the name of its file, as it should be.

    Args:
        program: whose commands are described, a group of Click.
    """
    bodies: dict[str, Callable[[], str]] = {
        "scene": reference,
        "commands": lambda: commands.page(program),
        "messages": messages.page,
        "python": python.page,
        "units": units.page,
    }
    found = {}
    for name, body in bodies.items():
        text = (FOLDER / f"{name}.md").read_text(encoding="utf-8")
        introduction, _, _ = text.partition(MARK)
        found[f"{name}.md"] = f"{introduction}{MARK}\n{body().strip()}\n"
    return found


def write(program: Any) -> list[str]:
    """Write the pages that are stale; their names."""
    written = []
    for name, text in pages(program).items():
        if (FOLDER / name).read_text(encoding="utf-8") != text:
            (FOLDER / name).write_text(text, encoding="utf-8", newline="\n")
            written.append(name)
    return written
