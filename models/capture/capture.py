"""Weights that are left behind: at which speeds, below which drag, how fast they turn.

In a run-up k weights can stay at a natural frequency of the rotor while it turns on: the vibration
that they cause there brakes them as much as their drag pulls them along (a Sommerfeld effect of the
weights).  `groups` has the balance of torques, `branch` its solutions.  A motion exists while the
rotor turns slower than the release speed

    Om_k = w_p + L_k(w_p; Om_k),

w_p the speed of the weights at the peak of the brake and L_k the lag that it holds there.  One
group of equal weights on a planar rotor: Om_k = w_n + k m^2 w_n^3/(c h) for light damping.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Array
from ..assembly import Assembly, weights_of
from ..harmonic_balance import NoResponse, largest_displacement, unbalance_response
from .branch import WITH, Branches, drag_ratios, find_branches
from .crossing import follow, largest_slip, lone_lag
from .groups import Group, Lag, groups_of
from .limit import drag_limit
from .receptance import Poles, Receptance
from .release import release_speeds

SHARE_OF_CAPACITY = 0.6  # of unbalance: beyond it weights are let go earlier than the formula says
_NO_DAMPING = 1e-9  # damping ratio: rounding
_UNDONE = 1e-9  # of the unbalance: what rounding leaves of it
_REACHES = 1e-6  # of the largest motion of the planes: a mode that the weights can feed
STRONG_DAMPING = 0.2  # damping ratio from which on release scatters by 5 % about the formula


@dataclass(frozen=True, eq=False)
class LeftBehind:
    """k weights that are left behind together near one natural frequency.

    Attributes:
        weights: k.
        numbers: of each group: those that are held most strongly.
        release_speed: of the rotor, at which they are let go [rad/s]; infinite: never; NaN: cannot
            tell, as beyond this speed the natural frequency meets another one.
        drag_ratio: drag over the present one below which they can be left behind at the rotor's
            speed, while the other weights keep their drag.
        frequency: at which they turn while the rotor turns at its speed [rad/s]; NaN: let go.
        amplitude: (n,) of the stations then, without the unbalance's own [m].
        peak: (w, lag) at the peak of the brake [rad/s].
        phases: (c,) of the groups at the peak [rad].
    """

    weights: int
    numbers: tuple[int, ...]
    release_speed: float
    drag_ratio: float
    frequency: float
    amplitude: Array
    peak: tuple[float, float]
    phases: Array

    @property
    def possible(self) -> bool:
        """Whether they can be left behind at the rotor's speed."""
        return not math.isnan(self.frequency)


@dataclass(frozen=True, eq=False)
class NaturalFrequency:
    """One at which weights can be left behind.

    Attributes:
        frequency, damping_ratio: of the rotor with its weights, at its speed [rad/s].
        motions: by k, ascending.
    """

    frequency: float
    damping_ratio: float
    motions: tuple[LeftBehind, ...]


