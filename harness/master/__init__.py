"""A scene's FMUs, coupled and stepped."""

from typing import TYPE_CHECKING

from ...fmus.lazy import lazy_names

if TYPE_CHECKING:
    from .cosimulation import CoSimulation
    from .run import cosimulate

__all__ = ["CoSimulation", "cosimulate"]
__getattr__, __dir__ = lazy_names(__name__, {"CoSimulation": ".cosimulation", "cosimulate": ".run"})
