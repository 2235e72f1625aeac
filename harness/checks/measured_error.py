"""What a scene's own run errs, measured by a finer one."""

from __future__ import annotations

from collections.abc import Iterator

from ..master.run import cosimulate
from ..output.workers import Progress
from ..scene import Scene
from ..scene.check import MeasuredErrorCheck
from .row import Row, Rows


def check_measured_error(
    scene: Scene, check: MeasuredErrorCheck, progress: Progress
) -> Iterator[Row]:
    """The signal that errs most, over its range; motion that nobody can predict does not hold.

    Raises:
        UserError: the scene records nothing.
        SimulationError: a run cannot be completed.
    """
    rows = Rows(scene.name, check.kind)
    separate = not scene.has_events
    found = cosimulate(scene, progress=progress, verify=True, separate=separate).verification
    assert found is not None
    source = f"the same run with {found.finer}"
    worst = max(found.relative, key=lambda name: found.relative[name])
    quantity = f"error of {scene.run.revolutions:g} revolutions: {worst}, of its range"
    if found.parting is not None:
        expected = f"at most {check.at_most:g}"
        yield rows.statement(quantity, expected, found.note(), False, source)
        return
    yield rows.number(quantity, 0.0, found.relative[worst], check.at_most, source, 1.0)
