"""Scenes, co-simulation, checks and reports.  Names are loaded when they are first used."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ..fmus.build import build
    from .boundaries import speeds
    from .checking import check
    from .errors import SceneError, SimulationError, UnitError, UserError
    from .master import cosimulate
    from .result import Result
    from .scene import Scene, bundled_scenes, load_scene

# importing the package must cost nothing to those who only have it installed
_HOME = {
    "Result": ".result",
    "Scene": ".scene",
    "SceneError": ".errors",
    "SimulationError": ".errors",
    "UnitError": ".errors",
    "UserError": ".errors",
    "build": "..fmus.build",
    "bundled_scenes": ".scene",
    "check": ".checking",
    "cosimulate": ".master",
    "load_scene": ".scene",
    "speeds": ".boundaries",
}

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


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(_HOME[name], __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
