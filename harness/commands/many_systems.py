"""`autobalancer scatter` and `autobalancer fit` of a system of units."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..output import options
from ..output.files import write_json
from ..output.terminal import progress_bar, say, show

if TYPE_CHECKING:
    from ..api.system import System


def scatter_system(
    system: System,
    vary: Sequence[str],
    count: int | None,
    seed: int,
    output: Sequence[Path],
    json: Path | None,
    cluster: str | None,
) -> None:
    """Run systems whose start values scatter; say, write and draw what came of it."""
    from ..output.cluster import who_works
    from ..scatter.systems import lines, quantile_table

    number = {} if count is None else {"n": count}
    with progress_bar(f"systems of {system.name}") as progress, who_works(cluster) as workers:
        found = system.scatter(vary, seed=seed, workers=workers, progress=progress, **number)
    said = found.as_json()
    for line in lines(said):
        say(line)
    show(quantile_table(said))
    for path in output:
        if path.suffix == options.TABLE:
            say(f"Table: {found.to_csv(path)}")
        else:
            say(f"Picture: {found.plot(path)}")
    if json is not None:
        write_json(said, json)


def fit_system(
    system: System,
    measured: Path,
    free: Sequence[str],
    given: Mapping[str, Any],
    predict: Path | None,
    picture: Path | None,
    json: Path | None,
) -> None:
    """Fit start values; say, write and draw what came of it.

    Args:
        given: limits, priors and scatter.
    """
    from ..fit.report import table
    from ..fit.series import read_signals
    from ..fit.systems import lines

    if predict is not None:
        read_signals(predict, system)  # what is wrong with it is said before the work
    with progress_bar("fitting") as progress:
        found = system.fit(measured, free, **given, progress=progress)
    said = found.as_json()
    show(table(found))
    for line in lines(found):
        say(line)
    if predict is not None:
        said |= {"predicted": str(predict), "rms_predicted": found.predicted_rms(predict)}
        say(f"Predicted: rms {said['rms_predicted']:.4g}, {predict}")
    if picture is not None:
        say(f"Picture: {found.plot(picture)}")
    if json is not None:
        write_json(said, json)
