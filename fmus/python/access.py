"""How value references are read and written: looked up once for each combination of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from operator import itemgetter

from ..variables import Layout

# how stale the outputs of a unit are, ascending
FRESH, OBSERVED, COMPUTED, BEGINNING = range(4)

Key = tuple[int, ...]


class Access:
    """Access to the Reals of units of the same sizes.

    Attributes:
        readers: value references -> what picks them out of all Reals, and how stale the outputs may
            be for it.
        writers: value references -> where they go, and whether all of them are inputs.
    """

    def __init__(self, layout: Layout) -> None:
        self.layout = layout
        self.readers: dict[Key, tuple[Callable[[list[float]], list[float]], int]] = {}
        self.writers: dict[Key, tuple[slice | Key, bool]] = {}

    def reader(self, key: Key) -> tuple[Callable[[list[float]], list[float]], int]:
        """A new entry of `readers`; raises ValueError for an unknown value reference."""
        layout = self.layout
        known(key, len(layout.reals))
        last = max(key, default=0)
        level = FRESH
        if last < layout.inputs.stop:
            level = BEGINNING
        elif last < layout.computed.stop:
            level = OBSERVED
        where = _slice(key)
        if isinstance(where, slice):
            pick: Callable = itemgetter(where)
        else:

            def pick(real: list[float]) -> list[float]:
                return [real[vr] for vr in key]

        self.readers[key] = pick, level
        return pick, level

    def writer(self, key: Key) -> tuple[slice | Key, bool]:
        """A new entry of `writers`; raises ValueError for what cannot be set."""
        layout = self.layout
        known(key, len(layout.reals))
        outputs = [layout.reals[vr].name for vr in key if vr >= layout.inputs.stop]
        if outputs:
            raise ValueError(f"{', '.join(outputs)}: outputs cannot be set")
        self.writers[key] = _slice(key), all(vr >= layout.inputs.start for vr in key)
        return self.writers[key]

    def fixed(self, key: Key) -> str:
        """Why these cannot be set while the unit runs."""
        first = self.layout.inputs.start
        names = ", ".join(self.layout.reals[vr].name for vr in key if vr < first)
        return f"{names}: fixed once initialisation has ended"


def known(vrs: Sequence[int], count: int) -> None:
    """Raise ValueError for value references that do not exist."""
    unknown = [vr for vr in vrs if not 0 <= vr < count]
    if unknown:
        raise ValueError(f"value references {unknown}: unknown, there are 0 to {count - 1}")


def _slice(key: Key) -> slice | Key:
    """One slice where the value references are contiguous: a group is exchanged as a whole."""
    if key and key == tuple(range(key[0], key[0] + len(key))):
        return slice(key[0], key[0] + len(key))
    return key
