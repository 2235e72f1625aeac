"""What a result was made on."""

from __future__ import annotations

import platform
from importlib.metadata import version
from pathlib import Path

VERSION = version("autobalancer")  # as pyproject.toml says it
PACKAGES = ("numpy", "scipy", "fmpy", "pythonfmu")


def machine() -> str:
    """Processor, Python and the versions that matter."""
    processor = platform.processor() or platform.machine()
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                processor = line.partition(":")[2].strip()
                break
    except OSError:
        pass
    versions = ", ".join(f"{name} {version(name)}" for name in PACKAGES)
    return f"{processor}; Python {platform.python_version()}, {versions}"


def program_version() -> str:
    """Name and version of this program."""
    return f"autobalancer {VERSION}"
