"""The store of a scatter: every chunk of machines as it comes, for xarray to open."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import tomli_w
from numpy.typing import NDArray

from ..output.store import StoredArray, StoredItems, open_store
from ..scene import Scene
from .vary import Variation


def open_scatter(
    path: Path,
    scene: Scene,
    variations: Sequence[Variation],
    seed: int,
    values: NDArray[np.float64],
    chunk: int,
) -> StoredItems:
    """The machines' outcomes in chunks, begun or gone on with.

    Args:
        values: (machines, variations).

    Raises:
        UserError: the store is another's, or none.
    """
    along = ("machine",), (len(values),), "machine"
    outcomes = {
        "residual": StoredArray(*along, chunk=chunk, meaning="amplitude, last revolution [m]"),
        "grade": StoredArray(*along, chunk=chunk, meaning="of ISO 21940-11, just met [mm/s]"),
        "settled": StoredArray(
            *along, chunk=chunk, meaning="1: the last two revolutions are alike"
        ),
        "merged": StoredArray(
            *along, chunk=chunk, meaning="1: identical weights cannot part though they would"
        ),
        "failure": StoredArray(*along, "str", chunk, "why the run failed"),
    }
    made_for = {
        "content": "scatter",
        "scene": tomli_w.dumps(scene.document),
        "variations": "\n".join(one.text for one in variations),
        "seed": str(seed),
        "number of machines": str(len(values)),
    }
    drawn = {one.path: ("machine", values[:, k]) for k, one in enumerate(variations)}
    return open_store(path, made_for, {"part": outcomes}, drawn)["part"]
