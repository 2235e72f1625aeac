"""The store of a map: every point as it comes, along the axes' values, for xarray to open."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import tomli_w

from ..output.store import StoredArray, StoredItems, open_store
from ..scene import Scene
from ..scene.replace import SPEED
from .axis import Axis


def open_map(
    path: Path, scene: Scene, x: Axis, y: Axis, rows: int, places: Sequence[tuple[int, int]]
) -> dict[str, StoredItems]:
    """Parts `strip` and `point` of the store of a map at that place, begun or gone on with.

    Args:
        rows: values of the slow axis in a strip; it is x where y is the speed.
        places: of the points to be co-simulated, on both axes.

    Raises:
        UserError: the store is another map's, or none.
    """
    grid = ("y", "x"), (len(y.values), len(x.values)), "x" if y.path == SPEED else "y"
    strips = {
        "growth": StoredArray(*grid, chunk=rows, meaning="largest growth rate [1/s]"),
        "criterion": StoredArray(*grid, chunk=rows, meaning="negative: balanced by the criterion"),
        "why_not": StoredArray(*grid, "str", rows, "why there is no growth rate"),
        "whirl": StoredArray(
            *grid, chunk=rows, meaning="amplitude that remains where weights cannot balance [m]"
        ),
        "whirl_growth": StoredArray(*grid, chunk=rows, meaning="growth rate of that whirl [1/s]"),
    }
    points = {
        "cosim_growth": StoredArray(
            ("point",), (len(places),), "point", meaning="largest growth rate, co-simulated [1/s]"
        ),
        "cosim_why_not": StoredArray(
            ("point",), (len(places),), "point", "str", meaning="why there is none"
        ),
    }
    i, j = np.array(places, dtype=int).reshape(-1, 2).T
    along = {"x": ("x", x.values), "y": ("y", y.values)}
    made_for = {
        **_made_for("stability map", scene, x, y),
        "number of co-simulated points": str(len(places)),
    }
    parts = {"strip": strips, "point": points} if places else {"strip": strips}
    if places:
        along |= {"point_x": ("point", x.values[i]), "point_y": ("point", y.values[j])}
    return open_store(path, made_for, parts, along)


def open_run_map(path: Path, scene: Scene, x: Axis, y: Axis) -> StoredItems:
    """The rows of a map of runs, one for every value of y, begun or gone on with.

    Raises:
        UserError: the store is another map's, or none.
    """
    grid = ("y", "x"), (len(y.values), len(x.values)), "y"
    rows = {
        "residual": StoredArray(*grid, meaning="amplitude in the last revolution [m]"),
        "settled": StoredArray(*grid, meaning="1: the last two revolutions are alike"),
        "failure": StoredArray(*grid, "str", meaning="why the run failed"),
    }
    along = {"x": ("x", x.values), "y": ("y", y.values)}
    return open_store(path, _made_for("map of runs", scene, x, y), {"row": rows}, along)["row"]


def _made_for(content: str, scene: Scene, x: Axis, y: Axis) -> dict[str, str]:
    return {
        "content": content,
        "scene": tomli_w.dumps(scene.document),
        "x axis": _words(x),
        "y axis": _words(y),
    }


def _words(axis: Axis) -> str:
    low, high = axis.values[[0, -1]].tolist()
    spaced = ", logarithmic" if axis.log else ""
    return f"{axis.path} = {low!r} to {high!r}, {len(axis.values)} values{spaced}"
