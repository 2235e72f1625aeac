"""What is written of a scene, and what is compared with the literature."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .of_scene import OfScene

if TYPE_CHECKING:
    from autobalancer.harness.accuracy.precision.measure import Precision
    from autobalancer.harness.checks.runner import SceneReport
    from autobalancer.harness.export.build import Built
    from autobalancer.harness.output.workers import ItemProgress, Progress, Workers
    from autobalancer.harness.report.page import Written
    from autobalancer.harness.show.page import Page


class FileMethods(OfScene):
    """See `methods.Methods`."""

    def build(
        self,
        output: str | Path = ".",
        *,
        fmi: int = 2,
        platforms: Iterable[str] | None = None,
        python: bool = False,
        one_file: bool = False,
        ssp: bool = False,
        plain: bool = False,
        flat: bool = False,
        reference: bool = False,
        progress: Progress | None = None,
    ) -> Built:
        """Write the FMUs of the scene.

        Args:
            output: folder; with `one_file` or `ssp` also a file.
            fmi: version, 2 or 3.
            platforms: such as "x86_64-linux"; default: all.
            python: units that run Python instead of native ones.
            one_file: the units and their coupling as a single FMU.
            ssp: a system structure package instead of single files.
            plain: with `one_file`, without slopes and figures of the coupling.
            flat: with `one_file`, names without dots and brackets.
            reference: with `one_file`, also the right motion, by an independent integration.

        Raises:
            UserError: the options do not go together, or a file cannot be written.

        >>> built = ab.load("two_balls").build("units", platforms=["x86_64-linux"])
        >>> [path.name for path in built.files]
        ['rotor.fmu', 'weights.fmu']
        """
        from autobalancer.harness.export.build import build_files

        form: dict[str, Any] = {"python": python, "one_file": one_file, "ssp": ssp}
        form |= {"plain": plain, "flat": flat, "reference": reference}
        wanted = None if platforms is None else list(platforms)
        return build_files(self._scene, Path(output), fmi, wanted, progress=progress, **form)

    def show(self, output: str | Path | None = None) -> Page:
        """Write a web page, one file, that runs the scene.

        Args:
            output: the file; default: NAME.html in the current folder.

        Raises:
            UserError: the scene cannot be shown, or the file cannot be written.

        >>> page = ab.load("two_balls").show("two_balls.html")
        >>> page.path.stat().st_size > 100_000
        True
        """
        from autobalancer.harness.show.page import write_page

        return write_page(self._scene, None if output is None else Path(output))

    def report(
        self,
        output: str | Path | None = None,
        *,
        run_up: float | str | None = None,
        limit: float | str | None = None,
        vary: Mapping[str, Any] | Iterable[str] = (),
        n: int = 200,
        workers: Workers = 1,
        progress: Progress | None = None,
    ) -> Written:
        """Write one page about the machine for a colleague: verdict first, and how sure it is.

        Args:
            output: the file; default: NAME_report.html in the current folder.
            run_up: time from standstill to full speed [s]; default: the scene's own drive, else a
                slow run-up that the page states.
            limit: of the vibration velocity [m/s rms].
            vary: tolerances, as of `scatter`; none: they are not judged.
            n: machines drawn from them.
            workers: processes that run the random starts and these machines.

        Raises:
            UserError: a value is wrong, or the file cannot be written.
            SimulationError: the scene itself cannot be run.

        >>> page = ab.load("two_balls").report("two_balls.html")
        >>> page.path.stat().st_size > 50_000, len(page.verdicts)
        (True, 4)
        """
        from autobalancer.harness.errors import UserError, refuse_count
        from autobalancer.harness.report.page import write_report
        from autobalancer.harness.units import si_number

        refuse_count(n, "n")
        given = {"run_up": (run_up, "s"), "limit": (limit, "m/s")}
        values: dict[str, Any] = {}
        for name, (value, symbol) in given.items():
            values[name] = None if value is None else si_number(value, symbol, name)
            if values[name] is not None and not values[name] > 0.0:
                raise UserError(f"{name} {value}: must be above 0")
        if (values["limit"] or 0.0) >= 1.0:
            raise UserError(
                f"limit {limit}: must be below 1 m/s; a number alone is in m/s: write "
                f'"{limit} mm/s" if it is in mm/s'
            )
        path = Path(output or f"{self._scene.name}_report.html")
        values |= {"vary": vary, "machines": n, "workers": workers, "progress": progress}
        return write_report(self._scene, path, **values)

    def check(self, *, progress: ItemProgress | None = None) -> SceneReport:
        """Every [[check]] of the scene: its theory and measurements beside runs.

        Args:
            progress: called with the scene's name and the finished fraction.

        Raises:
            UserError: there is nothing to check.

        >>> ab.load("liquid_touch").check().holds
        True
        """
        from autobalancer.harness.checks.runner import check_all

        return check_all([self._scene], progress, workers=1)[0]

    def precision(
        self, seconds: float = 75.0, *, progress: Callable[[str, float], None] | None = None
    ) -> Precision:
        """Error against run time of every coupling scheme; errors in parts of a signal's range.

        Args:
            seconds: about how long the measuring may take.
            progress: called with what is measured and the finished fraction.

        Raises:
            UserError: nothing can be measured with the scene.

        >>> short = ab.load("liquid_closed").replace({"run.revolutions": 0.5})
        >>> bool(short.precision(1.0).to_pandas()["error"].min() < 1e-6)
        True
        """
        from autobalancer.harness.accuracy.precision.measure import precision

        return precision(self._scene, seconds=seconds, progress=progress)

    def cite(self, *, separate: bool = False) -> str:
        """BibTeX of the program and of the papers and methods that a run of the scene uses.

        A comment above each entry says what it is cited for.  The scene is not run.

        Args:
            separate: of a run of separate FMUs, with the scheme that couples them.

        Raises:
            SimulationError: the machine cannot be started.

        >>> print(*ab.load("drum").cite().splitlines()[:2], sep="\\n")
        % the program that ran the scene
        @software{autobalancer,
        """
        from autobalancer.harness.result.run import is_in_one_piece, tries_collocation
        from autobalancer.harness.scene.citations import bibtex

        one = not separate and is_in_one_piece(self._scene)
        return bibtex(self._scene, one, one and tries_collocation(self._scene))
