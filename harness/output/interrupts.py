"""Ctrl-C and SIGTERM end a command in order: folders are cleared, and one word is said.

The signal becomes an exception in the main thread.  C code that calls Python, as the loader of
Python units does, can swallow one or die of it.  So none is raised while a module that says
`SIGNALS_WAIT = True` is at work, one that was swallowed is raised anew, and a thread sees to it
that the process ends after some seconds whatever it hangs in.
"""

from __future__ import annotations

import multiprocessing
import os
import shutil
import signal
import socket
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from multiprocessing import resource_tracker
from types import FrameType
from typing import Any

_HANDLED = (signal.SIGINT, signal.SIGTERM)
_AGAIN = 0.005  # s until a signal that came at a bad moment is looked at anew
_TWICE = 0.5  # s after which a second signal is meant: `timeout` sends two at once
_LONGEST = 1e8  # s: more does not fit the timer everywhere
_NAMED_BY = ("TMPDIR", "TMP")  # the place of temporary files
_MATPLOTLIB = "MPLCONFIGDIR"  # the place of its configuration and cache
_GRACE = 15.0  # s to clear up in order


class Interrupted(BaseException):
    """The command is to end now.

    Attributes:
        number: of the signal.
    """

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number

    def __del__(self) -> None:
        if _block is not None:  # else it has arrived
            _block.again = True

    @property
    def exit_code(self) -> int:
        """As a shell gives it for a process that the signal has ended."""
        return 128 + self.number

    @property
    def words(self) -> str:
        """What to say."""
        return "interrupted" if self.number == signal.SIGINT else "terminated"


class _Late(BaseException):
    """The time is over: nothing that catches every `Exception` is to go on."""


class _SignalBlock(threading.Thread):
    """What has become of a signal within a block, and the thread that sees it through.

    Attributes:
        number: of the first signal.
        again: it is to be raised anew.
    """

    def __init__(self) -> None:
        super().__init__(daemon=True)
        self.number, self.since = 0, 0.0
        self.again = self.ours = self.left = False
        self._turn = threading.Lock()
        self._told, self._tell = socket.socketpair()
        self._tell.setblocking(False)
        # the thread learns of a signal even if the main thread never comes back from a C function
        self._before = signal.set_wakeup_fd(self._tell.fileno(), warn_on_full_buffer=False)
        self._hook, sys.unraisablehook = sys.unraisablehook, self._swallowed

    def answer(self, number: int, frame: FrameType | None) -> None:
        """Python's handler of both signals, in the main thread."""
        if not self.number:
            self.number, self.since = number, time.monotonic()
        elif not self.ours:
            if time.monotonic() - self.since > _TWICE:
                _give_up(number)
            return
        self.ours = False
        if not _must_wait(frame):
            raise Interrupted(self.number)
        self.again = True

    def run(self) -> None:
        """Wait for a signal, then for the end of the block."""
        number = int.from_bytes(self._told.recv(1), "little")
        until = time.monotonic() + _GRACE
        while not self.left:
            time.sleep(_AGAIN)
            with self._turn:
                if self.again and self.number and not self.left:
                    self.again, self.ours = False, True
                    _send(self.number)
            if time.monotonic() > until:
                _give_up(number)
        self._told.close()

    def leave(self) -> None:
        """The block is over."""
        with self._turn:
            self.left = True
        signal.set_wakeup_fd(self._before)
        self._tell.close()
        sys.unraisablehook = self._hook

    def _swallowed(self, unraisable: Any) -> None:
        if not isinstance(unraisable.exc_value, Interrupted):
            self._hook(unraisable)


_block: _SignalBlock | None = None
_folder = ""  # of temporary files


