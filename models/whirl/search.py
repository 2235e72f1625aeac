"""Which whirl remains: where the weights undo what they can.

Seen as a mean over half a revolution the planes' acceleration is linear in their moments.  Those
that would take it away, or as much of them as the weights can make, are the first start of Newton's
method; weights all together, in four directions, and those of the scene are the others.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..assembly import Assembly, weights_of
from ..linear.balanced import WeightTable, balanced_angles
from ..linear.boundaries import MARGIN, Crossing, growth_boundaries, scan_speeds
from ..papers.touching import merged, packed_groups
from .response import Response
from .steady import NoWhirl, Whirl, whirl_near
from .variation import growth_rate

_ALIKE = 1e-6  # of the larger amplitude: the same whirl, found twice
_SLOW_DRIFT = 1e-3  # rad of drift per radian of the rotor: no whirl to speak of
_RANK = 1e-9  # planes that act alike share what is needed
_TOUCHING_ANGLE = 1e-9  # rad
_GRID = 100  # intervals of a scan: a whirl costs a hundred times what a balanced position does
_TOLERANCE = 1e-7  # of the speeds


class NotCovered(ValueError):
    """Weights that share a plane's moment in many ways, among which they do not drift slowly."""


class MainWhirl(NamedTuple):
    """The whirl that remains, and the growth rate of small deviations from it [1/s]."""

    whirl: Whirl
    growth: float

    @property
    def stable(self) -> bool:
        """Whether small deviations decay, by more than rounding."""
        return decays(self.growth, self.whirl.speed)


def decays(growth: float, speed: float) -> bool:
    """Whether a growth rate [1/s] is below 0 by more than rounding; not if it is NaN."""
    return growth * 2.0 * math.pi < -MARGIN * speed


def main_whirl(assembly: Assembly, speed: float) -> MainWhirl:
    """The steady whirl that weights leave which cannot undo the unbalance.

    The one next to the weights' best mean position if it is stable; else of all that were found the
    stable one of least vibration; else the one that grows slowest.  Weights of finite size that
    would overlap there stand side by side, as one.

    Args:
        speed: w [rad/s], positive.

    Raises:
        NoWhirl: none was found: the weights then keep moving in the rotor, or there are none.
        NotCovered: three and more weights do not drift slowly where they share a moment.
        ValueError: an undamped rotor has no bounded response.
    """
    if not assembly.weights:
        raise NoWhirl("no weights")
    whirls: list[MainWhirl] = []
    starts, drifting = _starts(assembly, speed)
    for number, start in enumerate(starts):
        try:
            near = whirl_near(assembly, speed, start, () if number else drifting)
            whirl = _separated(assembly, near)
        except NoWhirl:
            continue
        if whirl.drift > _SLOW_DRIFT * speed:
            continue
        size = float(whirl.amplitude.max())
        if any(abs(size - float(f.whirl.amplitude.max())) <= _ALIKE * size for f in whirls):
            continue
        whirls.append(MainWhirl(whirl, growth_rate(whirl)))
        if len(whirls) == 1 and whirls[0].stable:
            break
    stable = [f for f in whirls if f.stable]
    if stable:
        return min(stable, key=lambda f: float(f.whirl.amplitude.max()))
    if drifting and not any(f.whirl.family.size for f in whirls):
        raise NotCovered(
            f"at {speed:g} rad/s the weights of an anisotropic rotor could keep their planes at "
            "rest in the mean in many ways, and drift among them: run the scene"
        )
    if not whirls:
        raise NoWhirl(f"no steady whirl at {speed:g} rad/s: the weights keep moving in the rotor")
    return min(whirls, key=lambda f: f.growth)


def whirl_growth(assembly: Assembly, speed: float) -> float:
    """Growth rate [1/s] of deviations from the whirl; where there is none, an e-fold a radian."""
    try:
        return main_whirl(assembly, speed).growth
    except NoWhirl:
        return speed


def whirl_boundaries(
    assembly: Assembly,
    low: float,
    high: float,
    *,
    narrowest: float | None = None,
    progress: Callable[[float], None] = lambda done: None,
) -> list[Crossing]:
    """Every speed from `low` to `high` at which a stable whirl begins or ends, ascending.

    Args:
        low, high: range of speeds [rad/s], 0 < low < high.
        narrowest: spacing of the scan [rad/s], as for `balancing_boundaries`; a hundredth of the
            range by default.
        progress: called with the finished fraction of the scan, and on with 1.

    Raises:
        ValueError: the range is empty or not positive; an undamped rotor has no bounded response.
        NotCovered: as `main_whirl`.
    """
    scan, done = scan_speeds(low, high, narrowest, _GRID), itertools.count(1)

    def growth(speed: float) -> float:
        progress(min(1.0, next(done) / len(scan)))
        return whirl_growth(assembly, speed)

    return growth_boundaries(np.vectorize(growth, otypes=[float]), scan, _TOLERANCE)


