"""How value references are read and written: looked up once for each combination of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from operator import itemgetter

from ..variables import Layout

# how stale the outputs of a unit are, ascending
FRESH, OBSERVED, COMPUTED, BEGINNING = range(4)

Key = tuple[int, ...]
Pick = Callable[[list[float]], list[float]]


class Readers(dict[Key, tuple[Pick, int]]):
    """What picks the Reals with these value references, and how stale the outputs may be for it.

    Raises:
        ValueError: a value reference is unknown.
    """

    def __init__(self, layout: Layout) -> None:
        super().__init__()
        self.layout = layout

    def __missing__(self, key: Key) -> tuple[Pick, int]:
        layout = self.layout
        known(key, len(layout.reals))
        last = max(key, default=0)
        level = FRESH
        if last < layout.inputs.stop:
            level = BEGINNING
        elif last < layout.computed.stop:
            level = OBSERVED
        where = _slice(key)
        pick: Pick = lambda real: [real[vr] for vr in key]  # noqa: E731
        self[key] = itemgetter(where) if isinstance(where, slice) else pick, level
        return self[key]


class Writers(dict[Key, tuple[slice | Key, bool]]):
    """Where the Reals with these value references go, and whether all of them are inputs.

    Raises:
        ValueError: a value reference is unknown, or that of an output.
    """

    def __init__(self, layout: Layout) -> None:
        super().__init__()
        self.layout = layout

    def __missing__(self, key: Key) -> tuple[slice | Key, bool]:
        layout = self.layout
        known(key, len(layout.reals))
        outputs = [layout.reals[vr].name for vr in key if vr >= layout.inputs.stop]
        if outputs:
            raise ValueError(f"{', '.join(outputs)}: outputs cannot be set")
        self[key] = _slice(key), all(vr >= layout.inputs.start for vr in key)
        return self[key]


def fixed(layout: Layout, key: Key) -> str:
    """Why these cannot be set while the unit runs."""
    names = ", ".join(layout.reals[vr].name for vr in key if vr < layout.inputs.start)
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
