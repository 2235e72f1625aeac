"""The same work on many things, in as many processes as asked for."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from typing import Any, TypeVar

Item = TypeVar("Item")
Outcome = TypeVar("Outcome")


def spread(
    work: Callable[[Item], Outcome],
    items: Sequence[Item],
    workers: int = 1,
    progress: Callable[[float], None] | None = None,
) -> list[Outcome]:
    """Outcomes of `work` in the items' order.

    Args:
        work: a function at the top of a module, so that other processes can import it.
        workers: processes; 1 stays in this one.
        progress: called with the finished fraction.

    Raises:
        Exception: the first one that `work` raises; what has not begun is dropped.
    """
    report = progress or (lambda fraction: None)
    if min(workers, len(items)) < 2:
        done = []
        for number, item in enumerate(items, start=1):
            done.append(work(item))
            report(number / len(items))
        return done
    outcomes: dict[int, Any] = {}
    context = get_context("spawn")  # threads of numerical libraries do not survive a fork
    with ProcessPoolExecutor(min(workers, len(items)), context) as pool:
        futures = {pool.submit(work, item): i for i, item in enumerate(items)}
        try:
            for future in as_completed(futures):
                outcomes[futures[future]] = future.result()
                report(len(outcomes) / len(items))
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return [outcomes[i] for i in range(len(items))]
