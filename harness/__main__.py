"""Entry point of `autobalancer`; signals before a command is at work are answered in a word."""

from __future__ import annotations

import os
import signal
from types import FrameType


def main() -> None:
    """Load the commands and run the one that is asked for."""
    loading = True

    def end(number: int, _frame: FrameType | None) -> None:
        os.write(2, b"interrupted\n" if number == signal.SIGINT else b"terminated\n")
        if loading:  # C modules that are being imported turn any exception into an ImportError
            os._exit(128 + number)
        raise SystemExit(128 + number)

    for number in (signal.SIGINT, signal.SIGTERM):
        if signal.getsignal(number) is not signal.SIG_IGN:  # else it is to be ignored
            signal.signal(number, end)
    from .cli import main as commands

    loading = False
    commands()


if __name__ == "__main__":
    main()
