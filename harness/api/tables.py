"""Tables of a scene that can be called: `scene.run()` and `scene.rotor()`.

A table of the description answers what its keys say.  These are the same tables with what is done
with them; a `Scene` tells its own that they are part of it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from autobalancer.harness.errors import SceneError
from autobalancer.harness.scene import rotor, rotor_matrices, run
from autobalancer.harness.scene.nested import Nested

if TYPE_CHECKING:
    from autobalancer.harness.output.workers import Progress
    from autobalancer.harness.result.result import Result
    from autobalancer.harness.rotor.analysis import RotorAnalysis
    from autobalancer.harness.scene.scene import Scene


def scene_of(table: Any) -> Scene:
    """The scene that a table which is called is part of.

    Raises:
        SceneError: it is part of none.
    """
    if "_scene" not in table.__dict__:
        raise SceneError(f"{type(table).__name__}: belongs to no scene: call it as scene.run()")
    found: Scene = table.__dict__["_scene"]
    return found


class Run(run.Run):
    """How long, from where, and what is recorded."""

    def __call__(
        self,
        *,
        record: Iterable[str] | None = None,
        fmus: str | Path | None = None,
        separate: bool = False,
        progress: Progress | None = None,
    ) -> Result:
        """Run the scene, as `scene.run()`.

        Args:
            record: signals such as "rotor.x"; default: the table's own.
            fmus: folder of FMUs to couple instead of those that are built.
            separate: couple separate FMUs in Python instead of in C; slower.
            progress: called with the finished fraction.

        Returns:
            Signals (T,) at the communication points, in SI units.

        Raises:
            UserError: the scene or an FMU is wrong.
            SimulationError: the run cannot be completed correctly.

        >>> run = ab.load("two_balls").replace({"run.revolutions": 3}).run(record=["rotor.x"])
        >>> run["rotor.x"].shape == run.time.shape, list(run.to_pandas())
        (True, ['rotor.x'])
        """
        from autobalancer.harness.result.run import cosimulate

        form: dict[str, Any] = {"fmus": fmus, "separate": separate}
        return cosimulate(scene_of(self), record=record, progress=progress, **form)

    def many(
        self, table: Any, *, results: Sequence[str] | None = None, threads: int | None = None
    ) -> Any:
        """Run the scene once for every row of a table, in C on all cores, as `scene.run.many()`.

        Args:
            table: columns of values by their paths; a mapping of arrays (n,), or a pandas frame.
            results: such as "residual" [m] or "settling_time" [s], see `cosimulate_many`.
            threads: default: one a core.

        Returns:
            Arrays (n,) by name, and `failure`; or the frame with these columns.

        Raises:
            UserError: a path or a result is unknown, or columns differ in length.

        >>> short = ab.load("two_balls").replace({"run.revolutions": 3})
        >>> short.run.many({"rotor.stiffness[x]": np.linspace(0.9, 1.1, 4)})["residual"].shape
        (4,)
        """
        from autobalancer.harness.result.many import DEFAULTS, cosimulate_many

        return cosimulate_many(scene_of(self), table, results=results or DEFAULTS, threads=threads)


class CalledRotor:
    """What `scene.rotor()` does, for every kind of rotor."""

    def __call__(
        self, low: float | str | None = None, high: float | str | None = None
    ) -> RotorAnalysis:
        """The rotor alone, as `scene.rotor()`: modes, critical speeds, Campbell, response, run-up.

        Args:
            low, high: speeds of the pictures [rad/s]; default: about the critical speeds.

        Raises:
            UserError: the range is empty, or the supports have dry friction.

        >>> rotor = ab.load("three_mass_shaft").rotor()
        >>> sorted(set(rotor.to_pandas()["whirl"])), rotor.response().amplitude.shape
        (['backward', 'forward'], (400, 2, 3))
        """
        from autobalancer.harness.rotor.analysis import analyse

        return analyse(scene_of(self), low, high)


class Planar(CalledRotor, rotor.Planar):
    __doc__ = rotor.Planar.__doc__


class TwoSupport(CalledRotor, rotor.TwoSupport):
    __doc__ = rotor.TwoSupport.__doc__


class Flexible(CalledRotor, rotor.Flexible):
    __doc__ = rotor.Flexible.__doc__


class Matrices(CalledRotor, rotor_matrices.Matrices):
    __doc__ = rotor_matrices.Matrices.__doc__


Rotor = Nested[Planar | TwoSupport | Flexible | Matrices]
