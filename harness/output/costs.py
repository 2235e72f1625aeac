"""What work will cost, told from its first steps, and refused where that is more than is wanted."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING

from ..errors import UserError
from .interrupts import ended_after

if TYPE_CHECKING:
    from .workers import Progress

DEFAULT = "1h"
MEASURED = 2.0  # s of work from which the rest is told: enough for three digits of its rate
DOUBT = 10.0  # times the limit that a first estimate may be wrong: workers begin, machines are busy
LATEST = 0.1  # of the limit: later too much is done to be dropped
_SECONDS = {"s": 1.0, "m": 60.0, "h": 3600.0, "d": 86400.0, "": 1.0}
_TIME = re.compile(r"(?P<number>\d+(?:\.\d*)?|\.\d+)\s*(?P<unit>[smhd]?)")


def seconds_of(text: str) -> float:
    """Seconds of a time such as 90s, 30m, 2h or 1d.

    Raises:
        UserError: it is none.
    """
    found = _TIME.fullmatch(text.strip())
    if not found or float(found["number"]) <= 0.0:
        raise UserError(f"--at-most {text!r}: must be a time such as 90s, 30m, 2h or 1d")
    return float(found["number"]) * _SECONDS[found["unit"]]


def free_memory() -> float:
    """Memory that can be had without swapping [bytes]; infinite where the system does not say."""
    with suppress(OSError), open("/proc/meminfo", encoding="ascii") as lines:
        for line in lines:
            if line.startswith("MemAvailable:"):
                return 1024.0 * float(line.split()[1])
    return float("inf")


def refuse_beyond(free: float, needed: float, what: str, instead: str) -> None:
    """Refuse what needs more memory than is free [bytes].

    Args:
        what: needs it, with the keys that make it so.
        instead: what else to do.

    Raises:
        UserError: with both figures.
    """
    if needed > free:
        raise UserError(
            f"{what} about {needed / 1e9:.3g} GB of memory, {free / 1e9:.3g} GB are free; {instead}"
        )


def in_words(seconds: float) -> str:
    """A time in the unit that suits it."""
    for unit, size in (("d", 86400.0), ("h", 3600.0), ("m", 60.0)):
        if seconds >= 2.0 * size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds:.3g} s"


@contextmanager
def limited(at_most: str, key: str) -> Iterator[None]:
    """Work whose parts are too unlike for an estimate: the command ends when the time is over.

    Args:
        key: and its value, which make the work so long.

    Raises:
        UserError: `at_most` is no time.
    """
    with ended_after(seconds_of(at_most), _late(key, at_most)):
        yield


def _late(key: str, at_most: str) -> str:
    """Message of work that took longer than `at_most`."""
    return f"{key}: not done within --at-most {at_most}"


def within(
    at_most: str,
    key: str,
    progress: Progress,
    clock: Callable[[], float] = time.perf_counter,
) -> Progress:
    """`progress`, ended as soon as the work is seen to take longer than `at_most`.

    The rate is measured from the first report on, so that loading does not count, and anew where it
    turns out that there is more to do than was known.

    Args:
        key: and its value, which make the work so long.

    Raises:
        UserError: at once, `at_most` is no time; later, the work would take too long.
    """
    limit = seconds_of(at_most)
    measured = min(MEASURED, 0.5 * limit)
    first: tuple[float, float] | None = None
    judged = False

    def report(done: float) -> None:
        nonlocal first, judged
        now = clock()
        if first is None or done < first[1]:
            first = now, done
        elapsed, part = now - first[0], done - first[1]
        early = elapsed <= max(LATEST * limit, 5.0 * measured)
        # what has not moved has no rate; it is refused when the time is over
        known = part > 0.0 or elapsed > limit
        if known and measured <= elapsed and done < 1.0 and (early or not judged):
            judged = True
            if not part > 0.0:
                raise UserError(_late(key, at_most))
            total = elapsed / part
            if total > limit * (1.0 + DOUBT * measured / elapsed):
                raise UserError(
                    f"{key}: would take about {in_words(total)}, more than --at-most {at_most}; "
                    f"in {in_words(elapsed)} {part:.2g} of it was done"
                )
        progress(done)

    return report
