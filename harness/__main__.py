"""Entry point of `autobalancer`; Ctrl-C before a command is at work is answered in a word, too."""

from __future__ import annotations

import os
import signal
from types import FrameType


def main() -> None:
    """Load the commands and run the one that is asked for."""
    loading = True

    def end(number: int, _frame: FrameType | None) -> None:
        os.write(2, b"interrupted\n")
        if loading:  # C modules that are being imported turn any exception into an ImportError
            os._exit(128 + number)
        raise SystemExit(128 + number)

    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # else it is to be ignored
        signal.signal(signal.SIGINT, end)
    from .cli import main as commands

    loading = False
    commands()


if __name__ == "__main__":
    main()
