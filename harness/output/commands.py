"""How every command ends: errors as messages and exit codes.

Wrong input ends with one message and exit code 2, a row that does not hold or a run that cannot be
completed with exit code 1, Ctrl-C with 130, SIGTERM with 143.
"""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
from contextlib import suppress
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from ..errors import SimulationError, UserError, is_own_file
from . import options
from .interrupts import Interrupted, interruptible, temporary_files
from .machine import program_version
from .terminal import say


class Commands(TyperGroup):
    """Turns the package's own errors into a message and an exit code, for every command alike."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        options.typed.set(tuple(args))
        return super().parse_args(ctx, args)

    def invoke(self, ctx: Any) -> Any:
        try:
            with interruptible():
                return super().invoke(ctx)
        except UserError as error:
            say(str(error), error=True)
            raise typer.Exit(2) from error
        except SimulationError as error:
            say(str(error), error=True)
            raise typer.Exit(1) from error
        except (ArithmeticError, RecursionError) as error:
            say(f"numbers too large or too small to compute with: {error}", error=True)
            raise typer.Exit(1) from error
        except MemoryError as error:
            say("not enough memory for this", error=True)
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
            say(f"{place}{error.strerror or error}", error=True)
            raise typer.Exit(2) from error
        except (Interrupted, KeyboardInterrupt) as interrupt:
            if not isinstance(interrupt, Interrupted):
                interrupt = Interrupted(signal.SIGINT)
            say(interrupt.words, error=True)
            raise typer.Exit(interrupt.exit_code) from interrupt


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


def execute(app: typer.Typer) -> None:
    """Run the command that is asked for on the command line."""
    with temporary_files():
        try:
            app()
        finally:
            _flush()


def _flush() -> None:
    """Have what was said written now; where nobody takes it the interpreter must not try again."""
    try:
        if sys.stdout is not None:
            sys.stdout.flush()
    except (OSError, ValueError):
        with suppress(OSError, ValueError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise SystemExit(1) from None
