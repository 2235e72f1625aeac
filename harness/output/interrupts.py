"""Ctrl-C and SIGTERM end a command in order: folders are cleared, and one word is said."""

from __future__ import annotations

import signal
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import FrameType

_ANSWERED = (signal.SIGINT, signal.SIGTERM)
_AGAIN = 0.005  # s until a signal that came at a bad moment is looked at anew
_UNIT = "autobalancer_"  # the packages within units that run Python begin like this


@contextmanager
def temporary_files() -> Iterator[None]:
    """All temporary files of the process lie in one folder within the block, gone at its end.

    An interrupt between the making of a folder and the note of it thus leaves nothing.  Where no
    folder can be made the block runs all the same: what needs one says so itself.
    """
    try:
        folder = tempfile.TemporaryDirectory(prefix="autobalancer-", ignore_cleanup_errors=True)
    except OSError:
        yield
        return
    before, tempfile.tempdir = tempfile.tempdir, folder.name
    try:
        yield
    finally:
        for number in _ANSWERED:
            signal.signal(number, signal.SIG_IGN)
        tempfile.tempdir = before
        folder.cleanup()


class Interrupted(BaseException):
    """The command is to end now.

    Attributes:
        number: of the signal.
    """

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number

    @property
    def exit_code(self) -> int:
        """As a shell gives it for a process that the signal has ended."""
        return 128 + self.number

    @property
    def words(self) -> str:
        """What to say."""
        return "interrupted" if self.number == signal.SIGINT else "terminated"


@contextmanager
def interruptible() -> Iterator[None]:
    """Within the block both signals raise `Interrupted`, once: what clears up is left in peace.

    A signal that its sender has the process ignore (`nohup`, a shell's background job) stays so.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {n: signal.getsignal(n) for n in _ANSWERED}
    answered = [n for n, handler in before.items() if handler not in (signal.SIG_IGN, None)]
    try:
        for number in answered:
            signal.signal(number, _answer)
        yield
    finally:
        for number in answered:
            signal.signal(number, before[number])


def _answer(number: int, frame: FrameType | None) -> None:
    if _inside_unit(frame):
        # the loader of Python units does not survive an exception of this kind
        again = threading.Timer(_AGAIN, _raise, (number,))
        again.daemon = True
        again.start()
        return
    for other in _ANSWERED:
        if signal.getsignal(other) is _answer:
            signal.signal(other, signal.SIG_IGN)
    raise Interrupted(number)


def _raise(number: int) -> None:
    with suppress(OSError, ValueError):
        signal.raise_signal(number)


def _inside_unit(frame: FrameType | None) -> bool:
    while frame is not None:
        if str(frame.f_globals.get("__name__", "")).startswith(_UNIT):
            return True
        frame = frame.f_back
    return False
