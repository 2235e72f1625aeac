"""Verdicts on random runs against an independent integration that goes on ten times as long.

    python -m tests.studies.verdicts [--each 24] [--seed 1] [--by reference|units] [--family NAME]

Families are planar discs in short runs, over capacity, below and near resonance, and as they
settle; gravity, liquids, motors, profiles, run-ups, unbalances that change, two planes, tracks off
centre; discs that tilt, bearings and bodies; supports with rigid dry friction, free strokes, stops
and cubic springs.

The integration is `models.reference`, which shares no code with the units; `--by units` continues
with the units instead, which is some hundred times faster.  Stops, which the reference does not
have, are continued by the units always.  The steady vibration of the rotor alone is solved for; on
supports that are not linear it is integrated.  What counts is the vibration at the rotor's
frequency; on such supports all of it, for every verdict but "balanced", beside which a precession
may decay.
"""

from __future__ import annotations

import argparse
import math
import os
import warnings
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import partial

import numpy as np
from numpy.typing import NDArray

from autobalancer.harness import Scene, SimulationError, cosimulate
from autobalancer.harness.output.table import Sheet
from autobalancer.harness.output.workers import in_order
from autobalancer.harness.result.verdict import Outcome, Verdict
from autobalancer.models.monolith import simulate
from tests.studies.verdict_scenes import FAMILIES, drawn

LONGER = 10.0  # times the run that the integration goes on
BALANCED, ROOM = 0.05, 1.2  # of the vibration alone; by which a balanced rotor may leave it again
WINDOW, POINTS = 8.0, 24  # revolutions of a window, and points in each of them
MOST_REVOLUTIONS = 6000.0  # that advice is followed for
ALIKE = 0.03  # of the vibration: that of a steady motion changes by less
LATE, NOTHING = 8, 1e-12  # last windows of a rotor alone; m, below which it is at rest
RTOL = 1e-8
NOT_BALANCED = {
    Outcome.BELOW_CRITICAL, Outcome.UNSTABLE, Outcome.ANOTHER_MOTION, Outcome.STUCK,
    Outcome.OUT_OF_REACH, Outcome.TOGETHER, Outcome.OFF_CENTRE, Outcome.OVER_CAPACITY,
}  # fmt: skip
Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Judged:
    """A verdict and what is right.

    Attributes:
        wrong: what is wrong about it; empty where nothing is.
        undecided: whether it leaves open what becomes of the machine.
        told: vibration over that of the rotor alone at the run's end and after it, in windows.
    """

    family: str
    number: int
    outcome: str
    wrong: str
    text: str
    undecided: bool
    told: tuple[float, ...] = field(default=())


@dataclass(frozen=True, eq=False)
class Continued:
    """Vibration at the rotor's frequency, and all of it, over that of the rotor alone, by window.

    Attributes:
        time: ends of the windows [s].
        synchronous, largest: (k,) each; about the mean of the window.
        at_end: window that the run ends with.
    """

    time: Floats
    synchronous: Floats
    largest: Floats
    at_end: int


def judge(family: str, number: int, seed: int, by: str = "reference") -> Judged:
    """One random scene: its verdict against what becomes of it."""
    scene = Scene.from_document(drawn(family, number, seed))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            result = cosimulate(scene)
        except SimulationError as error:  # a rotor that whirls beyond any bound has no verdict
            return Judged(family, number, "refused", "", str(error), undecided=False)
        verdict = result.summary()
        found = partial(Judged, family, number, verdict.outcome.value, text=str(verdict),
                        undecided=is_undecided(verdict))  # fmt: skip
        try:
            wrong, told = check(scene, verdict, float(result.time[-1]), by)
        except ArithmeticError as error:  # the reference gave up
            return found(wrong="", told=(), text=f"no reference: {error}")
        except SimulationError as error:  # continued, it whirls beyond any bound
            wrong = "balanced, and continued it has no end" if verdict.balanced else ""
            return found(wrong=wrong, told=(), text=f"{verdict}; continued: {error}")
    return found(wrong=wrong, told=told)


