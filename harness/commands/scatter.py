"""`autobalancer scatter`: machines as they leave the factory, with tolerances on their values."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..errors import MOST_STARTS
from ..output import options
from ..output.terminal import progress_bar, say, show
from .changes import changed_scene, set_option
from .many_systems import scatter_system
from .run_system import refuse_unsupported, system_of

VARY = "PATH=NAME(NUMBERS)"
MACHINES = 10_000


def command(
    scene: Annotated[str, options.SCENE],
    vary: Annotated[
        list[str],
        typer.Option(
            metavar=VARY,
            help="A value and its distribution: normal(mean,deviation[,low,high]), "
            "uniform(low,high) or lognormal(median,deviation); with units and percentages, such as "
            "normal(50g,10%). [*] in the path: each weight by itself. Can be given several times.",
        ),
    ],
    n: Annotated[
        int | None,
        options.whole(
            "Number; default: 10000 machines, 1000 systems of FMUs", "-n", most=MOST_STARTS
        ),
    ] = None,
    seed: Annotated[int, options.whole("Seed of the random numbers", "--seed", least=0)] = 1,
    output: Annotated[
        list[Path] | None, options.pictures(" or FILE.csv with every machine", options.TABLE)
    ] = None,
    store: Annotated[Path | None, options.store()] = None,
    json: Annotated[Path | None, options.json("the results")] = None,
    cluster: Annotated[str | None, options.CLUSTER] = None,
    changes: Annotated[list[str] | None, set_option("run.revolutions=200")] = None,
    report: Annotated[Path | None, options.REPORT] = None,
) -> None:
    """Simulate machines or systems of FMUs with scattered values."""
    from ..output.cluster import who_works
    from ..output.files import write_json
    from ..output.report import Report
    from ..scatter.report import grade_table, importance_table, lines

    if (system := system_of(scene, changes)) is not None:
        refuse_unsupported(system, {"report": report, "store": store})
        return scatter_system(system, vary, n, seed, output or (), json, cluster)
    n = n or MACHINES
    loaded = changed_scene(scene, changes)
    page = Report(report, f"Tolerances: {loaded.heading}", [loaded])
    with progress_bar(f"machines of {loaded.name}") as progress, who_works(cluster) as workers:
        study = loaded.scatter(
            vary,
            n,
            seed=seed,
            workers=workers,
            progress=progress,
            store=store,
        )
    said = study.as_json()
    with page.keeping():
        for line in lines(said):
            say(line)
        if said["grades"]:
            show(grade_table(said))
        if said["importance"]:
            show(importance_table(said))
        together = ", ".join(u.label for u in loaded.balancer) or "the rotor"
        say(f"Run in C as one composite: {together}")
    for path in filter(None, (*(output or ()), page.picture(f"{loaded.name}_scatter"))):
        if path.suffix == options.TABLE:
            say(f"Table: {study.to_csv(path)}")
        else:
            say(f"Picture: {study.plot(path)}")
    page.cited = "ISO 21940-11"
    page.write()
    if json is not None:
        write_json(said, json)