@dataclass(frozen=True, eq=False)
class Capture:
    """What the closed form says of weights that are left behind.

    Attributes:
        speed: of the rotor [rad/s].
        groups: equal weights.
        drags: of each group [N s/m]; 1 for all where none has drag.
        natural: natural frequencies at which weights can be left behind, ascending.
        unbalance_amplitude: (n,) of the stations, the unbalance's own at this speed [m]; the
            largest distance while weights are left behind is the sum of both.
        unbalance_share: unbalance over capacity, of the plane that has most to undo.
        drag_ratio: drag over the present one from which on no weights can be left behind at this
            speed.
        slip: how far bunched weights can lag below a natural frequency above this speed [rad/s].
            There the brake rises up to the rotor's speed: the weights slip in the rotor, however
            large the drag, unless the unbalance holds them.
        lone_lag: how far a single weight, or one of several on a rotor without unbalance, can lag
            beyond all natural frequencies [rad/s], braked by strong damping of the supports; 0: by
            no more than weights that turn with the rotor.
        unstable: the rotor is unstable at this speed: nothing is said.
        undamped: natural frequency below this speed that has no damping [rad/s]; 0: none has.
            Weights can be left behind there whatever their drag, in no steady motion.
    """

    speed: float
    groups: tuple[Group, ...]
    drags: tuple[float, ...]
    natural: tuple[NaturalFrequency, ...]
    unbalance_amplitude: Array
    unbalance_share: float
    drag_ratio: float = 0.0
    slip: float = 0.0
    lone_lag: float = 0.0
    unstable: bool = False
    undamped: float = 0.0

    @property
    def count(self) -> int:
        """Number N of all weights."""
        return sum(group.count for group in self.groups)

    @property
    def motions(self) -> tuple[tuple[NaturalFrequency, LeftBehind], ...]:
        """Those that are possible at the rotor's speed."""
        return tuple((one, m) for one in self.natural for m in one.motions if m.possible)

    @property
    def release_speed(self) -> float:
        """From which on none is left behind in a slow run-up [rad/s]; 0: none ever is.

        NaN: cannot tell.
        """
        last = [one.motions[-1].release_speed for one in self.natural]
        if any(math.isnan(speed) for speed in last):
            return math.nan
        return max((m.release_speed for one in self.natural for m in one.motions
                    if not math.isnan(m.release_speed)), default=0.0)  # fmt: skip

    @property
    def all_pass(self) -> bool | None:
        """Whether no weights can be left behind at this speed, from whatever start.

        None: cannot tell.  The rotor is unstable, a natural frequency has no damping, weights can
        slip by more than those that turn with the rotor, and less than those that are left behind,
        or one weight can lag beyond all natural frequencies.
        """
        if self.unstable or self.undamped:
            return None
        if self.motions:
            return False
        return None if self.lone_lag or self.slip > WITH * self.speed else True


def capture(assembly: Assembly, speed: float) -> Capture:
    """Motions in which weights are left behind, while the rotor turns at `speed` [rad/s].

    Exact for supports that are alike in both axes and a rotor without unbalance, averaged over a
    turn otherwise; a liquid counts by its added mass.

    Raises:
        ValueError: there are no weights, the speed is not positive, or the supports have dry
            friction.
    """
    assembly.rotor.refuse_sliders("the closed form of weights that are left behind")
    groups = groups_of(assembly)
    if not groups:
        raise ValueError("no weights: only balls, rollers and pendulums can be left behind")
    if not speed > 0.0:
        raise ValueError(f"speed = {speed!r} rad/s: must be positive")
    drags = np.array([group.drag for group in groups])
    drags = drags if drags.all() else np.maximum(drags, 1.0 if not drags.any() else 1e-9)
    lag = Lag(groups, drags)
    receptance = Receptance(assembly.loaded_rotor, lag.used)
    alone, share = _unbalance(assembly, speed)
    found = Capture(speed, groups, tuple(drags.tolist()), (), alone, share)
    poles = receptance.poles(speed)
    if (poles.decay < -_NO_DAMPING * poles.frequency).any():
        return replace(found, unstable=True)
    if (undamped := _undamped(poles, speed, lag)) > 0.0:
        return replace(found, undamped=undamped)
    branches = find_branches(receptance, lag, speed)
    limit = drag_limit(branches, receptance, lag)
    alone_there = found.count == 1 or not np.any(assembly.rotor.unbalance)  # it holds others
    return replace(
        found,
        natural=tuple(_natural(branches, receptance, lag)),
        drag_ratio=limit,
        slip=largest_slip(branches),
        lone_lag=lone_lag(branches, receptance, lag) if alone_there else 0.0,
    )


def _undamped(poles: Poles, speed: float, lag: Lag) -> float:
    """The lowest natural frequency below a speed that weights reach and nothing damps; 0: none."""
    reach = np.abs(poles.shapes[:, lag.planes]).max(axis=1)
    held = (poles.decay <= _NO_DAMPING * poles.frequency) & (poles.frequency < speed)
    found = poles.frequency[held & (reach > _REACHES * reach.max(initial=0.0))]
    return float(found.min(initial=math.inf)) if len(found) else 0.0


def _unbalance(assembly: Assembly, speed: float) -> tuple[Array, float]:
    rotor = replace(assembly.loaded_rotor, beside=())  # it is the closed form of a linear rotor
    try:
        alone = largest_displacement(unbalance_response(rotor, [speed]))[0]
    except NoResponse:
        alone = np.full(rotor.stations, math.inf)
    return alone, _share(assembly)


