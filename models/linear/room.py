"""Balanced angles of weights that have a size: neighbours on a track stand apart.

Newton's method with least turns knows no size.  Where its weights would overlap, the balanced
angles are those of least squared turns from the start that keep neighbours apart, in their order.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_TURN_ROUNDING = 1e-12  # of the squared turns


@dataclass(frozen=True, eq=False)
class Gaps:
    """Angles between the surfaces of neighbours [rad], matrix @ angles + offset: (G, K), (G,)."""

    matrix: Array
    offset: Array

    @classmethod
    def of(cls, tracks: Iterable[tuple[NDArray[np.int_], Array]], angles: Array) -> Gaps:
        """Gaps of weights in the order in which they stand on their tracks.

        Args:
            tracks: rows of the weights of each, and radius over track radius of those that can
                touch; 0: points.
            angles: (K,) of all weights [rad].
        """
        rows, offsets = [np.zeros((0, len(angles)))], [np.zeros(0)]
        for track, sines in tracks:
            if len(track) < 2 or not sines.any():
                continue
            places = np.argsort(angles[track] % math.tau, kind="stable")
            order, beside = track[places], sines[places]
            after = np.roll(order, -1)
            apart = 2.0 * np.arcsin(np.minimum(1.0, 0.5 * (beside + np.roll(beside, -1))))
            unit = np.eye(len(angles))
            rows.append(unit[after] - unit[order])
            ahead = (angles[after] - angles[order]) % math.tau  # of equal angles the last is a turn
            offsets.append(ahead - (angles[after] - angles[order]) - apart)
        return cls(np.vstack(rows), np.concatenate(offsets))

    def smallest(self, angles: Array) -> float:
        """Of the gaps at `angles` (K,); infinite where no weights can touch."""
        return float((self.matrix @ angles + self.offset).min(initial=math.inf))


def nearest_with_room(
    residual: Callable[[Array], Array], gaps: Gaps, start: Array, clearance: float
) -> Array | None:
    """Angles (K,) of least squared turns from `start` with no residual and every gap kept.

    Args:
        residual: of the balance, (r,), of the order of 1 where there is none.
        clearance: smallest gap [rad].

    Returns:
        None where there are none, or none was found.
    """
    from scipy.optimize import minimize  # loaded for weights that touch alone

    found = minimize(
        lambda angles: float(((angles - start) ** 2).sum()),
        start,
        jac=lambda angles: 2.0 * (angles - start),
        method="SLSQP",
        constraints=[
            {"type": "eq", "fun": residual},
            {
                "type": "ineq",
                "fun": lambda angles: gaps.matrix @ angles + gaps.offset - clearance,
                "jac": lambda angles: gaps.matrix,
            },
        ],
        options={"ftol": _TURN_ROUNDING, "maxiter": 300},
    )
    return found.x if found.success else None
