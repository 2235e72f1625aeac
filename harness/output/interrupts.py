"""Ctrl-C, SIGTERM and a time that is over end a command: files are removed, one line is said.

The process ends where it is, without an exception: C code that calls Python, as the loader of
Python units does, can swallow one or die of it, and a C module that is being imported turns it into
an ImportError.  What must not stay behind lies in `temporary_files`, or is one of the drafts of
`fmus.whole_files`.  A store and worker processes bear that this one is gone.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType

from ...fmus.whole_files import drafts

_SAID: dict[int, tuple[Callable[[], str], int]] = {
    signal.SIGINT: (lambda: "interrupted", 130),
    signal.SIGTERM: (lambda: "terminated", 143),
}
_TOO_LATE = 2  # exit code, that of wrong input
_LONGEST = 1e8  # s: more does not fit the timer everywhere
_GRACE = 1.0  # s for the main thread to come back from C code
_CLEARING = 1.0  # s in which other threads may still write into a folder that is removed
_NAMED_BY = ("TMPDIR", "TEMP", "TMP")  # the place of temporary files
_MATPLOTLIB = "MPLCONFIGDIR"  # the place of its configuration and cache
_CLEAR_LINE = b"\r\x1b[K\x1b[?25h"  # takes a progress bar away and shows the cursor again
_folder = ""  # of temporary files
_ending = threading.Lock()  # held by the thread that ends the process
_unbroken = threading.Lock()  # held within a block of `unbroken`
_put_off: list[int] = []  # signals that came within it
_STARTING = 20.0  # s that another thread waits for such a block: a busy machine begins slowly


def answer_signals() -> None:
    """From now on Ctrl-C and SIGTERM end the process with exit code 130 or 143.

    A signal that its sender has the process ignore (`nohup`, a shell's background job) stays so.
    """
    for number in _SAID:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _answer)
    # a thread learns of a signal even if the main thread never comes back from a C function
    pipe, end = os.pipe()
    if os.name != "nt":
        os.set_blocking(end, False)
    signal.set_wakeup_fd(end, warn_on_full_buffer=False)
    threading.Thread(target=_answer_late, args=(pipe,), daemon=True).start()


@contextmanager
def ended_after(seconds: float, words: Callable[[], str]) -> Iterator[None]:
    """Within the block, of the main thread, the process ends after a time with words for then.

    On systems that have no such timer nothing happens.
    """
    if not hasattr(signal, "setitimer"):
        yield
        return
    _SAID[signal.SIGALRM] = words, _TOO_LATE
    before = signal.signal(signal.SIGALRM, _answer)
    signal.setitimer(signal.ITIMER_REAL, min(seconds, _LONGEST))
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


@contextmanager
def unbroken() -> Iterator[None]:
    """Within the block, of the main thread, a signal waits: it ends the process after the block.

    To be short, as the start of a process: one that is not yet known here could not be ended.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    try:
        with _unbroken:
            yield
    finally:
        if _put_off:
            _answer(_put_off[0], None)


@contextmanager
def temporary_files() -> Iterator[None]:
    """All temporary files lie in one folder within the block, gone at its end.

    So do those of other programs that are begun in it: one that is killed leaves its own.  Where no
    folder can be made the block runs all the same: what needs one says so itself.
    """
    import shutil
    import tempfile

    global _folder
    try:
        # tempfile would try a place out by a file there, which a signal leaves behind
        home = next((os.environ[name] for name in _NAMED_BY if name in os.environ), "/tmp")
        _folder = os.path.join(home, f"autobalancer-{os.urandom(6).hex()}")
        os.mkdir(_folder, 0o700)
    except OSError:
        yield
        return
    before, tempfile.tempdir = tempfile.tempdir, _folder
    homeless = not os.access(os.path.expanduser("~"), os.W_OK) and _MATPLOTLIB not in os.environ
    # else matplotlib makes a folder here that it fails to find when the process ends
    names = (*_NAMED_BY, _MATPLOTLIB) if homeless else _NAMED_BY
    named = {name: os.environ.get(name) for name in names}
    os.environ.update(dict.fromkeys(names, _folder))
    try:
        yield
    finally:
        tempfile.tempdir = before
        for name, place in named.items():
            del os.environ[name]
            os.environ.update({name: place} if place is not None else {})
        shutil.rmtree(_folder, ignore_errors=True)


def _answer(number: int, _frame: FrameType | None) -> None:
    """Python's handler of the signals, in the main thread."""
    if _unbroken.locked():  # by this thread
        _put_off.append(number)
        return
    for each in _SAID:
        signal.signal(each, signal.SIG_IGN)
    _end(*_SAID[number])


def _answer_late(pipe: int) -> None:
    """In a thread: answer a signal that the main thread does not answer."""
    while (number := os.read(pipe, 1)[0]) not in _SAID:
        pass
    time.sleep(_GRACE)
    _unbroken.acquire(timeout=_STARTING)
    _end(*_SAID[number])


def end_process(words: str, code: int) -> None:
    """End the process from whatever it is in, with a line of words and an exit code."""
    _end(lambda: words, code)


def _end(words: Callable[[], str], code: int) -> None:
    """End the process from whatever it is in; its worker processes and files go with it."""
    _ending.acquire(timeout=2.0 * _CLEARING)  # the other thread may be at it, and hang
    with suppress(KeyError, AttributeError, OSError, ValueError):
        for process in sys.modules["multiprocessing"].active_children():
            process.kill()
    until = time.monotonic() + _CLEARING
    while os.path.isdir(_folder) and time.monotonic() < until:
        sys.modules["shutil"].rmtree(_folder, ignore_errors=True)
    for draft in tuple(drafts):
        with suppress(OSError):
            draft.unlink()
    with suppress(OSError):
        os.write(2, (_CLEAR_LINE if os.isatty(2) else b"") + f"{words()}\n".encode())
    os._exit(code)
