"""C sources into a shared library, by the C compiler of this machine or another one."""

from __future__ import annotations

import subprocess
from collections.abc import Sequence
from pathlib import Path

FLAGS = (
    *("-std=c99", "-O1", "-ffp-contract=off", "-fno-math-errno", "-shared", "-fPIC"),
    *("-Wall", "-Wextra", "-Wno-unused-parameter", "-Wpedantic", "-Werror"),
)


def shared_library(
    files: Sequence[str], destination: Path, *flags: str, compiler: Sequence[str] = ("cc",)
) -> Path:
    """Compile; `flags` are added to `FLAGS`, and win over them."""
    subprocess.run([*compiler, *FLAGS, *flags, *files, "-o", str(destination)], check=True)
    return destination
