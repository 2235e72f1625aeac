"""How machines begin: weights at random angles, at rest or turning, and the drive."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...models.arrays import Array
from ...models.linear.modes import lowest_natural
from ..errors import UserError, refuse_seed
from ..master.names import weight
from ..scene import Scene
from ..scene.balancer import WeightBalancer
from ..scene.quantities import each_of
from ..units import in_both

STARTS = {
    "rest": "the rotor at its speed, weights at rest in the room",
    "turning": "the rotor at its speed, weights turning with it: the friendliest",
    "run-up": "rotor and weights at rest, the speed rises",
}
APART = 1e-4  # relative: drags of point weights that are alike
RUN_UP_PERIODS = 50.0  # of the lowest natural frequency, where the scene has no run-up of its own
_FEWEST, _MOST = 150.0, 500.0  # revolutions of a run at its speed
_SETTLING = 12.0  # times kappa m/h that it lasts


@dataclass(frozen=True)
class Job:
    """Runs that begin in one way at one speed, some of them.

    Attributes:
        scene: with the drive.
        speed: at the end [rad/s].
        columns, values: what differs from run to run, (n,) columns and (n, c).
        seconds: of a run; settled: of it at the end, at the speed.
        window: of these, seconds of one of the windows in which it is looked at; 0: a share of
            them.
    """

    scene: Scene
    speed: float
    columns: tuple[str, ...]
    values: Array
    seconds: float
    settled: float
    window: float = 0.0

    def longer(self, factor: float, rows: NDArray[np.intp], window: float = 0.0) -> Job:
        """The same runs of some rows, `factor` times as long at their speed."""
        more = (factor - 1.0) * self.settled
        return replace(
            self, values=self.values[rows], seconds=self.seconds + more,
            settled=self.settled + more, window=window,
        )  # fmt: skip


def holders(scene: Scene) -> list[WeightBalancer]:
    """Balancers with weights."""
    return [b for b in scene.balancer if isinstance(b, WeightBalancer)]


def perturbed(scene: Scene) -> tuple[Scene, str]:
    """Point weights that are alike made to differ, and what was done.

    Left as they are they would stay together for ever once a run brings them together.
    """
    changes: dict[str, Any] = {}
    for one in holders(scene):
        if one.weight_radius or one.count == 1 or one.unequal:
            continue
        key, value = ("drag", one.drag) if one.drag else ("mass", one.mass)
        factors = 1.0 + APART * (np.arange(one.count) - 0.5 * (one.count - 1))
        changes[f"{one.label}.{key}"] = [float(value * f) for f in factors]
    if not changes:
        return scene, ""
    names = ", ".join(changes)
    return scene.replace(changes), (
        f"Point weights that are alike were made to differ by {APART:g} ({names}): equal to the "
        "last bit they would never part again."
    )


def drive_to(scene: Scene, speed: float, start: str) -> tuple[Scene, float, str]:
    """The scene driven to a speed, when it reaches it [s], and in words where it is a default."""
    if start != "run-up":
        return scene.replace({"operation.speed": speed, **_no_length(scene)}), 0.0, ""
    own = scene.profile()
    if scene.operation.motor:
        return scene, 0.0, ""
    if own.changes and own.speeds[-1] > 0.0:
        factor = speed / own.end
        corners = [[t * factor, s * factor] for t, s in zip(own.times, own.speeds, strict=True)]
        said = "" if factor == 1.0 else "the scene's own run-up at its own accelerations"
    else:
        rotor = scene.assembly().resting_rotor
        seconds, low = RUN_UP_PERIODS * math.tau / lowest_natural(rotor), rotor.table_speeds[0]
        corners = [[0.0, low], [seconds, speed]]
        said = f"run-up from {low:.4g} within {seconds:.4g} s ({RUN_UP_PERIODS:g} periods of the "
        said += "lowest natural frequency), the scene has none of its own"
    driven = scene.replace({"operation.profile": corners, **_no_drive(), **_no_length(scene)})
    return driven, corners[-1][0], said


def first_speed(driven: Scene) -> float:
    """Of a run-up [rad/s]; above 0 where the scene's own rises from it, or a table begins there."""
    return 0.0 if driven.operation.motor else driven.profile().speed(0.0)


