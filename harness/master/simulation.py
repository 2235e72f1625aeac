"""What the two engines have in common: `CoSimulation` of separate FMUs, `OneFileRun` in C."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from ..errors import SceneError
from ..scene import Scene
from ..scene.run import UNCORRECTED
from .facts import Facts
from .recorder import Recorder, Signal

if TYPE_CHECKING:
    from typing_extensions import Self

    from ..output.workers import Progress


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


class Simulation(Protocol):
    """A scene that is started, stepped and recorded as often as wanted.

    Attributes:
        units: by name, what a `Recorder` reads.
        coupled: whether there is a loop.
        order: of the exchanged signals.
        chooses_steps: whether a tolerance chooses each step of a first run.
        meets_events: whether steps end where weights collide or stick, or supports stick.
        ends_steps_at_corners: of a motor's characteristic.
        time: reached so far [s]; may be set to where a step was to end.
    """

    scene: Scene
    coupled: bool
    chooses_steps: bool
    meets_events: bool
    ends_steps_at_corners: bool
    time: float

    @property
    def units(self) -> Mapping[str, Any]: ...

    @property
    def order(self) -> int: ...

    def start(self, *, attempt: int | None = None, again: Repeated | None = None) -> None:
        """Begin: a first run, or one that repeats it.

        Args:
            attempt: at a first run with a tolerance, each in finer steps than the one before.
        """

    def step(self, step: float, longest: float | None = None) -> float:
        """One communication step of at most `step` [s]; returns its length."""

    def record(self, recorder: Recorder, progress: Progress | None) -> None:
        """Run to the end; a row at the start and after every step."""

    def facts(self) -> Facts:
        """What the run since the last start did."""

    def __enter__(self) -> Self: ...

    def __exit__(self, *_exception: object) -> None: ...


def refuse_loose_tolerance(scene: Scene) -> None:
    """Raise SceneError where a tolerance is asked of a scheme or an order that cannot keep it."""
    coupling = scene.coupling
    if coupling.tolerance is None:
        return
    if coupling.scheme in UNCORRECTED or coupling.order < 3:
        raise SceneError(
            f"{scene.name}: coupling.tolerance = {coupling.tolerance:g}: kept only by scheme "
            f'"iterated" or "auto" with order 3 or 5, not by "{coupling.scheme}" with order '
            f"{coupling.order}; give steps_per_rev instead"
        )
