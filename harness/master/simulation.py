"""What the two engines have in common: `CoSimulation` of separate FMUs, `OneFileRun` in C."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, TypeAlias

from ..errors import SceneError
from ..scene import Scene
from ..scene.run import UNCORRECTED
from .recorder import Signal

if TYPE_CHECKING:
    from .cosimulation import CoSimulation
    from .one_file_run import OneFileRun

Simulation: TypeAlias = "CoSimulation | OneFileRun"


class Repeated(NamedTuple):
    """A first run to be repeated in finer steps.

    Attributes:
        times: its communication points [s].
        parts: of each of its steps.
        residual: what may stay in the loop, over what may stay in the first run.
    """

    times: Signal
    parts: int
    residual: float


def refuse_loose_tolerance(scene: Scene) -> None:
    """Raise SceneError where a tolerance is asked of a scheme or an order that cannot keep it."""
    coupling = scene.coupling
    if coupling.tolerance is None:
        return
    if coupling.scheme in UNCORRECTED or coupling.order < 3:
        raise SceneError(
            f"{scene.name}: coupling.tolerance = {coupling.tolerance:g}: kept only by scheme "
            f'"iterated" or "auto" with order 3, not by "{coupling.scheme}" with order '
            f"{coupling.order}; give steps_per_rev instead"
        )
