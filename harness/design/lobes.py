"""What a race that is not round leaves of the vibration: table and sentence."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...models.assembly import Assembly, weights_of
from ...models.linear.on_race import has_lobes, main_motion
from ...models.lobes import Lobes, Race, Rest
from ...models.weights import Weights
from ..errors import UserError
from ..output.outcome import Outcome
from ..output.table import Sheet
from ..result.verdict import vibration_alone
from ..scene import Scene
from ..units import si_number

_BALANCED = 1e-6  # of the vibration without weights
_TURNS = 12  # angles of the race against the unbalance at which the worst is looked for


@dataclass(frozen=True, repr=False)
class OutOfRound(Outcome):
    """What weights leave on a race with lobes.

    Attributes:
        title: of the scene.
        called: the weights' kind.
        alone: vibration without them [m].
        lobes: of the race.
        left: of each lobe alone, and of all together last: vibration at the given angle and at
            the worst one [m]; None where no motion at rest in the rotor is stable.
        angles: of the weights with all lobes [rad].
    """

    title: str
    called: str
    alone: float
    lobes: tuple[Lobes, ...]
    left: tuple[tuple[float | None, float | None], ...]
    angles: tuple[float, ...]

    def table(self) -> Sheet:
        """A row for every lobe, and one for all."""
        names = [f"{one.order}" for one in self.lobes] + ["all"] * (len(self.lobes) > 1)
        sizes = [one.amplitude for one in self.lobes] + [None] * (len(self.lobes) > 1)
        if len(self.left) < len(names):  # all together alone
            names, sizes = names[-1:], sizes[-1:]
        rows = [
            (name, size, *(_shown(value) for value in pair))
            for name, size, pair in zip(names, sizes, self.left, strict=True)
        ]
        head = ("lobes", "amplitude [m]", "left [m]", "at the worst angle [m]")
        return Sheet(head, rows, "lrrr", self.title)

    def readable(self) -> Sheet:
        """The same for a terminal."""
        sheet = self.table()
        rows = [["" if c is None else c if isinstance(c, str) else f"{c:.4g}" for c in row]
                for row in sheet.rows]  # fmt: skip
        return Sheet(sheet.columns, rows, sheet.align, sheet.title).in_units()

    def sentence(self) -> str:
        """What the race leaves, and of what."""
        here, worst = self.left[-1]
        if here is None or worst is None:
            return (
                f"On this race no stable motion was found in which the {self.called} rest apart in "
                "the rotor; contacts are not counted."
            )
        share = "" if not self.alone else f", {worst / self.alone:.1%} of {1e3 * self.alone:.3g} mm"
        return (
            f"The {self.called} leave {1e3 * here:.3g} mm on this race, and {1e3 * worst:.3g} mm "
            f"at the worst angle of the race to the unbalance{share} without {self.called}; "
            "on a round race nothing."
        )

    def as_json(self) -> dict[str, Any]:
        """Plain lists and numbers."""
        lobes = [
            {"order": one.order, "amplitude": one.amplitude, "angle": one.angle}
            for one in self.lobes
        ]
        left = [{"here": here, "worst": worst} for here, worst in self.left]
        return {"scene": self.title, "alone": self.alone, "lobes": lobes, "left": left,
                "angles": list(self.angles)}  # fmt: skip


def _shown(value: float | None) -> float | str:
    return "not found" if value is None else value


def lobes_of(text: str) -> tuple[Lobes, ...]:
    """ORDER=AMPLITUDE@ANGLE, several with commas: `2=20 um@30 deg, 3=5 um`.

    Raises:
        UserError: it is not written like that.
    """
    found = []
    for item in text.split(","):
        order, _, rest = (part.strip() for part in item.partition("="))
        amplitude, _, angle = (part.strip() for part in rest.partition("@"))
        if not order.isdigit() or not int(order) or not amplitude:
            raise UserError(
                f"lobes {item.strip()!r}: must be ORDER=AMPLITUDE or ORDER=AMPLITUDE@ANGLE, as "
                '"2=20 um@30 deg"; the amplitude is half of the peak-to-valley of that order'
            )
        size = si_number(amplitude, "m", f"lobes {order}:")
        if not size >= 0.0:
            raise UserError(f"lobes {order} = {amplitude}: must be 0 or more")
        turn = si_number(angle, "rad", f"lobes {order}:") if angle else 0.0
        found.append(Lobes(int(order), size, turn))
    return tuple(found)


def _own_races(scene: Scene, speed: float) -> OutOfRound:
    """What the races of a scene leave, several balancers and planes together."""
    assembly = scene.assembly().at_speed(speed)
    lobes = tuple(one for m in assembly.weights for one in weights_of(m).race)
    turned: list[float | None] = []
    angles: tuple[float, ...] = ()
    for k, by in enumerate(math.tau * k / _TURNS for k in range(_TURNS)):
        try:
            machine, rest = main_motion(_with_turned_races(assembly, by), speed)
        except (ValueError, ArithmeticError) as error:
            if k == 0:
                raise UserError(f"{scene.label}: {error}") from error
            turned.append(None)
            continue
        stable = np.linalg.eigvals(machine.linearised(rest).at_speed(speed)).real.max() < 0.0
        turned.append(float(np.abs(machine.whirl(rest)).max()) if stable else None)
        angles = angles or tuple(rest.tolist())
    worst = max((size for size in turned if size is not None), default=None)
    names = [getattr(balancer, "kind", "") for balancer in scene.balancer]
    called = names[0] if len(set(names)) == 1 else "weights"
    alone = vibration_alone(scene, speed, 0.0)
    return OutOfRound(scene.heading, called, alone, lobes, ((turned[0], worst),), angles)


def _with_turned_races(assembly: Assembly, by: float) -> Assembly:
    balancers = list(assembly.balancers)
    for k, mounted in enumerate(balancers):
        if isinstance(mounted.device, Weights):
            race = tuple(replace(one, angle=one.angle + by) for one in mounted.device.race)
            balancers[k] = replace(mounted, device=replace(mounted.device, race=race))
    return replace(assembly, balancers=tuple(balancers))


def out_of_round(scene: Scene, text: str = "", speed: float | None = None) -> OutOfRound:
    """As `Scene.race`, which says what is raised."""
    w = scene.profile().end if speed is None else speed
    assembly = scene.assembly()
    if not text and not has_lobes(assembly):
        raise UserError(
            f"{scene.label}: its races are round: give lobes, as "
            '"2=20 um@30 deg", or the key race of its weights'
        )
    if not text:
        return _own_races(scene, w)
    lobes = lobes_of(text)
    try:
        race = Race(assembly, w, lobes)
    except ValueError as error:
        raise UserError(f"{scene.label}: {error}") from error
    points = replace(assembly, balancers=tuple(
        replace(one, half_angle=0.0) for one in assembly.balancers))  # fmt: skip
    round_race = _size(_least(Race(points, w, ())))
    if race.alone and (round_race is None or round_race > _BALANCED * race.alone):
        raise UserError(
            f"{scene.label}: the weights do not balance the rotor on a round race at {w:g} rad/s: "
            "see `autobalancer speeds`, or take more or heavier weights"
        )
    each = [(one,) for one in lobes] + [lobes] * (len(lobes) > 1)
    rows, rest = [], None
    for some in each:
        rest = _least(Race(assembly, w, some))
        sizes = [_size(_least(Race(assembly, w, turned))) for turned in _turned(some)]
        worst = max((s for s in sizes if s is not None), default=None)
        here = _size(rest)
        rows.append((here, None if here is None or worst is None else max(here, worst)))
    (kind,) = {balancer.kind for balancer in scene.balancer}
    angles = rest.angles if rest else ()
    return OutOfRound(scene.heading, kind, race.alone, lobes, tuple(rows), angles)


def _turned(lobes: Sequence[Lobes]) -> list[tuple[Lobes, ...]]:
    """The race turned in steps over what is different."""
    period = math.tau / math.gcd(*(one.order for one in lobes))
    steps = (period * k / _TURNS for k in range(_TURNS))
    return [tuple(replace(one, angle=one.angle + by) for one in lobes) for by in steps]


def _least(race: Race) -> Rest | None:
    """The stable motion at rest with the least vibration."""
    slack = 1e-7 * race.speed  # neutral on a round race
    return next((rest for rest in race.rests() if rest.growth < slack), None)


def _size(rest: Rest | None) -> float | None:
    return None if rest is None else abs(rest.displacement)
