"""The points of a map: computed side by side, and stored as they come."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import tomli_w

from ..output.store import StoredItems, open_store
from ..output.workers import Progress, Workers, in_order
from ..scene import Scene
from .axis import Axis


def compute_points(
    function: Callable[[Any], Any],
    jobs: Sequence[Any],
    content: str,
    scene: Scene,
    axes: tuple[Axis, Axis],
    *,
    workers: Workers = 1,
    progress: Progress | None = None,
    store: str | Path | None = None,
) -> list[tuple[Any, ...]]:
    """What the function finds for every job, by result: parts of the grids of a map.

    Args:
        content: kind of the map, see `open_map`.
        axes: x and y.
        workers, progress, store: as `Scene.map`.
    """
    kept = None if store is None else open_map(store, content, scene, *axes)
    return list(zip(*in_order(function, jobs, workers, progress, kept), strict=True))


def open_map(path: str | Path, content: str, scene: Scene, x: Axis, y: Axis) -> StoredItems:
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
