"""Speeds at which the main motion gains or loses stability."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .assembly import Assembly
from .linear.linearised import linearise
from .linear.on_race import NoRest, has_lobes
from .linear.regions import Crossing, Measure, Regions, Samples, Side, find_regions
from .linear.weight_table import WeightTable
from .ring import Ring
from .stability import growth_and_errors, growth_at_rest

GRID = 1000  # intervals of the scan, unless the caller says how narrow a band may be missed
GRID_OF_LOBES = 200  # the same on races with lobes, where every speed has a rest of its own
_SPLIT = 12  # parts of the spacing in which an extremum is looked for, a round
_PLATEAU = 1e-9  # of the growth: what rounding makes of one that does not depend on the speed
_PROBE_ROUNDS = 6  # an extremum is located to (2/_SPLIT)^rounds of the scan's spacing
_TOLERANCE = 1e-9  # of the speed


def measure_of(assembly: Assembly) -> Measure:
    """Growth rates of an assembly and their errors [1/s] at speeds of any shape [rad/s].

    At a speed at which weights on a race with lobes have no rest it is 0 with an infinite error.

    Raises:
        CannotBalance: the weights cannot undo the unbalance.
        NoRest: they have none at any of the speeds that are asked for first.
    """
    one = None if assembly.rotor.varies or has_lobes(assembly) else linearise(assembly)
    rested: list[bool] = []

    def measure(speeds: NDArray) -> tuple[NDArray, NDArray]:
        flat = speeds.ravel()
        if one is not None:
            growth, error = growth_and_errors([one], np.zeros(flat.size, int), flat)
        else:
            growth, error = growth_at_rest(assembly, flat)
            unknown = np.isnan(growth)
            if unknown.all() and not rested:
                raise NoRest("weights rest on their races at none of the speeds: run the scene")
            rested.append(True)
            growth, error = np.where(unknown, 0.0, growth), np.where(unknown, math.inf, error)
        return growth.reshape(speeds.shape), error.reshape(speeds.shape)

    return measure


def _probe(measure: Measure, samples: Samples) -> Samples:
    """Samples that show a change of sign between two of the scan's speeds.

    Looked for wherever the growth, seen at three neighbouring speeds, comes closest to zero in the
    middle: the extremum is closed in on until the sign changes or the spacing is used up.
    """
    w, g, signs = samples.speeds, samples.growth, samples.signs
    same = (signs[:-2] == signs[1:-1]) & (signs[1:-1] == signs[2:]) & (signs[1:-1] != 0)
    before, size, behind = np.abs(g[:-2]), np.abs(g[1:-1]), np.abs(g[2:])
    near = (size <= np.minimum(before, behind)) & (
        np.maximum(before, behind) > (1.0 + _PLATEAU) * size
    )
    middle = np.flatnonzero(same & near) + 1
    low, high, sign = w[middle - 1], w[middle + 1], signs[middle]
    for _ in range(_PROBE_ROUNDS):
        if not len(low):
            break
        nodes = low[:, None] + (high - low)[:, None] * np.linspace(0.0, 1.0, _SPLIT + 1)
        values, errors = measure(nodes)
        crossed = ((np.sign(values) == -sign[:, None]) & (np.abs(values) > errors)).any(axis=1)
        samples = samples.with_more(nodes[crossed], values[crossed], errors[crossed])
        best = np.abs(values).argmin(axis=1)
        rows = np.arange(len(low))
        low = nodes[rows, np.maximum(best - 1, 0)][~crossed]
        high = nodes[rows, np.minimum(best + 1, _SPLIT)][~crossed]
        sign = sign[~crossed]
    return samples


def balancing_boundaries(
    assembly: Assembly,
    low: float,
    high: float,
    *,
    narrowest: float | None = None,
    tolerance: float = _TOLERANCE,
) -> list[Crossing]:
    """The crossings of `balancing_regions`, which has the same arguments."""
    found = balancing_regions(assembly, low, high, narrowest=narrowest, tolerance=tolerance)
    return list(found.crossings)


def balancing_regions(
    assembly: Assembly,
    low: float,
    high: float,
    *,
    narrowest: float | None = None,
    tolerance: float = _TOLERANCE,
) -> Regions:
    """Every speed between `low` and `high` at which stability changes, and what holds between.

    The range is scanned with a spacing of at most `narrowest`: no stable or unstable band wider
    than that is missed.  Narrower bands are looked for wherever the growth comes near zero between
    two of the scan's speeds; they are found down to about `narrowest`/10^4 when the growth rate
    is smooth there, and can be missed otherwise.  Where the growth does not exceed its error, as
    without any damping, it is undecided: see `Regions`.

    Args:
        low, high: range of speeds [rad/s], 0 < low < high.
        narrowest: width of a band that must not be missed [rad/s]; by default (high - low)/1000,
            on races with lobes (high - low)/200.
        tolerance: relative error of the speeds.

    Raises:
        CannotBalance: the weights cannot undo the unbalance.
        ValueError: the range is empty or not positive, or `narrowest` is not positive.
    """
    if not 0.0 < low < high < math.inf:
        raise ValueError(f"range = {low:g} to {high:g} rad/s: must be positive and ascending")
    grid = GRID_OF_LOBES if has_lobes(assembly) else GRID
    width = (high - low) / grid if narrowest is None else narrowest
    if not width > 0.0:
        raise ValueError(f"narrowest = {width:g} rad/s: must be positive")
    scan = np.linspace(low, high, max(3, math.ceil((high - low) / width) + 1))
    return growth_regions(measure_of(assembly), scan, tolerance, unknown_word(assembly))


def growth_regions(
    measure: Measure, scan: NDArray, tolerance: float = _TOLERANCE, word: Side = "undecided"
) -> Regions:
    """Where a growth rate changes its sign, as `balancing_regions`.

    Args:
        measure: growth rates and their errors [1/s] at speeds of any shape [rad/s].
        scan: speeds to begin with, ascending [rad/s].
        tolerance: relative error of the speeds.
        word: for what cannot be decided.
    """
    samples = Samples(scan, *measure(scan))
    return find_regions(measure, _probe(measure, samples), tolerance, word)


def unknown_word(assembly: Assembly) -> Side:
    """What a growth rate within its error is called: "neutral" where nothing damps the machine."""
    rotor = assembly.rotor.at_bottom
    parts = [rotor.damping_x, rotor.damping_y, rotor.internal_damping]
    parts.append(WeightTable.of(assembly).damping_rate)
    damped = any(part.any() for part in parts) or any(
        isinstance(m.device, Ring) and m.device.is_damped for m in assembly.rings
    )
    return "undecided" if damped else "neutral"
