"""Names of a package that load when they are first used.

The declarations of a unit serve those who have neither NumPy nor pythonfmu: importing its package
must not load its equations.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any


def loaded_from(package: str, homes: dict[str, str]) -> Callable[[str], Any]:
    """`__getattr__` of a package: public name -> relative module that has it."""

    def get(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(import_module(homes[name], package), name)

    return get
