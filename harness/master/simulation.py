"""What steps a scene: `CoSimulation` of separate FMUs, and `OneFileRun` in C."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Protocol

from ..errors import SceneError
from ..scene import Scene
from ..scene.run import UNCORRECTED
from .recorder import Recorder

if TYPE_CHECKING:
    from typing_extensions import Self

    from ..output.workers import Progress
    from .compared import Compared
    from .facts import Facts


class Simulation(Protocol):
    """A scene, restarted and run any number of times.

    Attributes:
        units: what is recorded of them, by name.
        coupled: whether its tolerance needs runs to compare.
    """

    scene: Scene
    coupled: bool

    @property
    def units(self) -> Mapping[str, Any]: ...

    def __enter__(self) -> Self: ...

    def __exit__(self, *_exception: object) -> None: ...

    def start(self) -> None:
        """Restart from the scene's start values."""

    def record(self, recorder: Recorder, progress: Progress | None) -> None:
        """Run to the end; a row at the start and after every step."""

    def facts(self) -> Facts:
        """What the run since the last start did."""


class CoupledRun(Simulation, Protocol):
    """Coupled units, whose steps can be chosen and repeated.

    Attributes:
        meets_events: whether steps end where a stop is touched, or weights or supports stick.
    """

    meets_events: bool

    def like(self, scene: Scene) -> Self:
        """A simulation of another scene with the same units, which differs in start values."""

    def start(self, *, attempt: int | None = None, parts: int = 1) -> None:
        """Restart from the scene's start values; arguments as of `CoSimulation.start`."""

    def compared(self) -> Compared:
        """What the runs of this motion are compared by."""


def refuse_loose_tolerance(scene: Scene) -> None:
    """Raise SceneError if a tolerance is given and the scheme or the order cannot keep it."""
    coupling = scene.coupling
    if coupling.tolerance is None:
        return
    if coupling.scheme in UNCORRECTED or coupling.order < 3:
        raise SceneError(
            f"{scene.label}: coupling.tolerance = {coupling.tolerance:g}: kept only by scheme "
            f'"iterated" or "auto" with order 3, not by "{coupling.scheme}" with order '
            f"{coupling.order}; give steps_per_rev instead"
        )
