"""A step of the iterated scheme as linear maps.

All that lies between the units in a pass is linear in what is known.  The formulas are applied once
to the columns of an identity, for a step of 1; those of another step are the same in derivatives of
order k times its k-th power.  Then a pass costs four products.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache

import numpy as np

from ..signals import (
    EXACT,
    end_of,
    extrapolated,
    hermite,
    interpolated,
    leading_to,
    matrix_of,
)


class Layout:
    """Where the numbers of a step stand, and the maps between them in its unit of time.

    The unit is the step but for negligible ones.  Known are, scaled by its powers, by how much
    forces are assumed to change over the step, forces and accelerations at its start, and by how
    much the units change them; changes, because ends would lose the digits that they share with
    starts.  Forces come first, those of the exchanges before the shaft's.

    Args:
        planes: on which each exchange is.
        forces: number of them.
        order: of the exchanged signals.
        held: units are told what signals end with.
        length: of the step, in units; below 1 it is negligible, and signals are parabolas that
            lead to what they end with.

    Attributes:
        parts: of a signal's end.
        ends: of what is known, in reals: of changes assumed, starts of forces, those of
            accelerations, changes of accelerations, changes answered.
        unused: of ends of forces, which numbers take no part.
        raw: maps to ends, signal by signal, from accelerations and from forces as units give them.
        raw_orders: of the derivatives which these are applied to.
        maps: one below the other, from what is known to what is told, and to all cubics.
        orders: of the derivatives that they make, negative.
        rows: where they end: what is told the rotor, the shaft, the balancers, cubics (quintics).
    """

    def __init__(
        self, planes: Sequence[int], forces: int, order: int, held: bool, length: float
    ) -> None:
        self.parts = parts = EXACT[max(3, order)] + 1
        exact, size, places = EXACT[order] + 1, 2 * parts, max(planes, default=-1) + 1
        exchanged = 0 if held else order
        slopes = np.arange(2 * forces * parts) // 2 % parts > 0
        self.unused = np.flatnonzero(slopes) if exchanged < 3 else np.zeros(0, int)
        bounds = parts * np.cumsum([forces, forces, places, places, forces])
        self.ends = (2 * bounds).tolist()
        known = np.eye(bounds[-1])
        assumed, first, begun, moved, answered = (
            x.reshape(-1, parts, len(known)) for x in np.split(known, bounds[:-1])
        )
        if length < 1.0:
            telling = joining = _of_changes(lambda _, end: leading_to(end, length), parts)
        else:
            telling = _of_changes(
                lambda start, end: interpolated(start, end, 1.0, exchanged), parts
            )
            joining = _of_changes(lambda start, end: hermite(start, end, 1.0), parts)
        cubics = _combined(first, assumed, telling[:, : order + 1])
        pushed = np.zeros((order + 1, places, len(known)))
        for plane, cubic in zip(planes, cubics, strict=False):
            pushed[:, plane] += cubic
        told = _combined(begun, moved, telling[:, : order + 1])[list(planes)]
        starts, changes = np.concatenate([first, begun]), np.concatenate([answered, moved])
        blocks = [pushed, cubics[len(planes) :], told, _combined(starts, changes, joining)]
        self.rows = (2 * np.cumsum([x.size // len(known) for x in blocks])).tolist()
        rows = np.concatenate([x.reshape(-1, len(known)) for x in blocks])
        self.maps = np.kron(rows, np.eye(2))
        told_orders = np.tile(np.arange(order + 1), forces)
        orders = [np.repeat(np.arange(order + 1), places), told_orders]
        orders.append(np.tile(np.arange(size), forces + places))
        self.orders = -np.repeat(np.concatenate(orders), 2)[:, None]

        felt = np.eye(exact * places).reshape(exact, places, exact * places).swapaxes(0, 1)
        answers = np.eye(forces * exact).reshape(forces, exact, forces * exact)
        self.raw = tuple(np.kron(_padded(x, parts), np.eye(2)) for x in (felt, answers))
        self.raw_orders = (
            np.repeat(np.arange(exact), 2 * places),
            np.tile(np.repeat(np.arange(exact), 2), forces),
        )


class Known:
    """What is known of a step: `numbers`, as a layout has them, and views of parts of them.

    Attributes:
        assumed, first, begun, moved, answered: the parts.
        pushing, telling: what is known before the rotor's step and before the balancers'.
        assumed_ends, starts: changes assumed, and starts, as rows of complex numbers.
        changes: of the values of accelerations and then of forces.
    """

    def __init__(self, layout: Layout) -> None:
        self.layout, self.numbers = layout, np.zeros(layout.ends[-1])
        _, first, begun, moved, _ = layout.ends
        self.assumed, self.first, self.begun, self.moved, self.answered = np.split(
            self.numbers, layout.ends[:-1]
        )
        self.pushing, self.telling = self.numbers[:first], self.numbers[first:moved]
        rows = self.numbers.view(complex).reshape(-1, layout.parts)
        counts = [end // (2 * layout.parts) for end in layout.ends]
        self.assumed_ends, self.starts = rows[: counts[0]], rows[counts[0] : counts[2]]
        self.changes = self.numbers[begun:].view(complex)[:: layout.parts]


class IteratedMaps:
    """The maps of a layout for a unit of time [s]; what they are applied to is in brackets.

    Attributes:
        pushed, spun: what the rotor and the shaft are told (changes assumed, starts of forces).
        told: what the balancers are told (starts and changes of accelerations).
        cubics: of all signals (all that is known).
        felt, answers: scaled ends (as the units give them).
    """

    __slots__ = ("answers", "cubics", "felt", "pushed", "spun", "told")

    def __init__(self, layout: Layout, unit: float) -> None:
        maps = layout.maps * unit**layout.orders
        pushed, spun, told, self.cubics = np.split(maps, layout.rows[:-1])
        _, first, _, moved, _ = layout.ends
        self.pushed, self.spun = pushed[:, :first], spun[:, :first]
        self.told = told[:, first:moved]
        self.felt, self.answers = (
            raw * unit**orders for raw, orders in zip(layout.raw, layout.raw_orders, strict=True)
        )


@lru_cache(maxsize=16)
def layout_of(
    planes: tuple[int, ...], forces: int, order: int, held: bool, length: float
) -> Layout:
    """The layout of a system, see there."""
    return Layout(planes, forces, order, held, length)


@lru_cache(maxsize=256)
def iterated_maps(layout: Layout, unit: float) -> IteratedMaps:
    """Maps of a layout for a unit of time [s]."""
    return IteratedMaps(layout, unit)


@lru_cache(maxsize=256)
def ahead(order: int, past: float, step: float) -> np.ndarray:
    """Map of rows, from the right: from what is known of a signal to its start and what comes.

    Known are value and derivatives now, and the higher derivatives of the cubic (quintic) of the
    step before at its start; found are the start and the predicted change, scaled by powers of the
    step.

    Args:
        order: of the exchanged signals.
        past, step: lengths of the step before (0: none) and of this one [s].
    """
    shift, predicted = _ahead_of_unit_steps(order)
    exponents = np.arange(len(shift))
    since = np.maximum(np.subtract.outer(exponents, exponents), 0)
    # complex as what it is applied to: nothing is converted then
    return (shift * past**since * step**exponents).dot(predicted).astype(complex)


@lru_cache
def _ahead_of_unit_steps(order: int) -> tuple[np.ndarray, np.ndarray]:
    """Map to the derivatives now, and from these to start and predicted change."""
    parts = EXACT[max(3, order)] + 1
    size, now = 2 * parts, (0.0,) * parts

    def led(*scaled: float) -> Sequence[complex]:
        # all that the start tells is in these: no step before it
        cubic = scaled if order >= 3 else extrapolated(scaled[:parts], scaled, 0.0, order)
        start, end = scaled[:parts], end_of(cubic, 1.0)
        return (*start, *(b - a for a, b in zip(start, end, strict=True)))

    shift = matrix_of(
        lambda *k: extrapolated(k[:parts], (*now, *k[parts:]), 1.0, max(3, order)), size
    )
    return shift.real, matrix_of(led, size).real


def _of_changes(formula: Callable[..., Sequence[complex]], parts: int) -> np.ndarray:
    """Matrix of a formula of start and end, to be applied from the right to start and change."""

    def changed(*track: float) -> Sequence[complex]:
        start, change = track[:parts], track[parts:]
        return formula(start, tuple(a + b for a, b in zip(start, change, strict=True)))

    return matrix_of(changed, 2 * parts).real


def _combined(starts: np.ndarray, changes: np.ndarray, formula: np.ndarray) -> np.ndarray:
    """Signals from what is known, (signals, derivatives, known), of start and change."""
    return np.einsum("ikn,kj->ijn", np.concatenate([starts, changes], 1), formula)


def _padded(rows: np.ndarray, parts: int) -> np.ndarray:
    """Maps to ends with all their parts: slopes that are not exchanged are 0."""
    padded = np.pad(rows, ((0, 0), (0, parts - rows.shape[1]), (0, 0)))
    return padded.reshape(len(rows) * parts, rows.shape[2])
