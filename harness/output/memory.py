"""Memory that is free, and a refusal of what needs more."""

from __future__ import annotations

from contextlib import suppress

from ..errors import UserError


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
