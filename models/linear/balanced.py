"""The main motion: where the weights must stand so that the rotor does not move.

With weights at angles theta_k in the rotor the rotor stands still when their static moments undo
the unbalance, S^T (sum m R e^{i theta}) + u = 0 (Filimonikhina 2017 (3), plane by plane).  Weights
of finite size stand there without touching: of the family of positions only some have room.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..assembly import Assembly
from ..papers.capacity import moment_range, packed_sine
from ..readable import readable_apart
from .room import Gaps, nearest_with_room
from .weight_table import WeightTable, moment_slopes, residual_unbalance

_BALANCED = 1e-12  # residual moment over the sum of all moments: rounding only
_RANK = 1e-12  # singular values below this share of the largest one are rounding
_UNDONE = 1e-10  # of the unbalance: a larger part left by least squares is out of the planes' reach
_IN_LINE = 0.05  # of 1 - p: weights within some 0.2 rad of one diameter
_FREE = 1e-6  # of the capacity: weights that undo more are packed together anyway
_NEWTON = 60  # iterations: half of the starts need 14, one in a hundred more than 50
_STARTS = 12  # the last turns weights by up to 1.65 rad, as far as makes a difference
_RESTART = 0.3  # rad that each start is farther from the given angles than the one before
_GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0  # its multiples spread most evenly over a turn
_SMALL_TURN = 1e-6  # smaller singular values are of weights in line, which turns hardly help
_LONGEST_TURN = 0.5  # rad per Newton step: a larger one leaves the neighbourhood of the start
_CLEARANCES = (5e-3, 0.0)  # rad between weights, where there is room: small motions do not close it
_GAP_ROUNDING = 1e-7  # rad that the last turns of Newton's method may take from a clearance


class CannotBalance(ValueError):
    """The weights cannot undo the unbalance.

    Attributes:
        needed: moment the weights of a plane would have to supply [kg m].
        capacity: largest moment they can supply [kg m].
        least: smallest moment they can supply [kg m]; above 0 for one weight, or one that is
            heavier than all others together.
        plane: index of that plane; None: no plane is to blame.
    """

    def __init__(
        self,
        message: str,
        needed: float,
        capacity: float,
        least: float = 0.0,
        plane: int | None = None,
    ) -> None:
        super().__init__(message)
        self.needed = needed
        self.capacity = capacity
        self.least = least
        self.plane = plane


def check_reach(assembly: Assembly, table: WeightTable) -> dict[int, complex]:
    """Moment each plane must supply when it is unique; raises when one is out of reach."""
    used = np.unique(table.plane)
    share = assembly.rotor.planes[used].T.astype(complex)
    target = -assembly.rotor.unbalance
    size = float(np.abs(target).max(initial=0.0))
    needed, _, rank, _ = np.linalg.lstsq(share, target, rcond=_RANK)
    left = float(np.abs(share @ needed - target).max(initial=0.0))
    total = float(table.moment.sum())
    if left > _UNDONE * size:
        raise CannotBalance(
            "the unbalance cannot be undone in the planes that carry weights: whatever the weights "
            f"are, {100.0 * left / size:.0f} % of its force would remain at a part of the rotor "
            "that they do not reach (a couple needs weights in two planes)",
            size,
            total,
        )
    if rank < len(used):
        return {}
    moments: dict[int, complex] = {}
    for plane, moment in zip(used.tolist(), needed, strict=True):
        tracks = [(rows, sines) for rows, sines in table.tracks if table.plane[rows[0]] == plane]
        ranges = [_range_of(table, rows, sines) for rows, sines in tracks]
        most, size = sum(high for _, high in ranges), abs(moment)
        least = max(0.0, *(low + high - most for low, high in ranges))
        if size > most * (1.0 + _BALANCED) or size < least * (1.0 - _BALANCED):
            count = sum(len(rows) for rows, _ in tracks)
            needs, makes = readable_apart(size, most if size > most else least)
            span = f"{'at most' if size > most else 'no less than'} {makes}"
            raise CannotBalance(
                f"the unbalance needs a moment of {needs} in plane {plane + 1}; "
                f"its {count} weights can make {span}",
                size,
                most,
                least,
                plane,
            )
        moments[plane] = complex(moment)
    return moments


def _range_of(
    table: WeightTable, rows: NDArray[np.int_], sines: NDArray[np.float64]
) -> tuple[float, float]:
    """As `moment_range`, of the weights of one track in the order in which they stand."""
    moments = table.moment[rows]
    if len(rows) > 1 and np.ptp(moments) == np.ptp(sines) == 0.0:
        return 0.0, float(moments[0]) * packed_sine(len(rows), math.asin(min(1.0, sines[0])))
    order = np.argsort(table.angle[rows] % math.tau, kind="stable")
    return moment_range(moments[order].tolist(), sines[order].tolist())


def _newton(assembly: Assembly, table: WeightTable, angles: NDArray) -> NDArray | None:
    """Gauss-Newton with least turns; None when it does not reach balance."""
    pulls = assembly.rotor.planes[table.plane] * table.moment[:, None]
    scale = float(np.abs(pulls).sum()) + float(np.abs(assembly.rotor.unbalance).sum())
    for _ in range(_NEWTON):
        left = residual_unbalance(assembly, table, angles)
        if float(np.abs(left).max()) <= _BALANCED * scale:
            return angles
        matrix = moment_slopes(assembly, table, angles)
        right = np.concatenate([left.real, left.imag])
        turn = np.linalg.lstsq(matrix, -right, rcond=_SMALL_TURN)[0]
        longest = float(np.abs(turn).max())
        angles = angles + turn * min(1.0, _LONGEST_TURN / longest if longest > 0.0 else 1.0)
    return None


def _with_room(assembly: Assembly, table: WeightTable, start: NDArray) -> NDArray | None:
    """Balanced angles next to a start at which no weights overlap; None when none were found."""
    angles = _newton(assembly, table, start)
    if angles is None or _has_room(table, angles, _CLEARANCES[0]):
        return angles
    scale = float(np.abs(assembly.rotor.unbalance).max()) + float(table.moment.sum())

    def residual(angles: NDArray) -> NDArray:
        left = residual_unbalance(assembly, table, angles) / scale
        return np.concatenate([left.real, left.imag])

    gaps = Gaps.of(table.tracks, start)
    for clearance in _CLEARANCES:
        near = nearest_with_room(residual, gaps, start, clearance)
        exact = None if near is None else _newton(assembly, table, near)
        if exact is not None and _has_room(table, exact, clearance):
            return exact
    return None


def _has_room(table: WeightTable, angles: NDArray, clearance: float) -> bool:
    """Whether neighbours that could touch stand apart by a clearance [rad]."""
    return Gaps.of(table.tracks, angles).smallest(angles) >= clearance - _GAP_ROUNDING


def _pairs_apart(table: WeightTable, moments: dict[int, complex], angles: NDArray) -> NDArray:
    """Angles with all pairs of weights where they undo a plane's unbalance exactly: a triangle.

    A pair that has next to nothing to undo stands almost in line, where Newton's method creeps.
    """
    angles = angles.copy()
    for plane, moment in moments.items():
        on = np.flatnonzero(table.plane == plane)
        if len(on) == 2:
            (a, b), size = table.moment[on].tolist(), abs(moment)
            more = (a * a - b * b) / size if a != b else 0.0
            sides = [math.acos(max(-1.0, min(1.0, c)))
                     for c in ((size + more) / (2.0 * a), (size - more) / (2.0 * b))]  # fmt: skip
            angles[on] = np.angle(moment) + np.array([-sides[0], sides[1]])
    return angles


def _needlessly_in_line(table: WeightTable, moments: dict[int, complex], angles: NDArray) -> bool:
    """Whether all weights of a plane stand on one diameter though others of the family do not.

    There they cannot push across it, and what drives them vanishes; evenly spread weights end so.
    """
    for plane, moment in moments.items():
        on = table.plane == plane
        lengths = table.moment[on]
        free = len(lengths) > 2 and abs(moment) < lengths.sum() * (1.0 - _FREE)
        if free and abs(lengths @ np.exp(2j * angles[on])) > lengths.sum() * (1.0 - _IN_LINE):
            return True
    return False


def _restart_angles(angles: NDArray[np.float64], attempt: int) -> NDArray[np.float64]:
    """Angles (K,) [rad] to start Newton's method from once more; attempt 0: those that were given.

    Each attempt turns the weights by up to 0.15 rad more, all by different parts of it.
    """
    if attempt == 0:
        return angles
    parts = np.modf(np.arange(1, len(angles) + 1) * _GOLDEN)[0] - 0.5  # all different
    return angles + _RESTART * attempt * parts


def balanced_angles(assembly: Assembly) -> NDArray[np.float64]:
    """Angles (K,) [rad] of all weights in the main motion.

    The given angles when they balance; else the balanced position that Newton's method with least
    turns finds from them.  Two weights have one such position up to their exchange; of the family
    of three and more weights it is the member next to the given angles.  A start from which the
    weights cannot reach balance, or only with all of them on one line, is left by a small fixed
    spread.  Weights of finite size stand apart: where the position found would make them overlap,
    it is the nearest one with room.

    Raises:
        CannotBalance: the unbalance is out of the weights' reach.
        ArithmeticError: no balanced position was found although none of these limits forbids one.
    """
    table = WeightTable.of(assembly)
    if len(table.angle) == 0:
        return table.angle
    moments = check_reach(assembly, table)
    start = table.angle.copy()
    for plane, moment in moments.items():
        on = table.plane == plane
        if abs(moment) >= table.moment[on].sum() * (1.0 - _BALANCED):
            start[on] = np.angle(moment)  # all weights together: Newton would creep there
    in_line = None
    for attempt in range(_STARTS):
        angles = _with_room(assembly, table, _restart_angles(start, attempt))
        if angles is None:
            continue
        if angles is start or not _needlessly_in_line(table, moments, angles):
            return angles
        in_line = angles if in_line is None else in_line
    if in_line is not None:
        return in_line
    angles = _newton(assembly, table, _pairs_apart(table, moments, start))
    if angles is not None and not _has_room(table, angles, 0.0):
        angles = None
    if angles is not None:
        return angles
    size = float(np.abs(assembly.rotor.unbalance).max(initial=0.0))
    raise ArithmeticError(f"no balanced position found for an unbalance of {size:g} kg m")
