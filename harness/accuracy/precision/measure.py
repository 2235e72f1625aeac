"""Error against run time: every coupling scheme, the monolith by SciPy, and another master.

The measure: largest difference from the reference over time and recorded signals, relative to each
signal's range; the smallest of several processor times, all methods taking turns so that whatever
else the machine does meets all alike (libcosim's by the clock: it has threads).
"""

from __future__ import annotations

import math
import time as clock
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from ....models.reference.trajectory import Trajectory
from ...errors import SimulationError
from ...master.recorder import recorded
from ...output.outcome import Outcome
from ...output.table import Sheet
from ...output.workers import ItemProgress
from ...scene import Scene
from ...scene.balancer import Liquid
from ...scene.model_rules import needs_native_units
from .methods import (
    Method,
    Runner,
    TimedRun,
    coupling_methods,
    monolith_methods,
    ready,
)
from .reference import refuse_without_reference, right_motion, signal_ranges

LEAST_GROWTH = 1.5  # of the work, over the points that show an order
TWO_DECADES = 100.0  # the reference must be that much better than a point whose error counts
ASYMPTOTIC = 0.03  # an error above it says nothing of a method's order
FEWEST_ROUNDS, MOST_ROUNDS = 2, 7
TARGETS = (1e-3, 1e-5, 1e-7, 1e-9)
SHARE = 1 / 90  # of the time given for one run, so that some thirty methods can take three turns
SHARE_CUBIC = 1 / 45  # the same where small errors are to be had
KEYS = (
    "scene", "method", "order", "steps_per_rev", "corrections", "tolerance",
    "error", "seconds", "status", "at_end", "work",
)  # fmt: skip
FINER = 1.5  # how much longer a run takes than the one before it: steps grow by 1.2 to 2


@dataclass(frozen=True)
class Point:
    """One method at one step or tolerance.

    Attributes:
        error: over time and signals, relative to each signal's range.
        at_end: the same at the end of the run.
        seconds: smallest of the runs.
        work: communication steps, or evaluations of the right-hand side.
        status: `ok`, or what is wrong with it in words.
    """

    scene: str
    method: Method
    error: float | None
    at_end: float | None
    seconds: float | None
    work: int | None
    status: str


@dataclass(frozen=True, repr=False)
class Precision(Outcome):
    """Everything measured for one scene.

    Attributes:
        reference_error: by how much the two reference methods differ, relative to the ranges.
        rounds: how often every method was timed.
        orders: observed order by family of methods: error ~ work^-order.
    """

    drawn_by: ClassVar[str] = "..accuracy.precision.plot:plot_precision"

    scene: Scene
    points: tuple[Point, ...]
    signals: tuple[str, ...]
    reference_error: float
    rounds: int
    orders: Mapping[str, float] = field(default_factory=dict)

    def table(self) -> Sheet:
        """A row for every method, step and tolerance: errors of the range, seconds."""
        rows = []
        for point in self.points:
            name = point.method.name + " in one file" * point.method.one_file
            values = {**vars(point.method), **vars(point), "method": name}
            rows.append([values[key] for key in KEYS])
        return Sheet(KEYS, rows, title=self.scene.heading)

    def cheapest(
        self, error: float, *, coupled: bool | None = None, one_file: bool = False
    ) -> Point | None:
        """The fastest point at least that exact.

        Args:
            coupled: only co-simulations, or only the monolith.
            one_file: only the composite; else all but that.

        >>> short = ab.load("liquid_closed").replace({"run.revolutions": 0.5})
        >>> short.precision(1.0).cheapest(1e-4, coupled=True).error <= 1e-4
        True
        """
        asked = [
            p
            for p in self.points
            if (coupled is None or coupled != p.method.in_one_piece)
            and p.method.one_file == one_file
        ]
        return cheapest(asked, error)


def cheapest(points: Sequence[Point], error: float) -> Point | None:
    """The fastest of some points that is at least that exact."""
    exact = [p for p in points if p.error is not None and p.error <= error]
    return min(exact, key=lambda point: point.seconds or math.inf, default=None)


def precision(
    scene: Scene,
    *,
    seconds: float = 75.0,
    methods: Sequence[Method] | None = None,
    progress: ItemProgress | None = None,
) -> Precision:
    """Measure a scene.

    Args:
        seconds: about how long all of it may take; methods too slow for it are left out by name.
        methods: by default every one there is.
        progress: called with what is being done, and the finished fraction.

    Raises:
        SimulationError: the reference methods disagree, so that the error cannot be measured.
        UserError: the scene or an FMU is wrong.
    """
    refuse_without_reference(scene)
    names = tuple(recorded(scene))
    chosen = list(methods) if methods is not None else all_methods(scene)
    with ExitStack() as opened:
        bench = _Bench(scene, names, seconds, progress or (lambda _what, _part: None), opened)
        bench.warm_up(chosen)
        right, own = right_motion(scene, names, [run.time for run in bench.first.values()])
        rounds = bench.rounds()
    ranges = signal_ranges(scene, right, names)
    points = tuple(_point(scene, m, bench, right, ranges, own) for m in chosen)
    return Precision(scene, points, names, own, rounds, observed_orders(points, own))