def _starts(assembly: Assembly, speed: float) -> tuple[list[Array], list[int]]:
    """Angles of the weights (K,) [rad] to start from, the most likely ones first.

    And planes whose weights share the moment that keeps them at rest in the mean in many ways, on
    an anisotropic rotor: the plane then swings a little, and its weights drift among these ways.
    """
    table, needed = WeightTable.of(assembly), _needed(assembly, speed)
    within = []
    for plane in np.unique(table.plane).tolist():
        lengths = table.moment[table.plane == plane]
        most = float(lengths.sum())
        least = max(0.0, 2.0 * float(lengths.max()) - most)
        size = abs(needed[plane])
        within += [plane] if least < size < most else []
        needed[plane] *= min(1.0, most / size) if size > least else least / size if size else 0.0
    together = [np.angle(needed)[table.plane] + turn * math.pi / 2.0 for turn in range(4)]
    rotor = replace(assembly.rotor, planes=np.eye(len(needed)), unbalance=-needed)
    points = tuple(replace(m, half_angle=0.0) for m in assembly.balancers)
    starts = [balanced_angles(Assembly(rotor, points)), table.angle, *together]
    # NumPy 2.2 gives an empty matrix no rank
    one_way = 2 * np.linalg.matrix_rank(assembly.rotor.planes[within]) if within else 0
    shared = not assembly.rotor.isotropic and np.isin(table.plane, within).sum() > one_way
    return starts, within if shared else []


def _needed(assembly: Assembly, speed: float) -> np.ndarray:
    """Moments (p,) [kg m] of the weights that would keep the planes at rest in the mean."""
    rotor = assembly.loaded_rotor
    compliance = Response.of(rotor, speed, 2).direct[0]
    planes = np.unique(WeightTable.of(assembly).plane)
    rows, unbalance = rotor.planes[planes], moment_without_weights(assembly)
    offsets = {m.plane: m.offset for m in assembly.weights}  # the track's centre is to rest
    moved = rows @ compliance @ unbalance + np.array([offsets[plane] for plane in planes.tolist()])
    needed = np.zeros(rotor.plane_count, complex)
    needed[planes] = np.linalg.lstsq(rows @ compliance @ rows.T, -moved, rcond=_RANK)[0]
    return needed


def moment_without_weights(assembly: Assembly) -> np.ndarray:
    """Moment (n,) [kg m] of the unbalance, and of added masses on tracks that are off centre."""
    moment = assembly.rotor.unbalance.astype(complex)
    for mounted in assembly.weights:
        mass = mounted.device.added_mass
        moment += mass * mounted.offset * assembly.rotor.planes[mounted.plane]
    return moment


def _separated(assembly: Assembly, whirl: Whirl) -> Whirl:
    """The whirl with weights of finite size side by side where points would overlap.

    Raises:
        NoWhirl: it is lost on the way, or groups of weights overlap in it or are driven apart.
    """
    if any(m.half_angle and weights_of(m).unequal for m in assembly.weights):
        raise NoWhirl("the whirl of weights of unequal size is not computed: run the scene")
    joined, angles = assembly, whirl.angles.tolist()
    tracks: list[tuple[float, list[int]]] = []  # half angle, and sizes of the groups
    for mounted in assembly.weights:
        own, angles = angles[: len(mounted.angles)], angles[len(mounted.angles) :]
        groups = packed_groups(own, mounted.half_angle, _TOUCHING_ANGLE)
        at = joined.balancers.index(mounted)
        if len(groups) < len(own):
            joined = merged(joined, mounted.half_angle, groups, at)
            tracks.append((mounted.half_angle, [g.size for g in groups]))
        else:
            placed = replace(mounted, angles=tuple(own))
            others = joined.balancers
            joined = replace(joined, balancers=(*others[:at], placed, *others[at + 1 :]))
            tracks.append((mounted.half_angle, [1] * len(own)))
    size = np.concatenate([sizes for _, sizes in tracks])
    if size.max() == 1:
        return whirl
    beside = whirl_near(joined, whirl.speed, WeightTable.of(joined).angle)
    # what drives the outer ones apart; in the mean, as a gap of half a turn stays small
    apart = (beside.acceleration * np.exp(-1j * beside.theta)).real.mean(axis=0)
    if (apart[size > 1] >= 0.0).any():
        raise NoWhirl("weights that touch are driven apart")
    first = 0
    for alpha, sizes in tracks:
        _refuse_overlap(beside.angles[first : first + len(sizes)], np.array(sizes), alpha)
        first += len(sizes)
    return beside


def _refuse_overlap(angles: Array, sizes: np.ndarray, alpha: float) -> None:
    order = np.argsort(angles % math.tau)
    middles, sizes = (angles % math.tau)[order], sizes[order]
    gaps = np.diff([*middles, middles[0] + math.tau])
    if len(sizes) > 1 and (gaps < alpha * (sizes + np.roll(sizes, -1)) - _TOUCHING_ANGLE).any():
        raise NoWhirl("groups of weights that touch would overlap")
