"""What the tests of interrupts share."""

from __future__ import annotations

import signal
from collections.abc import Callable

import pytest


@pytest.fixture
def answering() -> Callable[[], None]:
    """For `preexec_fn`: children of a shell's background job would ignore Ctrl-C."""

    def answer() -> None:
        signal.signal(signal.SIGINT, signal.SIG_DFL)

    return answer
