"""The same work on many things: in this process, in several, or on an executor of the caller's.

Any `concurrent.futures.Executor` will do, such as those of Dask and mpi4py; processes made here
are ended at once, and their temporary files removed, when the work ends early.
"""

from __future__ import annotations

import signal
import tempfile
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import (
    BrokenExecutor,
    Executor,
    Future,
    ProcessPoolExecutor,
    as_completed,
)
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from multiprocessing.context import SpawnContext, SpawnProcess
from typing import Any, Generic, TypeVar

from ..errors import SimulationError

Item = TypeVar("Item")
Outcome = TypeVar("Outcome")
Progress = Callable[[float], None]  # told the finished fraction
ItemProgress = Callable[[str, float], None]  # told what was just done, and the finished fraction
Workers = int | Executor  # so many processes, 1 being this one; or whoever does the work
PREFIX = "autobalancer-workers-"  # of the folder that holds their temporary files
Kinds = tuple[type[Exception], ...]


@dataclass(frozen=True)
class Failed(Generic[Item]):
    """In the place of an outcome: the item that has none, and why."""

    item: Item
    error: Exception


def as_they_come(
    work: Callable[[Item], Outcome],
    items: Sequence[Item],
    workers: Workers = 1,
    isolate: Kinds = (),
) -> Iterator[tuple[int, Outcome | Failed[Item]]]:
    """Index and outcome of every item, whichever is ready first.

    Args:
        work: a function at the top of a module, so that other processes can import it.
        isolate: exceptions of `work` that cost their item alone, which is then `Failed`.

    Raises:
        Exception: any other one that `work` raises; what has not begun is dropped, as it is when
            the caller is interrupted or wants no more.
        SimulationError: a process was ended from outside.
    """
    with _executor(workers, len(items)) as executor:
        if executor is None:
            for index, item in enumerate(items):
                yield index, _outcome(partial(work, item), item, isolate)
            return
        futures: dict[Future[Outcome], int] = {}
        try:
            futures = {executor.submit(work, item): i for i, item in enumerate(items)}
            for future in as_completed(futures):
                index = futures[future]
                yield index, _outcome(future.result, items[index], isolate)
        except BrokenExecutor as error:
            raise SimulationError(f"a process that did the work was ended: {error}") from error
        finally:
            for future in futures:
                future.cancel()


def in_order(
    work: Callable[[Item], Outcome],
    items: Sequence[Item],
    workers: Workers = 1,
    progress: Progress | None = None,
) -> list[Outcome]:
    """Outcomes of `work` in the items' order; the first exception ends it, as `as_they_come`."""
    outcomes: dict[int, Any] = {}
    for index, outcome in as_they_come(work, items, workers):
        outcomes[index] = outcome
        if progress:
            progress(len(outcomes) / len(items))
    return [outcomes[index] for index in range(len(items))]


def _outcome(ask: Callable[[], Outcome], item: Item, isolate: Kinds) -> Outcome | Failed[Item]:
    try:
        return ask()
    except isolate as error:
        return Failed(item, error)


@contextmanager
def processes(workers: int) -> Iterator[Executor]:
    """So many processes, ended at once if the block is left by an exception."""
    context = _Context()
    folder = tempfile.TemporaryDirectory(prefix=PREFIX, ignore_cleanup_errors=True)
    with folder as directory:
        pool = ProcessPoolExecutor(workers, context, _begin, (directory,))
        try:
            yield pool
        except BaseException:
            for process in context.started:
                if process.pid is not None:  # else it never began
                    process.terminate()
            raise
        finally:
            pool.shutdown(cancel_futures=True)


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


class _Context(SpawnContext):
    """Starts processes afresh (threads of numerical libraries do not survive a fork), noting them.

    Attributes:
        started: every process.
    """

    def __init__(self) -> None:
        self.started: list[SpawnProcess] = []

    def Process(self, *arguments: Any, **options: Any) -> SpawnProcess:  # type: ignore[override]
        process = SpawnProcess(*arguments, **options)
        self.started.append(process)
        return process


def _begin(directory: str) -> None:
    """In a new process: the one that started it answers Ctrl-C, and clears its files away."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    tempfile.tempdir = directory
