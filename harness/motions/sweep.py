"""Vibration while the speed rises slowly, and while it falls, and where they differ."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from ...models.arrays import Array
from ...models.harmonic_balance import NoResponse, largest_displacement, unbalance_response
from ...models.linear.modes import lowest_natural
from ..capture.captured import refuse_outside_tables
from ..errors import UserError
from ..output.outcome import Outcome
from ..output.table import Sheet
from ..scene import Scene
from .batch import displacements
from .starts import Job, job, perturbed

_PERIODS = 300.0  # of the lowest natural frequency that a sweep takes each way
_POINTS = 240  # windows of a sweep
_DIFFERENT = 1.5  # ratio of vibrations at one speed that is a hysteresis


@dataclass(frozen=True, eq=False)
class Branch:
    """One way.

    Attributes:
        name: rising or falling.
        speed, vibration: (k,) of the rotor [rad/s], largest distance in its window [m].
    """

    name: str
    speed: Array
    vibration: Array


@dataclass(frozen=True, eq=False, repr=False)
class Sweep(Outcome):
    """Both ways.

    Attributes:
        branches: rising and falling.
        alone: (k,) vibration without balancers at the rising speeds [m].
        seconds: that each takes.
    """

    drawn_by: ClassVar[str] = "..motions.plot:plot_sweep"

    title: str
    branches: tuple[Branch, Branch]
    alone: Array
    seconds: float

    def table(self) -> Sheet:
        """A row for every window of both."""
        rows = [
            [branch.name, float(w), float(v)]
            for branch in self.branches
            for w, v in zip(branch.speed, branch.vibration, strict=True)
        ]
        return Sheet(("way", "speed [rad/s]", "vibration [m]"), rows, "lrr", self.title)

    @property
    def hysteresis(self) -> tuple[float, float] | None:
        """Speeds between which both ways differ [rad/s]; None: nowhere."""
        up, down = self.branches
        back = np.interp(up.speed, down.speed[::-1], down.vibration[::-1])
        ratio = np.maximum(up.vibration, back) / np.maximum(np.minimum(up.vibration, back), 1e-300)
        at = np.flatnonzero(
            (ratio > _DIFFERENT) & (np.maximum(up.vibration, back) > 0.05 * self.alone)
        )
        return (float(up.speed[at[0]]), float(up.speed[at[-1]])) if len(at) else None

    def sentence(self) -> str:
        """Where the ways differ."""
        found = self.hysteresis
        each = f"each way takes {self.seconds:.4g} s"
        if found is None:
            return f"Rising and falling speed give the same vibration ({each})."
        return (
            f"Rising and falling speed differ between {found[0]:.4g} and {found[1]:.4g} rad/s "
            f"({each})."
        )

    def as_json(self) -> dict[str, Any]:
        """Everything."""
        return {
            "seconds": self.seconds,
            "hysteresis": None if self.hysteresis is None else list(self.hysteresis),
            "without_balancers": self.alone.tolist(),
            "branches": [
                {"name": b.name, "speed": b.speed.tolist(), "vibration": b.vibration.tolist()}
                for b in self.branches
            ],
        }


def sweep(scene: Scene, low: float, high: float, *, seed: int = 1) -> Sweep:
    """One slow rise from `low` to `high` [rad/s] and one fall from a balanced start at `high`.

    Raises:
        UserError: the range is empty, tables of bearings do not hold it, or a run fails.
    """
    scene.refuse_free("a sweep")
    if not 0.0 < low < high:
        raise UserError(f"--sweep {low:g} to {high:g} rad/s: must be positive and rising")
    for end in (low, high):
        refuse_outside_tables(scene, end)
    scene, _ = perturbed(scene)
    lowest = lowest_natural(scene.assembly().resting_rotor)
    seconds = _PERIODS * math.tau / lowest
    ways = (("rising", low, high), ("falling", high, low))
    branches = tuple(_way(scene, *way, seconds, seed) for way in ways)
    speeds = branches[0].speed
    try:
        alone = largest_displacement(unbalance_response(scene.assembly().rotor, speeds)).max(axis=1)
    except NoResponse:
        alone = np.full(len(speeds), np.nan)
    return Sweep(scene.heading, (branches[0], branches[1]), alone, seconds)


def _way(scene: Scene, name: str, first: float, last: float, seconds: float, seed: int) -> Branch:
    """A hold at the first speed, then the change; weights begin turning with the rotor."""
    made, _ = job(scene, first, "turning", seed, 0, 1)
    hold = made.settled
    corners = [[0.0, first], [hold, first], [hold + seconds, last]]
    changes: dict[str, Any] = {"operation.speed": None, "operation.profile": corners}
    driven = made.scene.replace(changes)
    whole = Job(driven, max(first, last), made.columns, made.values, hold + seconds, seconds)
    moved, reasons = displacements(whole)
    if reasons[0]:
        raise UserError(f"the {name} sweep has failed: {reasons[0]}")
    time = np.linspace(0.0, hold + seconds, moved.shape[1])
    late = time >= hold
    size, at = np.sqrt(moved[0][late]), time[late] - hold
    per = len(size) // _POINTS
    windows = size[: per * _POINTS].reshape(_POINTS, per).max(axis=1)
    middles = at[: per * _POINTS].reshape(_POINTS, per).mean(axis=1)
    return Branch(name, first + (last - first) * middles / seconds, windows)
