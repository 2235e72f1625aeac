"""Names of a package that load when they are first used.

Importing a package must cost nothing to those who only have it installed, and the declarations of a
unit serve those who have neither NumPy nor pythonfmu.
"""

from __future__ import annotations

import gc
import re
import sys
from collections.abc import Callable, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any


def lazy_names(
    package: str, homes: Mapping[str, str]
) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """`__getattr__` and `__dir__` of a package.

    Args:
        package: its `__name__`.
        homes: module of every public name, relative or not; after a colon its name there.
    """

    def get(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        home, _, there = homes[name].partition(":")
        value = getattr(_imported(home, package), there or name)
        setattr(sys.modules[package], name, value)
        return value

    return get, lambda: sorted({*vars(sys.modules[package]), *homes})


def _imported(home: str, package: str) -> Any:
    """The module, imported without a search for garbage.

    What an import makes stays, and two searches through all of it take a tenth of a start.  So it
    goes to the oldest generation at once: that is where `unfreeze` puts what `freeze` took.
    """
    collects = gc.isenabled()
    gc.disable()
    try:
        return import_module(home, package)
    finally:
        if collects:
            if not gc.get_freeze_count():  # what the program froze stays frozen
                gc.freeze()
                gc.unfreeze()
            gc.enable()


def names_in(stub: Path) -> dict[str, str]:
    """`homes` of a stub file, which has lines `from MODULE import NAME as NAME` alone."""
    lines = re.findall(
        r"^from (\S+) import (\w+) as (\w+)$", stub.read_text(encoding="utf-8"), re.MULTILINE
    )
    return {name: f"{home}:{there}" for home, there, name in lines}
