"""Entry point of `autobalancer`.

A command is a file in the folder of its feature with a function `command`; it is registered here.
"""

from __future__ import annotations

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

    from .accuracy.precision import command as precision
    from .accuracy.stress import command as stress
    from .balancing import command as balance
    from .capture import command as capture
    from .checks import command as check
    from .design import command as design
    from .drag import command as drag
    from .export import command as build
    from .fit import command as fit
    from .manual import command as manual
    from .output.commands import Commands, with_common_options, without_command
    from .result import command as run
    from .rotor import command as rotor
    from .scatter import command as scatter
    from .scene import cite_command as cite
    from .scene import new_command as new
    from .show import command as show
    from .stability import map_command
    from .stability import speeds_command as speeds

    app = typer.Typer(
        name="autobalancer",
        cls=Commands,
        help="Simulate rotors with automatic balancers, and build them as FMUs.",
        add_completion=False,
        pretty_exceptions_enable=False,
        rich_markup_mode=None,  # "rich" drops units in brackets, and cuts words that are long
    )
    app.callback(invoke_without_command=True)(without_command)
    features = {"check": check, "build": build, "run": run, "speeds": speeds, "map": map_command}
    features |= {"balance": balance, "rotor": rotor, "design": design, "scatter": scatter}
    features |= {"capture": capture}
    features |= {"fit": fit, "drag": drag, "precision": precision}
    features |= {"show": show, "new": new, "cite": cite, "stress": stress, "manual": manual}
    for name, feature in features.items():
        app.command(name)(with_common_options(feature.command))
    return app


if __name__ == "__main__":
    main()
