"""Entry point of `autobalancer`.

A command is a file of `commands` with a function `command`; `commands.NAMES` lists them.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from typer import Typer


def main() -> None:
    """Load the commands and run the one that is asked for."""
    from .output.interrupts import answer_signals

    answer_signals()
    from .output.commands import execute

    execute(program())


def program() -> Typer:
    """`autobalancer`: its commands by their names."""
    import typer

    from . import commands
    from .output.commands import Commands, with_common_options, without_command

    app = typer.Typer(
        name="autobalancer",
        cls=Commands,
        help="Simulate rotors with automatic balancers, and build them as FMUs.",
        add_completion=False,
        pretty_exceptions_enable=False,
        rich_markup_mode=None,  # "rich" drops units in brackets, and cuts words that are long
    )
    app.callback(invoke_without_command=True)(without_command)
    for name in commands.NAMES:
        feature = import_module(f"{commands.__name__}.{name}")
        app.command(name)(with_common_options(feature.command))
    return app


if __name__ == "__main__":
    main()
