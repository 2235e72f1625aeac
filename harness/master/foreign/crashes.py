"""An FMU that crashes takes the process with it, but not without a word.

While units of others are loaded, signals of a crash are answered here: the unit and what it was
asked to do are named, temporary files are removed, and the process ends with exit code 2.  A crash
of anything else ends the process as ever.
"""

from __future__ import annotations

import ctypes
import os
import shutil
import signal
from typing import TYPE_CHECKING, Any

from ...output.interrupts import end_process

if TYPE_CHECKING:
    from .instance import ForeignUnit

EXIT_CODE = 2  # that of wrong input
_CRASHES = [
    getattr(signal, name)
    for name in ("SIGSEGV", "SIGBUS", "SIGFPE", "SIGILL", "SIGABRT")
    if hasattr(signal, name) and os.name == "posix"
]
_Handler = ctypes.CFUNCTYPE(None, ctypes.c_int)
asked: list[tuple[ForeignUnit, str]] = []  # units and calls that have not come back
_before: dict[int, Any] = {}  # handlers from before
_loaded: list[ForeignUnit] = []


def watch(unit: ForeignUnit) -> None:
    """Answer crashes from now on, until all units are let go."""
    _loaded.append(unit)
    if len(_loaded) == 1:
        for number in _CRASHES:
            _before[number] = _replace(number, ctypes.cast(_answer, ctypes.c_void_p))


def let_go(unit: ForeignUnit) -> None:
    """Of a unit that is closed."""
    if unit in _loaded:
        _loaded.remove(unit)
    if not _loaded:
        while _before:
            _replace(*_before.popitem())


def _replace(number: int, handler: Any) -> Any:
    """Set C's handler of a signal; the one before."""
    act = ctypes.CDLL(None).signal
    act.argtypes, act.restype = (ctypes.c_int, ctypes.c_void_p), ctypes.c_void_p
    return act(number, handler)


@_Handler
def _answer(number: int) -> None:
    if not asked:
        _replace(number, _before.get(number))
        return  # it happens again, and ends the process
    unit, what = asked[-1]
    for each in _loaded:
        shutil.rmtree(each.folder, ignore_errors=True)
    end_process(
        f"{unit.name} ({unit.path.name}) at t = {unit.time:g} s: {what} crashed this process "
        f"({signal.Signals(number).name}): the FMU is to blame; ask those who made it",
        EXIT_CODE,
    )
