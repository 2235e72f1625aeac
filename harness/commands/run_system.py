"""`autobalancer run` of a system of units: a scene file without a rotor, an SSP, or one FMU."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import UserError
from ..output.files import write_json
from ..output.terminal import progress_bar, say, say_facts, show
from ..scene.changes import parse_change

if TYPE_CHECKING:
    from ..api.system import System
    from ..result.result import Result


def system_of(source: str, changes: list[str] | None) -> System | None:
    """The system that a path names, with every KEY=VALUE put in its place; None of a scene.

    Raises:
        UserError: it is wrong, or a change is.
    """
    from ..scene.file import names_system

    if not names_system(source):
        return None
    from autobalancer.system import load_system

    system = load_system(source)
    return system.replace(dict(map(parse_change, changes))) if changes else system


def refuse_unsupported(system: System, unsupported: Mapping[str, Any]) -> None:
    """Raise UserError where an option is given, by name, that only a scene with a rotor has."""
    for name, value in unsupported.items():
        if value:
            raise UserError(f"--{name}: {system.label} has no rotor: leave the option out")


def run_system(
    system: System,
    unsupported: Mapping[str, Any],
    output: Path | None,
    plot: Path | None,
    json_file: Path | None,
    verbose: bool,
) -> None:
    """Run it, and say, write and draw what came of it.

    Args:
        unsupported: options that only a scene with a rotor has, by name.

    Raises:
        UserError: one of these is given.
    """
    from ..result.tables import summary

    refuse_unsupported(system, unsupported)
    with progress_bar(f"running {system.name}") as progress:
        result = system.run(progress=progress)
    show(summary(result))
    if system.coupling.tolerance is not None and result.estimated_error:
        say(f"Estimated error: {result.estimated_error:.1g} of each signal's largest value")
    if verbose:
        say_facts(result.units, result.left_out, "FMUs loaded")
        say(counts(result))
    say_notes_and_write(result, output, json_file, plot)


def counts(result: Result) -> str:
    """Steps, passes and calls of a run of any kind, and how long it took."""
    calls = sum(result.calls.values())
    return (
        f"{result.steps} steps, {result.passes} passes, {calls} FMI calls in {result.seconds:.3f} s"
    )


def say_notes_and_write(
    result: Result, output: Path | None, json_file: Path | None, plot: Path | None
) -> None:
    """End of a run of any kind: its notes, and the files that are asked for."""
    from ..result.tables import as_json

    for event in result.events:
        say(f"NOTE: {event}", style="bold yellow", error=True)
    if output is not None:
        say(f"Signals: {result.to_csv(output)}")
    if json_file is not None:
        write_json(as_json(result), json_file)
    if plot is not None:
        say(f"Picture: {result.plot(plot)}")
