"""A page about a machine for a colleague: one file, verdict first."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..output.files import write_whole
from ..output.report import Report
from ..output.workers import Progress, Workers
from ..scatter.study import draw_machines
from ..scatter.vary import variations
from ..scene import Scene
from .answers import judged, verdicts
from .drawing import machine_drawing
from .parts import Drawing
from .runs import own_run, switched_on
from .sections import assumptions, capacity, switching_on, tolerances, vibration, where


@dataclass(frozen=True)
class Written:
    """A page that was written.

    Attributes:
        path: of the file.
        verdicts: the sentences that stand first on it.
    """

    path: Path
    verdicts: tuple[str, ...]


def write_report(
    scene: Scene,
    path: Path,
    *,
    run_up: float | None = None,
    limit: float | None = None,
    vary: Mapping[str, Any] | Iterable[str] = (),
    machines: int = 200,
    workers: Workers = 1,
    progress: Progress | None = None,
) -> Written:
    """Write the page; see `Scene.report`.

    Args:
        run_up: time from standstill to full speed [s]; default: the scene's own drive, else a slow
            run-up that the page states.
        limit: of the vibration velocity [m/s rms].
        vary: tolerances as of `scatter`; none: they are not judged.
        machines: drawn from them.
        workers: processes that run random starts and machines.

    Raises:
        UserError: a value is wrong, or the file cannot be written.
        SimulationError: the scene itself cannot be run.
    """
    varied = variations(vary, scene) if vary else []
    if varied:
        draw_machines(scene, varied, machines)  # refuses what it does before long work begins
    page = Report(None, f"Report: {scene.heading}", [scene])
    done = _Steps(progress, 5)
    own = own_run(scene)
    done.next()
    started = switched_on(scene, run_up, workers)
    done.next()
    said = verdicts(scene, own, started)
    page.parts += [judged(one) for one in said]
    page.parts.append(Drawing(machine_drawing(scene), "The machine at its start, not to scale."))
    page.parts += vibration(scene, own, started, limit)
    page.parts += switching_on(scene, started)
    done.next()
    page.parts += where(scene)
    done.next()
    page.parts += capacity(scene)
    page.parts += tolerances(scene, varied, machines, workers)
    page.parts += assumptions(scene, own, started)
    page.cited = "ISO 21940-11"
    text = page.page()
    with write_whole(path) as stream:
        stream.write(text)
    done.next()
    return Written(path, tuple(one.text for one in said))


class _Steps:
    """Progress over a number of steps of like length."""

    def __init__(self, progress: Progress | None, count: int) -> None:
        self.progress, self.count, self.at = progress, count, 0

    def next(self) -> None:
        """One more is done."""
        self.at += 1
        if self.progress is not None:
            self.progress(self.at / self.count)