def is_undecided(verdict: Verdict) -> bool:
    """Whether a verdict cannot tell, or sees a transient without saying when it ends."""
    if verdict.outcome is Outcome.CANNOT_TELL:
        return True
    waits = verdict.outcome in (Outcome.NOT_SETTLED, Outcome.SPEED_CHANGES)
    says = ("set run.revolutions = ", "keep this speed for ")
    return waits and not any(text in verdict.reason for text in says)


def check(scene: Scene, verdict: Verdict, end: float, by: str) -> tuple[str, tuple[float, ...]]:
    """What is wrong about a verdict, and the vibration by window."""
    outcome = verdict.outcome
    if outcome in (Outcome.CANNOT_TELL, Outcome.STANDSTILL):
        return "", ()
    if outcome is Outcome.SPEED_CHANGES and (verdict.revolutions is None or not _motor(scene)):
        return "", ()
    if outcome is Outcome.OVER_CAPACITY and not any(m.offset for m in scene.assembly().weights):
        held = sum(b.count * b.mass * b.track_radius for b in scene.balancer if hasattr(b, "mass"))
        total = float(np.abs(scene.assembly().at(end).rotor.unbalance).sum())
        return ("within the capacity" if total <= held and len(scene.balancer) == 1 else ""), ()
    stop, judged = plateau(scene, verdict, end)
    advised = verdict.revolutions
    if advised is not None and advised > MOST_REVOLUTIONS:
        return "", ()
    last = stop + LONGER * judged
    if advised is not None:
        last = scene.profile().time_of(math.tau * advised)
    ways = continued(scene, verdict, stop, last, by)
    told = tuple(ways.synchronous[ways.at_end :].tolist())
    return wrong_about(verdict, ways, judged), told


def _motor(scene: Scene) -> bool:
    return scene.operation.motor is not None


def plateau(scene: Scene, verdict: Verdict, end: float) -> tuple[float, float]:
    """End and length of the plateau that is judged [s]."""
    for begin, stop, one in verdict.plateaus:
        if one.outcome is verdict.outcome and one.speed == verdict.speed:
            return stop, stop - begin
    return end, end


def continued(scene: Scene, verdict: Verdict, stop: float, last: float, by: str) -> Continued:
    """The motion from the start on, at the last speed for longer, by window."""
    going_on = held_at(scene, stop, last)
    speed = verdict.speed or scene.profile().end
    if verdict.outcome is Outcome.SPEED_CHANGES:  # advice ends where the motor keeps its speed
        speed = scene.profile().end
    period = math.tau / speed
    width = min(WINDOW * period, 0.5 * stop)
    ends = np.linspace(stop, last, 40) if last > stop else np.array([stop])
    ends = ends[ends - width >= 0.0]
    step = period / POINTS
    count = max(8, round(width / step))
    times = (ends[:, None] - width) + width * (np.arange(count) + 0.5) / count
    size, largest = sizes(going_on, times, by)
    if scene.rotor.is_linear:
        alone = vibration_alone(scene, speed, stop)
        return Continued(ends, size / alone, largest / alone, 0)
    without = sizes(going_on.without_balancers(), times[-LATE:], by)[1]
    if np.ptp(without) > ALIKE * without.max() or without[-1] < NOTHING:
        raise ArithmeticError("the rotor alone comes to no steady vibration")
    counts = size if verdict.outcome is Outcome.BALANCED else largest
    return Continued(ends, counts / without[-1], largest / without[-1], 0)


def sizes(scene: Scene, times: Floats, by: str) -> tuple[Floats, Floats]:
    """Vibration at the rotor's frequency, and all of it, about the mean of every window [m].

    Args:
        times: (windows, points) [s].
    """
    count = times.shape[1]
    x, y, angle = motion(scene, times.ravel(), by)
    shape = (*times.shape, -1)
    parts = [part.reshape(shape) for part in (x, y)]
    hann = np.sin(math.pi * (np.arange(count) + 0.5) / count) ** 2
    turn = np.exp(-1j * angle.reshape(times.shape))[..., None] * hann[:, None] / hann.sum()
    bodies = [part - (part * hann[:, None]).sum(axis=1, keepdims=True) / hann.sum()
              for part in parts]  # fmt: skip
    a, b = (2.0 * (body * turn).sum(axis=1) for body in bodies)
    return half_axis(a, b).max(axis=1), np.hypot(*bodies).max(axis=(1, 2))


