"""Weights that touch as single ones: the slow root and the spectrum of a track with packed groups.

A packed group of k weights (neighbours 2 alpha apart, f = sin(k alpha)/(k sin alpha), middle t)
moves like one weight of mass k m on radius f R with kappa/f^2 and the same damping rate: its moment
k f m R, its gain f/(kappa R) and its added mass k m are all those of the group (`contact`).  So
every theory of point weights holds for groups, and in Goncharov's (1)

    (1 - p) m n   becomes   (1 - p_g) m n_g,   n_g = sum k f^2,   p_g = |sum k f^2 e^{2 i t}|/n_g.

Without contact n_g = n and p_g = p.  A contact is one-sided: this is the motion as long as every
group is pressed together.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

from ..assembly import Assembly, Mounted
from ..spacing import group_factor
from ..weights import Weights
from .capacity import capacity, packed_alignment

_TOUCHING = 1e-8  # rad: more than a record's rounding, less than any gap that matters


class Packed(NamedTuple):
    """Weights that touch: how many, and the angle of their middle [rad]."""

    size: int
    middle: float


def packed_groups(angles: Sequence[float], alpha: float) -> list[Packed]:
    """Who touches whom on the circle, in the order of the angles.

    Args:
        angles: of the weights [rad].
        alpha: half the angle between neighbours that touch; 0: nobody does.
    """
    order = sorted(angle % math.tau for angle in angles)
    n = len(order)
    following = [*order[1:], order[0] + math.tau]
    least = 2.0 * alpha + _TOUCHING
    open_after = [alpha == 0.0 or b - a > least for a, b in zip(order, following, strict=True)]
    if not any(open_after):
        return [Packed(n, order[0] + (n - 1) * alpha)]
    first = open_after.index(True) + 1
    groups, begin, count = [], order[first % n], 0
    for k in range(first, first + n):
        count += 1
        if open_after[k % n]:
            groups.append(Packed(count, begin + (count - 1) * alpha))
            begin, count = order[(k + 1) % n], 0
    return groups


def joint_alignment(groups: Sequence[Packed], alpha: float) -> tuple[float, float]:
    """n_g and p_g of the module's head: number and alignment that decide the slow root."""
    shares = [g.size * group_factor(g.size, alpha) ** 2 for g in groups]
    total = sum(shares)
    turned = sum(
        share * cmath.rect(1.0, 2.0 * g.middle) for share, g in zip(shares, groups, strict=True)
    )
    return total, abs(turned) / total


def facing_measure(count: int, alpha: float) -> tuple[int, float]:
    """n_g and p_g of Goncharov's position of largest p, two packed groups face to face.

    On their diameter both groups are pressed together or one opens, and a group that is pressed
    adds nothing to n_g (1 - p_g).  The slower way opens the smaller group, of q = n // 2 weights:
    (1 - p) m n of (10), (13) becomes (1 - p_q) m q, its half for even n, and 0 for n = 2 and 3,
    where that group is a single weight.  p_q is the alignment of q packed weights.
    """
    smaller = count // 2
    return smaller, packed_alignment(smaller, alpha)


def critical_unbalance(mass: float, track: float, radius: float) -> float:
    """Unbalance at which three weights stand two against one, S(2) - S(1) [kg m].

    The smaller group is a single weight, so p_g = 1 and no opening of a group helps: nothing drives
    them, as it drives two weights nowhere on a diameter.  Goncharov's (13) knows no such case.

    Args:
        mass, track, radius: m [kg], R - r [m] and r [m], as of `capacity`.
    """
    return capacity(mass, track, radius, 2) - capacity(mass, track, radius, 1)


def merged(assembly: Assembly, alpha: float, groups: Sequence[Packed]) -> Assembly:
    """The assembly with each group of its first balancer as a weight of its own.

    Raises:
        ValueError: it has no weights.
    """
    mounted, *others = assembly.balancers
    device = mounted.device
    if not isinstance(device, Weights):
        raise ValueError(f"{mounted.name}: has no weights")
    device.refuse_unequal("a packed group as one weight")
    singles = []
    for number, group in enumerate(groups, start=1):
        f = group_factor(group.size, alpha)
        weight = Weights(
            1,
            group.size * device.mass,
            f * device.track_radius,
            group.size * device.drag / f**2,
            device.kappa / f**2,
        )
        name, angles = f"{mounted.name}[{number}]", (group.middle,)
        singles.append(Mounted(name, weight, mounted.plane, angles, (0.0,), mounted.offset))
    return replace(assembly, balancers=(*singles, *others))
