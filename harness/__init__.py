"""Scenes, co-simulation, checks and reports.  Names are loaded when they are first used."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..fmus.lazy import lazy_names

if TYPE_CHECKING:
    from ..fmus.build import build
    from .checks.runner import check
    from .errors import SceneError, SimulationError, UnitError, UserError
    from .master.many import cosimulate_many
    from .master.result import Result
    from .master.run import cosimulate
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
    "cosimulate_many",
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
        "cosimulate": ".master.run",
        "cosimulate_many": ".master.many",
        "load_scene": ".scene",
        "speeds": ".stability.boundaries",
    },
)
