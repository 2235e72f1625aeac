"""The store of a map: every point as it comes, along the axes' values, for xarray to open."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import tomli_w

from ..output.store import Part, Variable, open_store
from ..scene import Scene
from .axis import Axis

ROWS = 8  # values of the slower axis a batch, so that progress is seen


def open_map(
    path: Path, scene: Scene, x: Axis, y: Axis, transposed: bool, places: Sequence[tuple[int, int]]
) -> dict[str, Part]:
    """Parts `strip` and `point` of the store of a map at that place, begun or gone on with.

    Args:
        transposed: strips follow each other along x.
        places: of the points to be co-simulated, on both axes.

    Raises:
        UserError: the store is another map's, or none.
    """
    grid = ("y", "x"), (len(y.values), len(x.values)), "x" if transposed else "y"
    strips = {
        "growth": Variable(*grid, chunk=ROWS, meaning="largest growth rate [1/s]"),
        "criterion": Variable(*grid, chunk=ROWS, meaning="negative: balanced by the criterion"),
        "why_not": Variable(*grid, "str", ROWS, "why there is no growth rate"),
    }
    points = {
        "cosim_growth": Variable(
            ("point",), (len(places),), "point", meaning="largest growth rate, co-simulated [1/s]"
        ),
        "cosim_why_not": Variable(
            ("point",), (len(places),), "point", "str", meaning="why there is none"
        ),
    }
    columns, rows = np.array(places, dtype=int).reshape(-1, 2).T
    along = {"x": ("x", x.values), "y": ("y", y.values)}
    made_for = {
        "content": "stability map",
        "scene": tomli_w.dumps(scene.document),
        **{f"{name} axis": _words(axis) for name, axis in (("x", x), ("y", y))},
        "number of co-simulated points": str(len(places)),
    }
    parts = {"strip": strips, "point": points} if places else {"strip": strips}
    if places:
        along |= {"point_x": ("point", x.values[columns]), "point_y": ("point", y.values[rows])}
    return open_store(path, made_for, parts, along)


def _words(axis: Axis) -> str:
    low, high = axis.values[[0, -1]].tolist()
    spaced = ", logarithmic" if axis.log else ""
    return f"{axis.path} = {low!r} to {high!r}, {len(axis.values)} values{spaced}"