@contextmanager
def temporary_files() -> Iterator[None]:
    """All temporary files lie in one folder within the block, gone at its end.

    So do those of other programs that are begun in it: one that is killed leaves its own.  An
    interrupt between the making of a folder and the note of it thus leaves nothing.  Where no
    folder can be made the block runs all the same: what needs one says so itself.
    """
    global _folder
    try:
        folder = tempfile.TemporaryDirectory(prefix="autobalancer-", ignore_cleanup_errors=True)
    except OSError:
        yield
        return
    before, tempfile.tempdir = tempfile.tempdir, folder.name
    homeless = not os.access(os.path.expanduser("~"), os.W_OK) and _MATPLOTLIB not in os.environ
    # else matplotlib makes a folder here that it fails to find when the process ends
    names = (*_NAMED_BY, _MATPLOTLIB) if homeless else _NAMED_BY
    named = {name: os.environ.get(name) for name in names}
    os.environ.update(dict.fromkeys(names, folder.name))
    _folder = folder.name
    try:
        yield
    finally:
        for number in _HANDLED:
            signal.signal(number, signal.SIG_IGN)
        tempfile.tempdir = before
        for name, place in named.items():
            del os.environ[name]
            os.environ.update({name: place} if place is not None else {})
        folder.cleanup()


@contextmanager
def interruptible() -> Iterator[None]:
    """Within the block both signals raise `Interrupted`, once: what clears up is left in peace.

    A second signal, half a second later or more, ends the process as it is.  A signal that its
    sender has the process ignore (`nohup`, a shell's background job) stays so.
    """
    global _block
    if threading.current_thread() is not threading.main_thread() or _block is not None:
        yield
        return
    before = {n: signal.getsignal(n) for n in _HANDLED}
    handled = [n for n, handler in before.items() if handler not in (signal.SIG_IGN, None)]
    _block = block = _SignalBlock()
    block.start()
    try:
        for number in handled:
            signal.signal(number, block.answer)
        yield
    except Exception as error:
        if not block.number:
            raise
        # a C module that the interrupt met while it was imported turns it into an ImportError
        raise Interrupted(block.number) from error
    finally:
        _block = None
        block.leave()
        for number in handled:
            signal.signal(number, before[number])


@contextmanager
def raised_after(seconds: float, error: Exception) -> Iterator[None]:
    """Within the block `error` is raised after so many seconds, in the main thread.

    Elsewhere, and on systems that have no such timer, nothing is.
    """
    main = threading.current_thread() is threading.main_thread()
    if not main or not hasattr(signal, "setitimer"):
        yield
        return

    def late(_number: int, frame: FrameType | None) -> None:
        if _must_wait(frame):
            signal.setitimer(signal.ITIMER_REAL, _AGAIN)
        else:
            raise _Late

    before = signal.signal(signal.SIGALRM, late)
    try:
        signal.setitimer(signal.ITIMER_REAL, min(seconds, _LONGEST))
        yield
    except _Late:
        raise error from None
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


@contextmanager
def deaf_children(*numbers: int) -> Iterator[None]:
    """Processes begun meanwhile never hear these signals, not even before their code runs."""
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    resource_tracker.ensure_running()  # its start, else with the first process, would end the block
    before = signal.pthread_sigmask(signal.SIG_BLOCK, numbers)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _send(number: int) -> None:
    """A signal to the main thread, which may be waiting for something."""
    main = threading.main_thread().ident
    if hasattr(signal, "pthread_kill") and main is not None:
        signal.pthread_kill(main, number)
    else:
        signal.raise_signal(number)


def _must_wait(frame: FrameType | None) -> bool:
    while frame is not None:
        if frame.f_globals.get("SIGNALS_WAIT"):
            return True
        frame = frame.f_back
    return False


def _give_up(number: int) -> None:
    """End the process from whatever it is in; processes it began and temporary files go with it."""
    for process in multiprocessing.active_children():
        with suppress(OSError, ValueError):
            process.kill()
    if _folder:
        shutil.rmtree(_folder, ignore_errors=True)
    interrupt = Interrupted(number)
    with suppress(OSError):
        os.write(2, f"{interrupt.words}\n".encode())
    os._exit(interrupt.exit_code)
