"""Who does the work: processes of this machine, or a Dask cluster."""

from __future__ import annotations

import logging
import multiprocessing
import os
import signal
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

from ..errors import UserError
from .interrupts import deaf_children
from .store import EXTRA
from .workers import Workers

SIGNALS_WAIT = True  # an interrupt while a cluster begins would leave its processes behind
LOCAL = "local"
_IN_PEACE = "import signal\nfor n in (2, 15): signal.signal(n, signal.SIG_IGN)"  # we answer
_PATIENCE = 10.0  # s for a scheduler to answer


@contextmanager
def who_works(cluster: str | None) -> Iterator[Workers]:
    """As many processes as there are cores; on request the executor of a Dask cluster.

    Args:
        cluster: address of its scheduler such as `tcp://10.0.0.1:8786`, or `local` for one that is
            begun here and ended with the block.

    Raises:
        UserError: Dask is not installed, or no scheduler answers there.
    """
    cores = os.cpu_count() or 1
    if cluster is None:
        yield cores
        return
    try:
        from distributed import Client, LocalCluster
    except ImportError:
        raise UserError(f"--cluster {cluster}: needs Dask: {EXTRA}") from None
    with ExitStack() as stack:
        if cluster == LOCAL:
            stack.callback(_outlive)
            with deaf_children(signal.SIGINT, signal.SIGTERM):
                address: str | LocalCluster = stack.enter_context(
                    LocalCluster(
                        n_workers=cores,
                        threads_per_worker=1,
                        dashboard_address=None,
                        # of its own HTTP server: any port, others may work beside this one
                        scheduler_kwargs={"dashboard_address": ":0"},
                        silence_logs=logging.CRITICAL,
                        local_directory=tempfile.gettempdir(),
                        env={"TMPDIR": tempfile.gettempdir()},
                        preload=_IN_PEACE,
                    )
                )
        else:
            address = cluster
        try:
            client = stack.enter_context(Client(address, timeout=_PATIENCE))
        except (OSError, ValueError) as error:
            raise UserError(f"--cluster {cluster}: no scheduler answers: {error}") from error
        yield client.get_executor()


def _outlive() -> None:
    """See every process begun here end: a late one writes into folders removed by then."""
    for process in multiprocessing.active_children():
        process.kill()
        process.join()
