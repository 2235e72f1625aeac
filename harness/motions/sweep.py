"""Vibration while the speed rises slowly, and while it falls, and where they settle otherwise."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import groupby
from operator import attrgetter
from typing import Any, ClassVar

import numpy as np

from ...models.arrays import Array
from ...models.linear.modes import lowest_natural
from ..capture.captured import refuse_outside_tables
from ..errors import UserError
from ..output.outcome import Outcome
from ..output.table import Sheet
from ..scene import Scene
from .batch import squared_distances
from .held import Held, differ, held_at, hold
from .settle import alone, alone_at
from .starts import Job, job, perturbed

_PERIODS = 300.0  # of the lowest natural frequency that a sweep takes each way
_POINTS = 240  # windows of a sweep


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
        held: speeds at which both ways differ, held until they have settled, by rising speed.
    """

    drawn_by: ClassVar[str] = "..motions.plot:plot_sweep"

    title: str
    branches: tuple[Branch, Branch]
    alone: Array
    seconds: float
    held: tuple[Held, ...]

    def table(self) -> Sheet:
        """A row for every window of both."""
        rows = [
            [branch.name, float(w), float(v)]
            for branch in self.branches
            for w, v in zip(branch.speed, branch.vibration, strict=True)
        ]
        return Sheet(("way", "speed [rad/s]", "vibration [m]"), rows, "lrr", self.title)

    @property
    def ranges(self) -> tuple[tuple[float, float], ...]:
        """Lowest and highest speed of neighbours held at which both ways settle to different
        vibrations [rad/s]."""
        parts = (
            list(part) for differs, part in groupby(self.held, attrgetter("differs")) if differs
        )
        return tuple((part[0].speed, part[-1].speed) for part in parts)

    @property
    def hysteresis(self) -> tuple[float, float] | None:
        """Ends of all these ranges; None: both ways settle to the same everywhere."""
        return (self.ranges[0][0], self.ranges[-1][1]) if self.ranges else None

    def sentence(self) -> str:
        """Where the ways settle to different vibrations."""
        each = f"each way takes {self.seconds:.4g} s"
        if not self.held:
            return f"Rising and falling speed give the same vibration ({each})."
        settled = [one for one in self.held if one.is_settled]
        if self.ranges:
            ends = " and ".join(
                f"from {a:.4g} to {b:.4g}" if a < b else f"at {a:.4g}" for a, b in self.ranges
            )
            said = "Rising and falling speed settle to different vibrations "
            said += f"{ends} rad/s ({len(self.held)} speeds were held, {each})."
        else:
            said = f"Rising and falling speed differ from {self.held[0].speed:.4g} to "
            said += f"{self.held[-1].speed:.4g} rad/s, but only while the speed moves ({each}): at "
            said += f"{len(settled)} speeds that were held both settle to the same vibration."
        if len(settled) < len(self.held):
            at = ", ".join(f"{one.speed:.4g}" for one in self.held if not one.is_settled)
            said += f" Cannot tell at {at} rad/s: the motion had not settled when it was held."
        return said

    def as_json(self) -> dict[str, Any]:
        """Everything."""
        return {
            "seconds": self.seconds,
            "hysteresis": None if self.hysteresis is None else list(self.hysteresis),
            "ranges": [list(ends) for ends in self.ranges],
            "held": [one.as_json() for one in self.held],
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
    jobs = [_sweeping(scene, first, last, seconds, seed) for _, first, last in ways]
    up, down = (_way(*way, made) for way, made in zip(ways, jobs, strict=True))
    bare = alone_at(scene, up.speed)

    def both(row: int) -> Held:
        speed = float(up.speed[row])
        rising, falling = (
            held_at(made, speed, _reached(made, first, last, speed))
            for (_, first, last), made in zip(ways, jobs, strict=True)
        )
        return Held(speed, rising, falling, alone(scene, speed))

    back = np.interp(up.speed, down.speed[::-1], down.vibration[::-1])
    held = hold(np.flatnonzero(differ(up.vibration, back, bare)), both)
    return Sweep(scene.heading, (up, down), bare, seconds, held)


def _sweeping(scene: Scene, first: float, last: float, seconds: float, seed: int) -> Job:
    """A hold at the first speed, then the change; weights begin turning with the rotor."""
    made, _ = job(scene, first, "turning", seed, 0, 1)
    begins = made.settled
    corners = [[0.0, first], [begins, first], [begins + seconds, last]]
    changes: dict[str, Any] = {"operation.speed": None, "operation.profile": corners}
    driven = made.scene.replace(changes)
    return replace(
        made, scene=driven, speed=max(first, last), seconds=begins + seconds, settled=seconds
    )


def _reached(made: Job, first: float, last: float, speed: float) -> float:
    """When it reaches a speed [s]."""
    return made.seconds - made.settled * (last - speed) / (last - first)


def _way(name: str, first: float, last: float, made: Job) -> Branch:
    """Its run."""
    moved, reasons = squared_distances(made)
    if reasons[0]:
        raise UserError(f"the {name} sweep has failed: {reasons[0]}")
    seconds, begins = made.settled, made.seconds - made.settled
    time = np.linspace(0.0, made.seconds, moved.shape[1])
    late = time >= begins
    size, at = np.sqrt(moved[0][late]), time[late] - begins
    per = len(size) // _POINTS
    windows = size[: per * _POINTS].reshape(_POINTS, per).max(axis=1)
    middles = at[: per * _POINTS].reshape(_POINTS, per).mean(axis=1)
    return Branch(name, first + (last - first) * middles / seconds, windows)
