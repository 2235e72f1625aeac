"""Who does the work: processes of this machine, or a Dask cluster."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

from ..errors import UserError
from .workers import Workers

EXTRA = 'pip install "autobalancer[large]"'
_TIMEOUT = 10.0  # s for a scheduler to answer


@contextmanager
def who_works(cluster: str | None) -> Iterator[Workers]:
    """As many processes as there are cores; with an address the executor of a Dask cluster.

    Args:
        cluster: address of its scheduler such as `tcp://10.0.0.1:8786`.

    Raises:
        UserError: Dask is not installed, or no scheduler answers there.
    """
    if cluster is None:
        yield os.cpu_count() or 1
        return
    try:
        from distributed import Client
    except ImportError:
        raise UserError(f"--cluster {cluster}: needs Dask: {EXTRA}") from None
    try:
        client = Client(cluster, timeout=_TIMEOUT)
    except (OSError, ValueError) as error:
        raise UserError(f"--cluster {cluster}: no scheduler answers: {error}") from error
    with client:
        yield client.get_executor()
