"""Arrays as annotations name them; shapes stand in the docstrings."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complexfloating]
Indices = NDArray[np.intp]

Numbers = NDArray[Any]  # floats, or the objects that a proof computes with instead


def zeros(shape: tuple[int, ...], like: Numbers) -> Numbers:
    """Zeros of the kind of another array's numbers."""
    found = np.zeros(shape, object if like.dtype == object else float)
    return found


def numbers(values: Any) -> Numbers:
    """An array of floats, or of the objects that a proof computes with instead."""
    array = np.asarray(values)
    return array if array.dtype == object else array.astype(float)
