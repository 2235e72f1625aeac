"""The store of a map: every point as it comes, along the axes' values, for xarray to open."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import tomli_w

from ..output.store import StoredArray, StoredItems, open_store
from ..scene import Scene
from .axis import Axis


def open_map(
    path: Path,
    content: str,
    scene: Scene,
    x: Axis,
    y: Axis,
    strips: Mapping[str, str],
    *,
    along: str = "y",
    rows: int = 1,
) -> StoredItems:
    """Strips of the store of a map at that place, begun or continued.

    Args:
        content: kind of the map.
        strips: arrays of the grid, and what they mean; of text where that begins with `why`.
        along, rows: the slow axis, and how many of its values are in a strip.

    Raises:
        UserError: the store is another map's, or none.
    """
    shape = (len(y.values), len(x.values))
    strip = {
        name: StoredArray(
            ("y", "x"), shape, along, "str" if meaning.startswith("why") else "f8", rows, meaning
        )
        for name, meaning in strips.items()
    }
    made_for = {
        "content": content,
        "scene": tomli_w.dumps(scene.document),
        "x axis": _words(x),
        "y axis": _words(y),
    }
    coordinates = {"x": ("x", x.values), "y": ("y", y.values)}
    return open_store(path, made_for, {"strip": strip}, coordinates)["strip"]


def _words(axis: Axis) -> str:
    low, high = axis.values[[0, -1]].tolist()
    spaced = ", logarithmic" if axis.log else ""
    return f"{axis.path} = {low!r} to {high!r}, {len(axis.values)} values{spaced}"
