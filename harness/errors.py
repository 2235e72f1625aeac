"""What can go wrong, by whose hand: wrong input by the user, or a run that cannot be right."""

import math
import sys
from collections.abc import Iterable
from numbers import Integral
from pathlib import Path
from types import FrameType

_PACKAGE = __name__.split(".", 1)[0]
_PACKAGES = [Path(__file__).resolve().parents[1] / name for name in ("models", "fmus", "harness")]


def is_own_file(error: OSError) -> bool:
    """Whether the file that an error names is one of this program, not one of the user."""
    path = Path(str(error.filename)).resolve()
    return error.filename is not None and any(path.is_relative_to(own) for own in _PACKAGES)


class UserError(Exception):
    """Wrong input: the message names file, key, value, unit and what is allowed.

    The command line prints the message without a traceback and exits with code 2.
    """


class SceneError(UserError):
    """A scene file, or a value put in its place, is wrong."""


class UnitError(UserError):
    """An FMU is missing, corrupt, or not the one the scene needs."""


class SimulationError(Exception):
    """A run that cannot be completed correctly: not finite, or a loop that did not converge.

    The message names time, signal and loop gain.  The command line exits with code 1.
    """


class LoopError(SimulationError):
    """Corrector passes, or steps however short, do not bring forces and motion into agreement."""


SMALLEST_SCATTER = 1e-6  # of a measured difference
MOST_STARTS = 100_000_000  # of runs that are asked for: a day of 1 ms each


def refuse_count(value: object, name: str, least: int = 1, most: int = MOST_STARTS) -> None:
    """Raise UserError for what is no number of things from `least` to `most`.

    Args:
        name: of the argument.
    """
    if not _is_whole(value, least, most):
        raise UserError(f"{name} = {value!r}: must be a whole number from {least} to {most}")


def texts_of(value: object, name: str, such_as: str) -> list[str]:
    """The texts of an argument that is one text, or several.

    Args:
        name: of the argument.
        such_as: an example of it.

    Raises:
        UserError: it is neither.
    """
    texts = [value]
    if isinstance(value, Iterable) and not isinstance(value, str):
        texts = [*value]
    if not all(isinstance(text, str) for text in texts):
        raise UserError(f"{name} = {value!r}: must be text, or a list of texts, such as {such_as}")
    return [str(text) for text in texts]


def outer_level() -> int:
    """Stack level of the caller of this package, for `warnings.warn` in the function that asks."""
    frame: FrameType | None = sys._getframe(1)
    level = outer = 1
    while frame is not None:
        if frame.f_globals.get("__name__", "").startswith(f"{_PACKAGE}."):
            outer = level + 1
        frame, level = frame.f_back, level + 1
    return outer


def refuse_seed(seed: object) -> None:
    """Raise UserError for what no random numbers can be drawn from."""
    if not _is_whole(seed, 0):
        raise UserError(f"seed {seed!r}: must be a whole number, 0 or more")


def _is_whole(value: object, least: int, most: float = math.inf) -> bool:
    if isinstance(value, bool) or not isinstance(value, Integral):
        return False
    return least <= int(value) <= most
