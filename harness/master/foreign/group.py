"""Variables of a unit that are read or written together."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from fmpy.model_description import ModelVariable


class Group:
    """Some variables of a unit, read or written by one call a type; numbers as reals.

    Attributes:
        reals: their values.
        parts: by type, places in `reals` and value references.
    """

    def __init__(self, variables: Sequence[ModelVariable], memory: np.ndarray | None) -> None:
        self.names = tuple(v.name for v in variables)
        self.reals = np.zeros(len(variables)) if memory is None else memory
        by_type: dict[str, list[int]] = {}
        for place, variable in enumerate(variables):
            by_type.setdefault(variable.type, []).append(place)
        self.parts = [
            (kind, places, [variables[p].valueReference for p in places])
            for kind, places in by_type.items()
        ]
