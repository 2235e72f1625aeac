"""The store of a map: every point as it comes, along the axes' values, for xarray to open."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import tomli_w
from numpy.typing import ArrayLike

from ..output.store import StoredArray, StoredItems, open_store
from ..scene import Scene
from .axis import Axis

POINTS = {
    "cosim_growth": "largest growth rate, co-simulated [1/s]",
    "cosim_why_not": "why there is none",
}


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
    places: Sequence[tuple[int, int]] = (),
) -> dict[str, StoredItems]:
    """Parts `strip` and `point` of the store of a map at that place, begun or gone on with.

    Args:
        content: kind of the map.
        strips: arrays of the grid, and what they mean; of text where that begins with `why`.
        along, rows: the slow axis, and how many of its values are in a strip.
        places: of the points to be co-simulated, on both axes.

    Raises:
        UserError: the store is another map's, or none.
    """
    shape, count = (len(y.values), len(x.values)), len(places)
    parts = {
        "strip": {
            name: StoredArray(("y", "x"), shape, along, _kind(meaning), rows, meaning)
            for name, meaning in strips.items()
        }
    }
    coordinates: dict[str, tuple[str, ArrayLike]] = {"x": ("x", x.values), "y": ("y", y.values)}
    if places:
        parts["point"] = {
            name: StoredArray(("point",), (count,), "point", _kind(meaning), 1, meaning)
            for name, meaning in POINTS.items()
        }
        i, j = np.array(places, dtype=int).T
        coordinates |= {"point_x": ("point", x.values[i]), "point_y": ("point", y.values[j])}
    made_for = {
        "content": content,
        "scene": tomli_w.dumps(scene.document),
        "x axis": _words(x),
        "y axis": _words(y),
        "number of co-simulated points": str(count),
    }
    return open_store(path, made_for, parts, coordinates)


def _kind(meaning: str) -> str:
    return "str" if meaning.startswith("why") else "f8"


def _words(axis: Axis) -> str:
    low, high = axis.values[[0, -1]].tolist()
    spaced = ", logarithmic" if axis.log else ""
    return f"{axis.path} = {low!r} to {high!r}, {len(axis.values)} values{spaced}"
