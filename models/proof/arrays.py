"""Arrays of balls, and the solution of linear equations in them."""

from __future__ import annotations

from typing import Any

import numpy as np
from flint import arb, arb_mat

from .slopes import Exact, Sloped, ball


class Unproved(ValueError):
    """Nothing can be proved; the message says why."""


def balls(values: Any) -> Exact:
    """An array of balls."""
    given = np.array(values, object)
    flat = [arb(x) if isinstance(x, (int, float)) else x for x in given.ravel()]
    out = np.empty(len(flat), object)
    out[:] = flat
    return out.reshape(given.shape)


def solve(matrix: Exact, right: Exact) -> Exact:
    """matrix^-1 right.

    Raises:
        Unproved: the matrix is not proved to be regular.
    """
    value = arb_mat([[ball(x) for x in row] for row in matrix])
    try:
        inverse = balls(value.inv().tolist())
    except ZeroDivisionError:
        raise Unproved("a mass or compliance matrix is not proved to be regular") from None
    found = inverse @ np.vectorize(ball, otypes=[object])(right)
    rest = inverse @ (right - matrix @ found)  # its slopes are those of the solution
    for at in np.ndindex(found.shape):
        if isinstance(rest[at], Sloped):
            found[at] = Sloped(found[at], rest[at].slopes)
    return found
