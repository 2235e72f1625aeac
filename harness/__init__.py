"""Scenes, co-simulation, checks and reports.  Names are loaded when they are first used."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from importlib import import_module
from typing import TYPE_CHECKING, Any


def lazy_names(
    package: str, homes: Mapping[str, str]
) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """`__getattr__` and `__dir__` of a package whose public names load when they are first used.

    Importing a package must cost nothing to those who only have it installed.

    Args:
        package: its `__name__`.
        homes: relative module of every public name.
    """

    def get(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        value = getattr(import_module(homes[name], package), name)
        setattr(sys.modules[package], name, value)
        return value

    return get, lambda: sorted({*vars(sys.modules[package]), *homes})


if TYPE_CHECKING:
    from ..fmus.build import build
    from .checks.runner import check
    from .errors import SceneError, SimulationError, UnitError, UserError
    from .master.cosimulation import cosimulate
    from .master.result import Result
    from .scene import Scene, bundled_scenes, load_scene
    from .stability.boundaries import speeds

__all__ = [
    "Result",
    "Scene",
    "SceneError",
    "SimulationError",
    "UnitError",
    "UserError",
    "build",
    "bundled_scenes",
    "check",
    "cosimulate",
    "load_scene",
    "speeds",
]
__getattr__, __dir__ = lazy_names(
    __name__,
    {
        "Result": ".master.result",
        "Scene": ".scene",
        "SceneError": ".errors",
        "SimulationError": ".errors",
        "UnitError": ".errors",
        "UserError": ".errors",
        "build": "..fmus.build",
        "bundled_scenes": ".scene",
        "check": ".checks.runner",
        "cosimulate": ".master.cosimulation",
        "load_scene": ".scene",
        "speeds": ".stability.boundaries",
    },
)