def run_up_begins(driven: Scene) -> str:
    """How rotor and weights begin a run-up."""
    first = first_speed(driven)
    if not first:
        return "rotor and weights at rest"
    return f"the rotor at {in_both(first, 'rad/s')}, weights turning with it"


def length(scene: Scene, speed: float) -> float:
    """Seconds at the speed until a motion has usually settled."""
    slowest = 0.0
    for one in holders(scene):
        masses = each_of(one.mass) or [one.mass]
        drags = each_of(one.drag) or [one.drag]
        pairs = zip(
            np.broadcast_to(masses, one.count), np.broadcast_to(drags, one.count), strict=True
        )
        slowest = max(slowest, *(one.kappa * m / d if d else math.inf for m, d in pairs))
    turns = _SETTLING * slowest * speed / math.tau
    return float(np.clip(turns, _FEWEST, _MOST)) * math.tau / speed


def job(
    scene: Scene, speed: float, start: str, seed: int, first: int, count: int
) -> tuple[Job, str]:
    """Runs `first` to `first + count` of a start at a speed, and what was assumed."""
    driven, reached, said = drive_to(scene, speed, start)
    refuse_seed(seed)
    columns, values = [], []
    backwards = -speed if start == "rest" else 0.0
    drawn = [_angles(scene, np.random.default_rng([seed, n])) for n in range(first, first + count)]
    place = 0
    for one in holders(scene):
        for k in range(1, one.count + 1):
            columns += [f"{one.label}.{weight(k, 'angle0')}", f"{one.label}.{weight(k, 'speed0')}"]
            values += [[row[place] for row in drawn], [backwards] * count]
            place += 1
    if scene.operation.gravity:  # weights at rest roll down: the rotor's angle is what is left
        columns.append("rotor.angle0")
        values.append([_rotor_angle(seed, n) for n in range(first, first + count)])
    settled = length(scene, speed)
    table = np.array(values).T
    return Job(driven, speed, tuple(columns), table, reached + settled, settled), said


def refuse_unknown(starts: list[str]) -> None:
    """Raise UserError for a start that does not exist, or none."""
    for name in starts:
        if name not in STARTS:
            raise UserError(f"starts {name!r}: must be some of {', '.join(STARTS)}, with commas")
    if not starts:
        raise UserError(f"starts: name at least one of {', '.join(STARTS)}")


def _angles(scene: Scene, random: np.random.Generator) -> list[float]:
    """Of all weights, at random; those with a size stand apart, in their order."""
    found: list[float] = []
    for one in holders(scene):
        if not one.weight_radius:
            found += random.uniform(0.0, math.tau, one.count).tolist()
            continue
        largest = max(each_of(one.weight_radius) or [one.weight_radius])
        apart = 2.0 * math.asin(min(1.0, largest / one.track_radius)) * (1.0 + 1e-6)
        room = math.tau - one.count * apart
        if room <= 0.0:
            found += list(one.angles)
            continue
        gaps = np.sort(random.uniform(0.0, room, one.count)) + apart * np.arange(one.count)
        turned = (gaps + random.uniform(0.0, math.tau)) % math.tau
        order = np.argsort(np.argsort([angle % math.tau for angle in one.angles], kind="stable"))
        found += turned[order].tolist()
    return found


def _rotor_angle(seed: int, number: int) -> float:
    """Of a start under gravity, at random [rad]."""
    return float(np.random.default_rng([seed, number, 1]).uniform(0.0, math.tau))


def _no_drive() -> dict[str, None]:
    return {"operation.speed": None, "operation.run_up": None, "operation.motor": None}


def _no_length(scene: Scene) -> dict[str, None]:
    given = ("revolutions", "duration")
    return {f"run.{key}": None for key in given if key in scene.run.model_fields_set}