def held_at(scene: Scene, stop: float, last: float) -> Scene:
    """The scene with the speed at `stop` [s] kept until `last`, and a run that is as long."""
    changes: dict[str, object] = {}
    profile = scene.profile()
    if profile.changes and not scene.operation.motor:
        corners = [(t, s) for t, s in zip(profile.times, profile.speeds, strict=True) if t < stop]
        changes["operation.profile"] = [*corners, (stop, profile.speed(stop)),
                                        (last * 1.001, profile.speed(stop))]  # fmt: skip
        changes["run.revolutions"] = None
        return scene.replace(changes)
    return scene.replace({"run.revolutions": profile.angle(last * 1.001) / math.tau})


def motion(scene: Scene, times: Floats, by: str) -> tuple[Floats, Floats, Floats]:
    """x and y of all stations (T, n) from the sag [m], and the rotor's angle (T,) [rad]."""
    order = np.argsort(times, kind="stable")
    at, back = times[order], np.argsort(order, kind="stable")
    shown = len(scene.rotor.stations)  # bodies and axes of discs are behind
    rest = scene.assembly().loaded_rotor.rest_position(scene.operation.start_speed)[:, :shown]
    if by == "reference" and not scene.rotor.stops:
        run = simulate(
            scene.assembly(), scene.operation.drive(), at,
            initial=scene.run.initial.motion(), rtol=RTOL,
        )  # fmt: skip
        x, y = run.x[back][:, :shown], run.y[back][:, :shown]
        return x - rest[0], y - rest[1], run.angle[back]
    from autobalancer.harness.master.names import stations

    prefixes = stations(len(scene.rotor.points))[:shown]
    names = [f"rotor.{p}{axis}" for axis in "xy" for p in prefixes] + ["rotor.angle"]
    names += [f"rotor.{p}v{axis}" for axis in "xy" for p in prefixes]
    result = cosimulate(scene, record=names)
    from scipy.interpolate import CubicHermiteSpline

    def values(axis: str) -> Floats:
        columns = [
            CubicHermiteSpline(
                result.time, result[f"rotor.{p}{axis}"], result[f"rotor.{p}v{axis}"]
            )(at)
            for p in prefixes
        ]
        return np.stack(columns, axis=1)[back]

    angle = np.interp(at, result.time, result["rotor.angle"])[back]
    return values("x") - rest[0], values("y") - rest[1], angle


def vibration_alone(scene: Scene, speed: float, time: float) -> float:
    """Largest half axis of the steady motion of the rotor alone [m]."""
    rotor = scene.assembly().at(time).rotor
    mass, damping, stiffness = rotor.real_coefficients(speed)
    pull = speed**2 * np.concatenate([rotor.unbalance, -1j * rotor.unbalance])
    found = np.linalg.solve(stiffness - speed**2 * mass + 1j * speed * damping, pull)
    return float(half_axis(*found.reshape(2, -1)[:, : len(scene.rotor.stations)]).max())


def half_axis(x: NDArray, y: NDArray) -> Floats:
    """Longer half axis of ellipses x, y = Re(a e^{i angle})."""
    return np.sqrt(0.5 * (np.abs(x) ** 2 + np.abs(y) ** 2 + np.abs(x**2 + y**2)))


