"""The store of a map: every point as it comes."""

from __future__ import annotations

from pathlib import Path

import tomli_w

from ..output.store import StoredItems, open_store
from ..scene import Scene
from .axis import Axis


def open_map(path: Path, content: str, scene: Scene, x: Axis, y: Axis) -> StoredItems:
    """Strips of the store of a map at that place, begun or continued.

    Args:
        content: kind of the map.

    Raises:
        UserError: the store is another map's, or none.
    """
    made_for = {
        "content": content,
        "scene": tomli_w.dumps(scene.document),
        "x axis": _words(x),
        "y axis": _words(y),
    }
    return open_store(path, made_for)


def _words(axis: Axis) -> str:
    low, high = axis.values[[0, -1]].tolist()
    spaced = ", logarithmic" if axis.log else ""
    return f"{axis.path} = {low!r} to {high!r}, {len(axis.values)} values{spaced}"
