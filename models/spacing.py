"""Weights of radius r whose centres share a circle of radius R: how close, and how many.

Neighbours that touch stand 2 alpha apart, sin alpha = r/R (Goncharov 2017 (4)).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

from .constants import TRACK_SLACK


def half_angle(radius: float, track: float) -> float:
    """alpha, half the angle between neighbours that touch [rad].

    Args:
        radius, track: of the weights and of their centres' circle [m].

    Raises:
        ValueError: the radius is not within 0 to `track`: two such weights cannot share a track.
    """
    if not 0.0 <= radius <= track * (1.0 + TRACK_SLACK) or not 0.0 < track < math.inf:
        raise ValueError(f"radius = {radius!r} m: must be within 0 to the track radius {track!r} m")
    return math.asin(min(1.0, radius / track))


def touching(first: float, second: float, track: float) -> float:
    """Angle between neighbours of these radii that touch [rad]."""
    return 2.0 * half_angle(0.5 * (first + second), track)


def largest_radius(count: int, track: float) -> float:
    """Radius at which `count` weights fill a track [m]; one weight: that of the track."""
    return track * math.sin(math.pi / count) if count > 1 else track


def fits(count: int, radius: float, track: float) -> bool:
    """Whether `count` weights have room on a track."""
    return radius <= largest_radius(count, track) * (1.0 + TRACK_SLACK)


def closest(angles: Sequence[float]) -> tuple[float, int, int]:
    """Smallest angle between neighbours on the circle [rad], and which two; one weight: a turn."""
    within = [angle % math.tau for angle in angles]
    order = sorted(range(len(angles)), key=within.__getitem__)
    gaps = [(within[j] - within[i], i, j) for i, j in pairwise(order)]
    first, last = order[0], order[-1]
    return min([*gaps, (within[first] + math.tau - within[last], last, first)])


def group_factor(count: int, alpha: float) -> float:
    """sin(n alpha)/(n sin alpha): mean drive of a packed group in units of one weight's."""
    if count == 1 or alpha == 0.0:
        return 1.0
    return math.sin(count * alpha) / (count * math.sin(alpha))
