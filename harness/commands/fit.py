"""`autobalancer fit`: values of a scene from what was measured."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from ..errors import MOST_STARTS, SMALLEST_SCATTER
from ..output import options
from ..output.terminal import progress_bar, say, show
from .changes import changed_scene, set_option
from .many_systems import fit_system
from .run_system import refuse_unsupported, system_of

_LIMITS = typer.Option(
    "--limit",
    metavar="PATH=LOW:HIGH,...",
    help="Bounds of a free value: balls.mass=40g:60g; rotor.damping=2: has no upper bound.",
)
_PRIORS = typer.Option(
    "--prior",
    metavar="PATH=DEVIATION,...",
    help="Standard deviation of a free value about its start; counts as one measurement.",
)


def command(
    scene: Annotated[str, options.SCENE],
    measured: Annotated[
        Path,
        typer.Option(
            metavar="FILE.csv",
            help="Columns: speed [rpm], values of the scene that were set, by path, and what was "
            "measured: amplitude [mm] (mean of the supports), residual, rotor.station[1].residual. "
            "Of a system: time [s] and signals, unit.variable [UNIT].",
        ),
    ],
    free: Annotated[
        list[str],
        typer.Option(
            metavar="PATH,...",
            help="Values to find: rotor.stiffness[1],balls.drag; PATH=PATH: one value for both.",
        ),
    ],
    limits: Annotated[list[str] | None, _LIMITS] = None,
    priors: Annotated[list[str] | None, _PRIORS] = None,
    scatter: Annotated[
        float,
        options.number(
            "Standard deviation of a residual, which priors are weighed against.",
            "--scatter",
            least=SMALLEST_SCATTER,
        ),
    ] = 0.1,
    harmonic: Annotated[
        bool,
        typer.Option("--harmonic", help="Search by harmonic balance only; runs check the result."),
    ] = False,
    starts: Annotated[
        int,
        options.whole(
            "Starts of harmonic balance, the scene's and others at random",
            "--starts",
            most=MOST_STARTS,
        ),
    ] = 1,
    without_balancers: Annotated[
        bool, typer.Option("--without-balancers", help="Measured without balancers.")
    ] = False,
    changes: Annotated[
        list[str] | None, set_option("balls.drag=0.1, also the start of a free value")
    ] = None,
    predict: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.csv", help="Other measurements, to compare with the fitted scene."
        ),
    ] = None,
    picture: Annotated[Path | None, options.picture("Residual plot.", "--output", "-o")] = None,
    json: Annotated[Path | None, options.json("the results")] = None,
    report: Annotated[Path | None, options.REPORT] = None,
) -> None:
    """Fit a scene to amplitudes, or a system of FMUs to signals."""
    from ..fit.measured import read_measured
    from ..fit.report import lines, table
    from ..output.files import write_json
    from ..output.report import Report

    given: dict[str, Any] = {"limits": limits or (), "priors": priors or (), "scatter": scatter}
    if (system := system_of(scene, changes)) is not None:
        unsupported = {"harmonic": harmonic, "starts": starts > 1, "report": report}
        refuse_unsupported(system, {**unsupported, "without-balancers": without_balancers})
        return fit_system(system, measured, free, given, predict, picture, json)
    loaded = changed_scene(scene, changes)
    loaded = loaded.without_balancers() if without_balancers else loaded
    if predict is not None:
        read_measured(predict, loaded)  # what is wrong with it is said before the work
    page = Report(report, f"Fit: {loaded.heading}", [loaded])
    with progress_bar("fitting") as progress:
        found = loaded.fit(
            measured,
            free,
            **given,
            harmonic=harmonic,
            starts=starts,
            progress=progress,
        )
        said = found.as_json()
        if predict is not None:
            said |= {"predicted": str(predict), "rms_predicted": found.predicted_rms(predict)}
    with page.keeping():
        show(table(found))
        for line in lines(said):
            say(line)
        together = ", ".join(u.label for u in loaded.balancer) or "the rotor"
        say(f"Run in C as one composite: {together}")
    for path in filter(None, (picture, page.picture(f"{loaded.name}_fit"))):
        say(f"Picture: {found.plot(path)}")
    page.write()
    if json is not None:
        write_json(said, json)
