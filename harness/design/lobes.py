"""What a race that is not round leaves of the vibration: table and sentence."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from ...models.assembly import Assembly, weights_of
from ...models.linear.on_race import has_lobes
from ...models.lobes import Lobes, Race, Rest, rests_over_turns
from ..errors import UserError
from ..output.outcome import Outcome
from ..output.table import Sheet
from ..result.verdict import vibration_alone
from ..scene import Scene
from ..units import WIDEST, si_number

_BALANCED = 1e-6  # of the vibration without weights
_OTHERS = 1.01  # of the worst of the best rests: from there on other ones are told


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
        most: largest vibration of all stable motions at rest, at any angle of all lobes together
            [m]; None where there is none.
    """

    title: str
    called: str
    alone: float
    lobes: tuple[Lobes, ...]
    left: tuple[tuple[float | None, float | None], ...]
    angles: tuple[float, ...]
    most: float | None = None

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
        alone = self.alone
        share = "" if not alone else f", {100.0 * worst / alone:.1f} % of {1e3 * alone:.3g} mm"
        found = (
            f"The {self.called} leave {1e3 * here:.3g} mm on this race, and {1e3 * worst:.3g} mm "
            f"at the worst angle of the race to the unbalance{share} without {self.called}; "
            "on a round race nothing."
        )
        if self.most is None or self.most < _OTHERS * worst:
            return found
        part = "" if not alone else f" ({100.0 * self.most / alone:.1f} %)"
        return (
            f"{found} These are the stable rests that leave least. Others leave up to "
            f"{1e3 * self.most:.3g} mm{part}: the start decides where {self.called} come to rest."
        )

    def as_json(self) -> dict[str, Any]:
        """Plain lists and numbers."""
        lobes = [
            {"order": one.order, "amplitude": one.amplitude, "angle": one.angle}
            for one in self.lobes
        ]
        left = [{"here": here, "worst": worst} for here, worst in self.left]
        return {"scene": self.title, "alone": self.alone, "lobes": lobes, "left": left,
                "angles": list(self.angles), "most": self.most}  # fmt: skip


def _shown(value: float | None) -> float | str:
    return "not found" if value is None else value


def lobes_of(text: str) -> tuple[Lobes, ...]:
    """ORDER=AMPLITUDE@ANGLE, several with commas: `2=20 um@30 deg, 3=5 um`.

    Raises:
        UserError: it is not written like that.
    """
    found = []
    if not isinstance(text, str):
        raise UserError(f"lobes = {text!r}: must be text, such as '2=20 um@30 deg, 3=5 um'")
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
        if abs(turn) > WIDEST and _is_number(angle):
            raise UserError(
                f"lobes {order} at {angle} rad: more than two turns; is it in degrees? then write "
                f'"{order}={amplitude}@{angle} deg"'
            )
        found.append(Lobes(int(order), size, turn))
    return tuple(found)


def _is_number(text: str) -> bool:
    return text[-1].isdigit() or text[-1] == "."


def _refuse_impossible(scene: Scene, lobes: tuple[Lobes, ...]) -> None:
    """Raise SceneError for lobes that the scene's balancer does not take as its own race."""
    race = [{"lobes": one.order, "amplitude": one.amplitude, "angle": one.angle} for one in lobes]
    scene.replace({f"{scene.balancer[0].label}.race": race})


@dataclass(frozen=True)
class _Left:
    """Vibration that races leave [m]: as they are, at their worst angle, and at most."""

    here: float | None
    worst: float | None
    most: float | None
    angles: tuple[float, ...]

    @classmethod
    def of(cls, assembly: Assembly, speed: float) -> _Left:
        """By all stable rests over the angle of the races."""
        over_turns = rests_over_turns(assembly, speed)
        here = over_turns[0][0] if over_turns[0] else None
        worst = max((rests[0].size for rests in over_turns if rests), default=None)
        most = max((rests[-1].size for rests in over_turns if rests), default=None)
        return cls(here.size if here else None, worst, most, here.angles if here else ())


def _own_races(scene: Scene, speed: float) -> OutOfRound:
    """What the races of a scene leave, several balancers and planes together."""
    assembly = scene.assembly().at_speed(speed)
    lobes = tuple(one for m in assembly.weights for one in weights_of(m).race)
    try:
        left = _Left.of(assembly, speed)
    except (ValueError, ArithmeticError) as error:
        raise UserError(f"{scene.label}: {error}") from error
    names = [getattr(balancer, "kind", "") for balancer in scene.balancer]
    called = names[0] if len(set(names)) == 1 else "weights"
    alone = vibration_alone(scene, speed, 0.0)
    pair = (left.here, left.worst)
    return OutOfRound(scene.heading, called, alone, lobes, (pair,), left.angles, left.most)


def out_of_round(scene: Scene, text: str | None = None, speed: float | None = None) -> OutOfRound:
    """As `Scene.race`, which says what is raised."""
    w = scene.speed_or_own(speed)
    assembly = scene.assembly()
    if text is None and not has_lobes(assembly):
        raise UserError(
            f"{scene.label}: its races are round: give lobes, as "
            '"2=20 um@30 deg", or the key race of its weights'
        )
    if text is None:
        return _own_races(scene, w)
    lobes = lobes_of(text)
    try:
        race = Race(assembly, w, lobes)
    except ValueError as error:
        if not assembly.weights:
            raise UserError(f"{scene.label}: {error}") from error
        remedy = "; run the scene with them instead, as the key race of each balancer"
        if assembly.rotor.isotropic:
            remedy = "; give them as the key race of each balancer, and leave --lobes out"
        raise UserError(f"{scene.label}: {error}{remedy}") from error
    _refuse_impossible(scene, lobes)
    points = replace(assembly, balancers=tuple(
        replace(one, half_angle=0.0) for one in assembly.balancers))  # fmt: skip
    round_race = _size(_least(Race(points, w, ())))
    if race.alone and (round_race is None or round_race > _BALANCED * race.alone):
        raise UserError(
            f"{scene.label}: the weights do not balance the rotor on a round race at {w:g} rad/s: "
            "see `autobalancer speeds`, or take more or heavier weights"
        )
    each = [(one,) for one in lobes] + [lobes] * (len(lobes) > 1)
    rows = [_Left.of(Race(assembly, w, some).assembly, w) for some in each]
    (kind,) = {balancer.kind for balancer in scene.balancer}
    left = tuple((one.here, one.worst if one.angles else None) for one in rows)
    return OutOfRound(scene.heading, kind, race.alone, lobes, left, rows[-1].angles, rows[-1].most)


def _held(race: Race) -> list[Rest]:
    """Stable motions at rest, that with the least vibration first."""
    slack = 1e-7 * race.speed  # neutral on a round race
    return [rest for rest in race.rests() if rest.growth < slack]


def _least(race: Race) -> Rest | None:
    return next(iter(_held(race)), None)


def _size(rest: Rest | None) -> float | None:
    return None if rest is None else abs(rest.displacement)