def wrong_about(verdict: Verdict, ways: Continued, judged: float) -> str:
    """What a verdict says that does not come true; empty where all does."""
    size, outcome = ways.synchronous, verdict.outcome
    if not len(size):
        return ""
    is_balanced = size[-1] <= BALANCED
    if outcome is Outcome.BALANCED:
        if size.max() > ROOM * BALANCED or size[-1] > 1.02 * BALANCED:
            return f"balanced, and continued the vibration is up to {100.0 * size.max():.3g} %"
        return ""
    if outcome in (Outcome.NOT_SETTLED, Outcome.SPEED_CHANGES):
        if verdict.revolutions is not None:
            return "" if is_balanced or len(size) == 1 else (
                f"advised length reached, and the vibration is {100.0 * size[-1]:.3g} %"
            )  # fmt: skip
        slow = verdict.growth is not None and -verdict.growth * LONGER * judged < 2.0
        scale = max(float(ways.largest.max()), BALANCED)
        moved = np.abs(ways.largest - ways.largest[0]).max() > ALIKE * scale
        return "" if moved or slow else "not settled, and nothing changes any more"
    if outcome is Outcome.GRAVITY_SWING:
        late = ways.largest[len(size) // 2 :]
        return "gravity, and continued it is balanced" if late.max() <= BALANCED else ""
    if verdict.left_behind is not None and ways.largest[-1] > BALANCED:
        return ""
    if outcome in NOT_BALANCED and is_balanced:
        grows = (verdict.growth or 0.0) * LONGER * judged
        slow = outcome in (Outcome.UNSTABLE, Outcome.BELOW_CRITICAL) and grows < 10.0
        return "" if slow else f"not balanced, and continued {100.0 * size[-1]:.3g} %"
    if outcome is Outcome.RAISED and size[-1] < 1.0 - 1e-3:
        return f"raised, and continued {100.0 * size[-1]:.3g} %"
    if outcome is Outcome.LOWERED and not BALANCED <= size[-1] <= 1.0 + 1e-3:
        settled = verdict.growth is not None and -verdict.growth * LONGER * judged > 5.0
        return f"lowered, and continued {100.0 * size[-1]:.3g} %" if settled else ""
    return ""


def study(each: int, seed: int, by: str, families: list[str], first: int = 0) -> Iterator[Judged]:
    """Many random scenes on all cores."""
    items = [(family, n) for family in families for n in range(first, first + each)]
    workers = os.cpu_count() or 1
    yield from in_order(partial(_one, seed, by), items, workers)


def _one(seed: int, by: str, item: tuple[str, int]) -> Judged:
    return judge(*item, seed, by)


def table(found: list[Judged]) -> Sheet:
    """Outcomes by family, and how many are wrong."""
    every = (*(outcome.value for outcome in Outcome), "refused")
    outcomes = [name for name in every if any(j.outcome == name for j in found)]
    rows = []
    for name in [*dict.fromkeys(j.family for j in found), "all"]:
        mine = [j for j in found if name in (j.family, "all")]
        counts = Counter(j.outcome for j in mine)
        wrong, open_ = sum(bool(j.wrong) for j in mine), sum(j.undecided for j in mine)
        row = [name, str(len(mine)), str(wrong), str(open_)]
        rows.append([*row, *(str(counts[o]) for o in outcomes)])
    heads = ["family", "scenes", "wrong", "undecided", *outcomes]
    return Sheet(heads, rows, "l" + "r" * (3 + len(outcomes)))


def main() -> None:
    """The study by its command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--each", type=int, default=24, help="scenes of every family")
    parser.add_argument("--first", type=int, default=0, help="number of the first")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--by", choices=("reference", "units"), default="reference")
    parser.add_argument("--family", action="append", choices=tuple(FAMILIES))
    parser.add_argument("--verbose", action="store_true", help="print every verdict")
    given = parser.parse_args()
    families = given.family or list(FAMILIES)
    found = list(study(given.each, given.seed, given.by, families, given.first))
    for one in found:
        if one.wrong or given.verbose:
            told = " ".join(f"{100.0 * v:.3g}" for v in one.told[:: max(1, len(one.told) // 8)])
            print(f"{one.family} {one.number}: {one.wrong}\n    {one.text}\n    [{told}] %")
    print(table(found).markdown())


if __name__ == "__main__":
    main()
