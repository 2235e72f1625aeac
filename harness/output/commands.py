"""How every command ends: errors as messages and exit codes.

Wrong input ends with one message and exit code 2, a row that does not hold or a run that cannot be
completed with exit code 1, Ctrl-C with 130, SIGTERM with 143.
"""

from __future__ import annotations

import errno
import functools
import inspect
import os
import re
import subprocess
import sys
import warnings
from collections.abc import Callable, Sequence
from contextlib import suppress
from enum import Enum
from itertools import takewhile
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from ..errors import SimulationError, UserError, is_own_file
from ..units import QUANTITIES, engineering, to_si
from . import options
from .interrupts import ended_after, temporary_files
from .machine import program_version
from .terminal import how_far, is_quiet, say

_SECONDS = {"s": 1.0, "m": 60.0, "h": 3600.0, "d": 86400.0, "": 1.0}
# of the command line; its home differs between releases of typer
_Misuse: type[Exception] = typer.BadParameter.__mro__[1]
_OPTION = re.compile(r"--?[a-zA-Z]")
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
_TIME = re.compile(r"(?P<number>\d+(?:\.\d*)?|\.\d+)\s*(?P<unit>[smhd]?)")


class Commands(TyperGroup):
    """Turns the package's own errors into a message and an exit code, for every command alike."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        options.typed.set(tuple(args))
        options.claimed.set(())
        return super().parse_args(ctx, args)

    def invoke(self, ctx: Any) -> Any:
        try:
            return super().invoke(ctx)
        except _Misuse as error:
            asked = self.commands.get(ctx.invoked_subcommand)
            typed = options.typed.get()
            if not (words := _incomplete_option(asked, typed) or _divided_value(asked, typed)):
                raise
            say(words, error=True)
            raise typer.Exit(2) from error
        except UserError as error:
            asked = self.commands.get(ctx.invoked_subcommand)
            say(_incomplete_option(asked, options.typed.get()) or str(error), error=True)
            raise typer.Exit(2) from error
        except SimulationError as error:
            say(str(error), error=True)
            raise typer.Exit(1) from error
        except (ArithmeticError, RecursionError) as error:
            say(f"numbers too large or too small to compute with: {error}", error=True)
            raise typer.Exit(1) from error
        except MemoryError as error:
            say(f"not enough memory for this{f': {error}' * bool(str(error))}", error=True)
            raise typer.Exit(1) from error
        except subprocess.CalledProcessError as error:  # a compiler on a full disk, for example
            command = " ".join(map(str, error.cmd[:4]))
            say(f"{command} ...: ended with {error.returncode}: {error.stderr or ''}", error=True)
            raise typer.Exit(1) from error
        except OSError as error:
            if error.errno == errno.EPIPE:  # nobody reads on: typer ends without a word
                raise
            if is_own_file(error):
                say(
                    f"internal error: {error.filename}: {error.strerror}: a file of autobalancer "
                    "itself cannot be read; install it again, and if that does not help report "
                    "this message, the command and `autobalancer --version` to its maintainers",
                    error=True,
                )
                raise typer.Exit(1) from error
            place = f"{error.filename}: " if error.filename else ""
            say(f"{place}{error.strerror or error}{_where_room_is_missing(error)}", error=True)
            raise typer.Exit(2) from error


def _incomplete_option(command: Any, typed: Sequence[str]) -> str:
    """How to write an option that has fewer values than it needs before the next one; or empty."""
    for each in command.params if command else ():
        is_flag = getattr(each, "is_flag", False)
        for name in set(each.opts).intersection(typed) if not is_flag else ():
            values = typed[typed.index(name) + 1 :][: each.nargs]
            given = tuple(takewhile(lambda value: not _OPTION.match(value), values))
            if len(given) < each.nargs:
                number = "a value"
                if each.nargs > 1:
                    number = f"{each.nargs} values, with spaces between"
                return (
                    f"{' '.join((name, *given))}: requires {number}: {name} "
                    f"{each.metavar or 'VALUE'}. {each.help}"
                )
    return ""


def _divided_value(command: Any, typed: Sequence[str]) -> str:
    """How to write a number and its unit that were typed apart, such as --load 44 kN; or empty."""
    for each in command.params if command else ():
        for name in set(each.opts).intersection(typed) if each.nargs == 1 else ():
            value, unit, *_ = *typed[typed.index(name) + 1 :], "", ""
            if _NUMBER.fullmatch(value) and not _OPTION.match(unit) and _is_unit(unit):
                return f'{name} {value} {unit}: a value with a space needs quotes: "{value} {unit}"'
    return ""


def _is_unit(text: str) -> bool:
    """Whether it is the unit of some quantity of a scene."""
    for symbol in QUANTITIES if text else ():
        with suppress(ValueError):
            to_si(f"1 {text}", symbol)
            return True
    return False


def _where_room_is_missing(error: OSError) -> str:
    """Where to look, as a full disk names no file."""
    if error.errno != errno.ENOSPC or error.filename:
        return ""
    import tempfile

    return (
        f": in {tempfile.gettempdir()}, where temporary files are (TMPDIR names another folder), "
        "or where the command writes: free some room"
    )


def without_command(
    ctx: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Show the version and exit.")] = False,
) -> None:
    """Options before any command; without a command, the help."""
    if version:
        typer.echo(program_version())
        raise typer.Exit
    if ctx.invoked_subcommand is None:
        typer.echo(ctx.get_help())


class Units(str, Enum):
    """What tables, pictures and the page show."""

    SI = "si"
    ENGINEERING = "engineering"


def with_common_options(command: Callable[..., None]) -> Callable[..., None]:
    """The command with the options that all commands have."""
    own = inspect.signature(command, eval_str=True)
    common: dict[str, tuple[Any, Any]] = {
        "at_most": (
            "1h",
            Annotated[
                float,
                typer.Option(
                    metavar="TIME", parser=seconds_of, help="Time after which to end: 30m, 2h, 1d."
                ),
            ],
        ),
        "units": (
            Units.SI,
            Annotated[
                Units,
                typer.Option(
                    envvar="AUTOBALANCER_UNITS", help="Show rpm, mm, g mm, deg and Hz, or SI units."
                ),
            ],
        ),
        "quiet": (
            False,
            Annotated[
                bool, typer.Option("--quiet", help="Print no summary of the scene and no warnings.")
            ],
        ),
    }

    @functools.wraps(command)
    def run(*args: Any, at_most: float, units: Units, quiet: bool, **given: Any) -> None:
        options.refuse_read([*args, *given.values()])
        engineering.set(units is Units.ENGINEERING)
        before = is_quiet.set(quiet)
        try:
            with ended_after(at_most, _out_of_time):
                command(*args, **given)
        finally:
            is_quiet.reset(before)

    keyword = inspect.Parameter.KEYWORD_ONLY
    added = [
        inspect.Parameter(name, keyword, annotation=kind, default=default)
        for name, (default, kind) in common.items()
    ]
    run.__signature__ = own.replace(parameters=[*own.parameters.values(), *added])  # type: ignore[attr-defined]
    return run


def seconds_of(text: str) -> float:
    """Seconds of a time such as 90s, 30m, 2h or 1d.

    Raises:
        UserError: it is none.
    """
    found = _TIME.fullmatch(text.strip())
    if not found or float(found["number"]) <= 0.0:
        raise UserError(f"--at-most {text!r}: must be a time such as 90s, 30m, 2h or 1d")
    return float(found["number"]) * _SECONDS[found["unit"]]


def _out_of_time() -> str:
    return f"not done within --at-most{how_far()}; give more time (--at-most 4h), or ask for less"


def execute(app: typer.Typer) -> None:
    """Run the command that is asked for on the command line."""
    with temporary_files(), warnings.catch_warnings():
        warnings.showwarning = functools.partial(_show_warning, warnings.showwarning)
        try:
            app()
        finally:
            _flush()


def _show_warning(
    usual: Callable[..., None], message: Warning | str, category: type[Warning], *place: Any
) -> None:
    """Print a warning of this program as a line, without the place in its code."""
    if not category.__module__.startswith(__name__.split(".", 1)[0]):
        usual(message, category, *place)
    elif not is_quiet.get():
        say(f"WARNING: {message}", style="bold yellow", error=True)


def _flush() -> None:
    """Have what was said written now; where nobody takes it the interpreter must not try again."""
    try:
        if sys.stdout is not None:
            sys.stdout.flush()
    except (OSError, ValueError):
        with suppress(OSError, ValueError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise SystemExit(1) from None