def _share(assembly: Assembly) -> float:
    """Unbalance over the capacity of the plane that must undo most of it; over that of all weights
    where they cannot undo it."""
    capacities: dict[int, float] = {}
    for mounted in assembly.weights:
        held = sum(one.moment for one in weights_of(mounted).each)
        capacities[mounted.plane] = capacities.get(mounted.plane, 0.0) + held
    unbalance = assembly.rotor.unbalance
    full = (assembly.rotor.planes[list(capacities)].T * list(capacities.values())).astype(complex)
    shares = np.linalg.lstsq(full, unbalance, rcond=None)[0]
    if np.abs(full @ shares - unbalance).max() <= _UNDONE * np.abs(unbalance).max():
        return float(np.abs(shares).max())
    return float(abs(unbalance.sum()) / sum(capacities.values()))


def _natural(branches: Branches, receptance: Receptance, lag: Lag) -> Sequence[NaturalFrequency]:
    """The natural frequencies that have a peak."""
    rows = _last_of_each_number(branches)
    released = release_speeds(branches, receptance, lag, rows)
    frequency, phases = follow(branches, receptance, lag, rows)
    amplitude = _amplitudes(branches, receptance, lag, rows, frequency, phases)
    ratios = drag_ratios(branches)
    motions: dict[int, list[LeftBehind]] = {}
    for k, row in enumerate(rows.tolist()):
        peak, held = float(branches.peak[row]), float(branches.lag[row])
        numbers = branches.numbers[row]
        motions.setdefault(int(branches.pole[row]), []).append(
            LeftBehind(
                int(numbers.sum()), tuple(int(n) for n in numbers), float(released[k]),
                float(ratios[row]), float(frequency[k]), amplitude[k],
                (peak, held), branches.phases[row, branches.top[row]],
            )
        )  # fmt: skip
    poles = branches.poles
    size = np.hypot(poles.frequency, poles.decay)
    return [
        NaturalFrequency(float(size[p]), float(poles.decay[p] / size[p]), tuple(found))
        for p, found in sorted(motions.items())
    ]


def _last_of_each_number(branches: Branches) -> Array:
    """Of each k near each natural frequency the combination that is let go last."""
    released = branches.peak + branches.lag
    best: dict[tuple[int, int], int] = {}
    for row in np.flatnonzero(~np.isnan(branches.peak)).tolist():
        key = int(branches.pole[row]), int(branches.numbers[row].sum())
        if key not in best or released[row] > released[best[key]]:
            best[key] = row
    return np.array([best[key] for key in sorted(best)], int)


def _amplitudes(
    branches: Branches, receptance: Receptance, lag: Lag, rows: Array, w: Array, phases: Array
) -> Array:
    """Half the long axes of the stations' motion (r, n) [m]."""
    at = np.where(np.isnan(w), 1.0, w)
    force = lag.moments(branches.numbers[rows]) * at[:, None] ** 2 * np.exp(1j * phases)
    forces = np.zeros((len(rows), len(lag.used)), complex)
    for k, plane in enumerate(lag.planes):
        forces[:, plane] += force[:, k]
    if not len(rows):
        return np.zeros((0, receptance.rotor.stations))
    numbers = branches.numbers[rows]
    others = lag.others(at[:, None], branches.speed, numbers, receptance.parts)[..., 0]
    found = largest_displacement(receptance.displacements(at, branches.speed, forces, others))
    return np.where(np.isnan(w)[:, None], np.nan, found)


def brake_curve(assembly: Assembly, found: Capture, weights: int, frequency: Array) -> Array:
    """Lag [rad/s] that the brake of so many weights holds where they turn at frequencies (m,).

    Which weights, and how they stand to each other, is as near the closest natural frequency.
    """
    lag = Lag(found.groups, np.array(found.drags))
    receptance = Receptance(assembly.loaded_rotor, lag.used)
    at = np.array([one.frequency for one in found.natural])
    nearest = np.abs(frequency[:, None] - at).argmin(axis=1)
    numbers, phases = np.zeros((2, len(frequency), len(found.groups)))
    for k, one in enumerate(found.natural):
        there = next((m for m in one.motions if m.weights == weights), one.motions[-1])
        numbers[nearest == k], phases[nearest == k] = there.numbers, there.phases
    return lag.at(receptance, frequency[:, None], found.speed, numbers, phases)[0][:, 0]
