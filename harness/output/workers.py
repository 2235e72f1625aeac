"""The same work on many things: in this process, in several, or on an executor of the caller's.

Any `concurrent.futures.Executor` will do, such as those of Dask and mpi4py; processes made here
are ended at once, and their temporary files removed, when the work ends early.
"""

from __future__ import annotations

import multiprocessing
import os
import shutil
import signal
import sys
import tempfile
import threading
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    Executor,
    Future,
    ProcessPoolExecutor,
    wait,
)
from contextlib import closing, contextmanager
from itertools import islice
from multiprocessing import resource_tracker
from typing import Any, Protocol, TypeVar

from ..errors import SimulationError
from .interrupts import unbroken
from .terminal import is_quiet

Item = TypeVar("Item")
Outcome = TypeVar("Outcome")
Progress = Callable[[float], None]  # told the finished fraction
ItemProgress = Callable[[str, float], None]  # told what was just done, and the finished fraction
Workers = int | Executor  # so many processes, 1 being this one; or whoever does the work
PREFIX = "autobalancer-workers-"  # of the folder that holds their temporary files
UNGUARDED = (
    'a script whose work is done by several processes needs it under `if __name__ == "__main__":`, '
    "as each process reads the script first; or workers = 1"
)
AHEAD = 1000  # items given at a time to an executor of the caller's: enough for any cluster


class Kept(Protocol[Outcome]):
    """Outcomes by the items' numbers: a dictionary, or a part of a store that lasts."""

    def __len__(self) -> int: ...
    def __contains__(self, item: object, /) -> bool: ...
    def __getitem__(self, item: int, /) -> Outcome: ...
    def __setitem__(self, item: int, outcome: Outcome, /) -> None: ...


def as_they_come(
    work: Callable[[Item], Outcome],
    items: Sequence[Item],
    workers: Workers = 1,
) -> Generator[tuple[int, Outcome], None, None]:
    """Index and outcome of every item, whichever is ready first; to be closed (`closing`).

    Args:
        work: a function at the top of a module, so that other processes can import it.

    Raises:
        Exception: the first that `work` raises. Items that have not begun are then dropped, as they
            are when the caller is interrupted or closes the generator.
        SimulationError: a process was ended from outside.
    """
    with _executor(workers, len(items)) as executor:
        if executor is None:
            for index, item in enumerate(items):
                yield index, work(item)
            return
        futures: dict[Future[Outcome], int] = {}
        waiting = iter(range(len(items)))
        # processes of this machine have little in store, so that nothing needs to be taken back: a
        # pool that is ended stumbles over what was cancelled
        local = isinstance(executor, _Pool)
        try:
            for index in islice(waiting, 2 * (os.cpu_count() or 1) if local else AHEAD):
                futures[executor.submit(work, items[index])] = index
            while futures:
                for future in wait(futures, return_when=FIRST_COMPLETED).done:
                    done = futures.pop(future)
                    for index in islice(waiting, 1):
                        futures[executor.submit(work, items[index])] = index
                    yield done, future.result()
        except BrokenExecutor as error:
            hint = f"; {UNGUARDED}" if _is_script() else ""
            raise SimulationError(f"a process that did the work was ended{hint}") from error
        finally:
            for future in () if local else futures:
                future.cancel()


def in_order(
    work: Callable[[Item], Outcome],
    items: Sequence[Item],
    workers: Workers = 1,
    progress: Progress | None = None,
    kept: Kept[Outcome] | None = None,
) -> list[Outcome]:
    """Outcomes of `work` in the items' order; the first exception ends it, as `as_they_come`.

    Args:
        kept: outcomes there already, which are not worked for again; the others come to them.
    """
    outcomes: Kept[Any] = {} if kept is None else kept
    left = [index for index in range(len(items)) if index not in outcomes]
    if progress and len(left) < len(items):
        progress(len(outcomes) / len(items))
    with closing(as_they_come(work, [items[index] for index in left], workers)) as ready:
        for number, outcome in ready:
            outcomes[left[number]] = outcome
            if progress:
                progress(len(outcomes) / len(items))
    return [outcomes[index] for index in range(len(items))]


@contextmanager
def processes(workers: int) -> Iterator[Executor]:
    """So many processes, ended at once if the block is left by an exception."""
    if getattr(multiprocessing.current_process(), "_inheriting", False):
        sys.exit(UNGUARDED)  # this one is being made, and reads the script that makes it
    # afresh: threads of numerical libraries do not survive a fork
    context = multiprocessing.get_context("spawn")
    folder = tempfile.TemporaryDirectory(prefix=PREFIX, ignore_cleanup_errors=True)
    _start_tracker()
    with folder as directory:
        pool = _Pool(workers, context, _begin, (directory, is_quiet.get()))
        try:
            yield pool
        except BaseException:
            for process in (pool._processes or {}).values():
                process.terminate()
            raise
        finally:
            pool.shutdown()


def _is_script() -> bool:
    """Whether a script of the user's runs: processes that are made read it."""
    main = sys.modules["__main__"]
    return hasattr(main, "__file__") and not (main.__package__ or "").startswith("autobalancer")


@contextmanager
def _executor(workers: Workers, items: int) -> Iterator[Executor | None]:
    """One that is given is used and left as it is; None where this process does the work."""
    if isinstance(workers, Executor):
        yield workers
    elif min(workers, items) < 2:
        yield None
    else:
        with processes(min(workers, items)) as executor:
            yield executor


def _start_tracker() -> None:
    """Start what removes the semaphores of a process that was killed, and let it do so in silence.

    Its start with the first process would unblock the signal that `_Pool` blocks.
    """
    if os.name == "nt":
        return
    before = os.environ.get("PYTHONWARNINGS", "")
    os.environ["PYTHONWARNINGS"] = "ignore::UserWarning"
    try:
        resource_tracker.ensure_running()
    finally:
        os.environ["PYTHONWARNINGS"] = before


class _Pool(ProcessPoolExecutor):
    """Processes that ignore Ctrl-C even while their interpreter loads.

    A signal that ends this process waits until they are begun: one that has not yet been told its
    work would say that its pipe broke.
    """

    def submit(self, *arguments: Any, **options: Any) -> Future[Any]:
        with unbroken():
            if not hasattr(signal, "pthread_sigmask"):  # Windows
                return super().submit(*arguments, **options)
            before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
            try:
                return super().submit(*arguments, **options)  # begins the processes
            finally:
                signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _begin(directory: str, quiet: bool) -> None:
    """In a new process: the one that started it answers Ctrl-C, and clears its files away."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    tempfile.tempdir = directory
    is_quiet.set(quiet)
    threading.Thread(target=_follow, args=(directory,), daemon=True).start()


def _follow(directory: str) -> None:
    """End with the process that started this one, should it be killed: its pool would not tell."""
    parent = multiprocessing.parent_process()
    assert parent is not None
    parent.join()
    shutil.rmtree(directory, ignore_errors=True)
    os._exit(1)