def all_methods(scene: Scene) -> list[Method]:
    """Every method that could run the scene."""
    exchanges = any(not isinstance(b, Liquid) or b.inertia_as_force for b in scene.balancer)
    methods = coupling_methods(exchanges)
    if scene.operation.motor:
        methods = [m for m in methods if m.one_file]
    if any(needs_native_units(scene)):
        methods = [m for m in methods if m.units != "python"]
    return methods + monolith_methods()


class _Bench:
    """All methods made ready, warmed up once, then timed in turns."""

    def __init__(
        self,
        scene: Scene,
        names: Sequence[str],
        seconds: float,
        progress: ItemProgress,
        opened: ExitStack,
    ) -> None:
        self._scene, self._names, self._progress, self._opened = scene, names, progress, opened
        self._start_time, self._seconds = clock.perf_counter(), seconds
        self._ready: dict[Method, Runner] = {}
        self.first: dict[Method, TimedRun] = {}
        self.status: dict[Method, str] = {}
        self.best: dict[Method, float] = {}

    def warm_up(self, methods: Sequence[Method]) -> None:
        """Load and run every method once; the runs give the errors."""
        slowest: dict[str, float] = {}
        for number, method in enumerate(methods):
            self._progress(f"{method.family}, {method.setting}", 0.5 * number / len(methods))
            limit = self._seconds * (SHARE if method.order in (0, 1) else SHARE_CUBIC)
            if FINER * slowest.get(method.family, 0.0) > limit:
                self.status[method] = f"left out: takes more than {limit:.2g} s per run (--seconds)"
                continue
            try:
                runner = ready(self._scene, method, self._names, self._opened)
                run = runner()
            except (SimulationError, ArithmeticError) as error:
                self.status[method] = f"failed: {error}"
                continue
            self._ready[method] = runner
            slowest[method.family] = run.seconds
            self.first[method], self.status[method] = run, run.note or "ok"

    def rounds(self) -> int:
        """Time all methods in turns until the time is used; returns how many rounds were made."""
        for done in range(1, MOST_ROUNDS + 1):
            start_time = clock.perf_counter()
            for number, (method, runner) in enumerate(self._ready.items()):
                used = (done - 1 + number / len(self._ready)) / MOST_ROUNDS
                self._progress(f"round {done}", 0.5 + 0.5 * used)
                seconds = runner().seconds
                self.best[method] = min(self.best.get(method, math.inf), seconds)
            now = clock.perf_counter()
            late = now + (now - start_time) > self._start_time + self._seconds
            if late and done >= FEWEST_ROUNDS:
                break
        return done


def _point(
    scene: Scene,
    method: Method,
    bench: _Bench,
    right: Trajectory,
    ranges: Mapping[str, float],
    own: float,
) -> Point:
    run = bench.first.get(method)
    if run is None:
        return Point(scene.name, method, None, None, None, None, bench.status[method])
    at = np.searchsorted(right.time, run.time)
    gaps = [
        np.abs(run.signals[name] - right.signal(name)[at]) / size for name, size in ranges.items()
    ]
    error, at_end = float(np.max(gaps)), float(np.max([gap[-1] for gap in gaps]))
    status = bench.status[method]
    if not math.isfinite(error):
        return Point(scene.name, method, None, None, None, run.work, "failed: not finite")
    if error > 1.0:
        status = "failed: the error is larger than the signal"
    elif error < TWO_DECADES * own and status == "ok":
        status = "ok, within two decades of the reference's own error"
    seconds = bench.best.get(method, run.seconds)
    return Point(scene.name, method, error, at_end, seconds, run.work, status)


def observed_orders(points: Sequence[Point], own: float) -> dict[str, float]:
    """Slope of log error against log work of every family, over its points in the asymptotic range.

    Those are errors below `ASYMPTOTIC` and two decades above the reference's own; at least two,
    and of more the three finest.  Where their work hardly differs there is none: a power series
    meets a smaller tolerance by more terms.
    """
    families: dict[str, list[tuple[float, float]]] = {}
    for point in points:
        if point.error and point.work and TWO_DECADES * own < point.error < ASYMPTOTIC:
            families.setdefault(point.method.family, []).append((point.work, point.error))
    orders = {}
    for family, pairs in families.items():
        work, errors = np.log(sorted(pairs)[-3:]).T
        if np.ptp(work) > np.log(LEAST_GROWTH):
            orders[family] = -float(np.polyfit(work, errors, 1)[0])
    return orders
