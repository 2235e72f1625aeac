"""What the closed form says of a scene: table, sentence, limits of validity, picture."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from ...models.capture import Capture, LeftBehind, NaturalFrequency, capture
from ..errors import SceneError
from ..output.outcome import Outcome
from ..output.table import Sheet
from ..scene import Scene
from ..scene.balancer import Ring, WeightBalancer
from .words import limits, sentence


@dataclass(frozen=True, eq=False, repr=False)
class Captured(Outcome):
    """Motions in which weights of a scene are left behind, at one speed of the rotor.

    Attributes:
        title: of the scene.
        called: what its weights are: balls, rollers, pendulums or weights.
        names: of the balancers that have weights.
        radii: of their tracks [m].
        drag_given: whether every balancer has a drag; without one every drag ratio is a drag
            [N s/m] of all weights.
        gravity, can_stick: what of the scene limits the closed form.
        found: what the closed form says.
        scene: whose weights they are.
    """

    drawn_by: ClassVar[str] = "..capture.plot:plot_captured"

    title: str
    called: str
    names: tuple[str, ...]
    radii: tuple[float, ...]
    drag_given: bool
    gravity: bool
    can_stick: bool
    found: Capture
    scene: Scene

    @property
    def speed(self) -> float:
        """Of the rotor [rad/s]."""
        return self.found.speed

    @property
    def drag(self) -> dict[str, float]:
        """By balancer, the drag from which on no weights can be left behind [N s/m].

        Of unequal weights the largest; all drags in the present proportion.

        >>> {k: round(v, 4) for k, v in ab.load("two_balls").capture().drag.items()}
        {'weights': 0.0056}
        """
        limit: dict[str, float] = {}
        for group, drag in zip(self.found.groups, self.found.drags, strict=True):
            name = self.names[group.balancer]
            limit[name] = max(limit.get(name, 0.0), drag * self.found.drag_ratio)
        return limit

    def table(self) -> Sheet:
        """A row for every natural frequency and number of weights."""
        rows = [
            [
                one.frequency, one.damping_ratio, m.weights, self._numbers(m), m.drag_ratio,
                m.release_speed, m.frequency if m.possible else "",
                self.amplitude(m) if m.possible else "",
            ]
            for one in self.found.natural
            for m in one.motions
        ]  # fmt: skip
        columns = (
            "natural frequency [rad/s]", "damping ratio", "weights left behind", "of balancers",
            "drag limit / drag" if self.drag_given else "drag limit [N s/m]",
            "let go at [rad/s]", "they turn at [rad/s]", "amplitude [m]",
        )  # fmt: skip
        cells = [
            ["" if isinstance(c, float) and not math.isfinite(c) else c for c in row]
            for row in rows
        ]
        return Sheet(
            columns, cells, "rrrlrrrr", f"{self.title}: left behind at a natural frequency"
        )

    def readable(self) -> Sheet:
        """The same for a terminal."""
        sheet = self.table()
        rows = [[c if isinstance(c, str) else f"{c:.5g}" for c in row] for row in sheet.rows]
        return Sheet(sheet.columns, rows, sheet.align, sheet.title).in_units()

    def amplitude(self, motion: LeftBehind) -> float:
        """Largest of the stations, without the unbalance's own [m]."""
        return float(np.max(motion.amplitude))

    @property
    def unbalance_amplitude(self) -> float:
        """What the unbalance adds to it at most [m]."""
        return float(np.max(self.found.unbalance_amplitude))

    def nearest(self, frequency: float) -> tuple[NaturalFrequency, LeftBehind] | None:
        """The motion whose weights turn nearest to a frequency [rad/s]."""
        motions = self.found.motions
        return min(motions, key=lambda m: abs(m[1].frequency - frequency), default=None)

    def sentence(self) -> str:
        """One line: whether weights can be left behind, and what prevents it.

        >>> ab.load("two_balls").capture().sentence()[:46]
        'Closed form: no weights can be left behind at '
        """
        return sentence(self)

    def limits(self) -> list[str]:
        """What the closed form does not cover here, a sentence each."""
        return limits(self)

    @property
    def held_by_lobes(self) -> float:
        """Rate in the rotor below which lobes of a race can hold weights [rad/s]; 0: round races.

        A weight at the angular rate r passes a lobe of a race that turns at w where
        kappa R^2 r^2/2 exceeds what the lobe takes, 2 w^2 R eps.
        """
        sizes = [
            sum(one.amplitude for one in b.race) / (b.kappa * b.track_radius)
            for b in self.scene.balancer
            if isinstance(b, WeightBalancer)
        ]
        return 2.0 * self.found.speed * math.sqrt(max(sizes, default=0.0))

    @property
    def linear(self) -> str:
        """That supports which are not linear are left out; empty where there are none."""
        rotor = self.scene.rotor
        keys = {"cubic springs": rotor.cubic_stiffness, "stops": rotor.stops,
                "dampers with a free stroke": rotor.has_free_strokes}  # fmt: skip
        held = " and ".join(name for name, given in keys.items() if given)
        return f"This is the closed form of linear supports: {held} are left out." if held else ""

    def as_json(self) -> dict[str, Any]:
        """Everything; `None` for what is infinite or is not."""
        found = self.found
        return {
            "scene": self.scene.name,
            "linear": self.linear,
            "speed": found.speed,
            "all_pass": found.all_pass,
            "unstable": found.unstable,
            "undamped": found.undamped or None,
            "lone_lag": found.lone_lag or None,
            "drag_ratio": found.drag_ratio,
            "drag": self.drag,
            "release_speed": _number(found.release_speed),
            "unbalance_amplitude": [_number(a) for a in found.unbalance_amplitude],
            "sentence": self.sentence(),
            "limits": self.limits(),
            "natural_frequencies": [
                {
                    "frequency": one.frequency,
                    "damping_ratio": one.damping_ratio,
                    "motions": [_as_json(m) for m in one.motions],
                }
                for one in found.natural
            ],
        }

    def _numbers(self, motion: LeftBehind) -> str:
        each = np.zeros(len(self.names), int)
        for group, number in zip(self.found.groups, motion.numbers, strict=True):
            each[group.balancer] += number
        return ", ".join(f"{n} of {name}" for name, n in zip(self.names, each, strict=True) if n)


def captured(scene: Scene, speed: float | None = None) -> Captured:
    """What the closed form says of a scene; as `Scene.capture`, which says what is raised."""
    holders = [b for b in scene.balancer if isinstance(b, WeightBalancer)]
    if not holders:
        there, remedy = "no balancer", "add a [[balancer]] with weights (see `autobalancer design`)"
        if scene.balancer:
            there = "only liquid, which turns with its chamber"
            remedy = "`autobalancer speeds` states at which speeds liquid lowers the vibration"
        if any(isinstance(b, Ring) for b in scene.balancer):
            remedy = "`autobalancer speeds` states at which speeds the waves of a ring grow"
        raise SceneError(
            f"{scene.label}: {there}: only balls, rollers and pendulums can be left behind; "
            f"{remedy}"
        )
    scene.refuse_friction("the closed form of weights that are left behind is that")
    speed = scene.speed_or_own(speed)
    refuse_outside_tables(scene, speed)
    found = capture(scene.assembly(), speed)
    kinds = {one.kind for one in holders}
    given = all(group.drag > 0.0 for group in found.groups)
    return Captured(
        scene.heading,
        kinds.pop() if len(kinds) == 1 else "weights",
        tuple(one.label for one in holders),
        tuple(one.track_radius for one in holders),
        given,
        bool(scene.operation.gravity),
        any(one.can_stick for one in holders),
        found,
        scene,
    )


def refuse_outside_tables(scene: Scene, speed: float) -> None:
    """Raise SceneError where tables of bearings do not hold a speed [rad/s]."""
    rotor = scene.assembly().rotor
    if not rotor.holds(speed, speed):
        low, high = rotor.table_speeds
        raise SceneError(
            f"{scene.label}: speed = {speed:.6g} rad/s: must be within {low:.6g} to {high:.6g} "
            "rad/s, which the tables of rotor.bearings hold; ask for such a speed, or give the "
            "tables rows for this one"
        )


def captured_or_none(scene: Scene, speed: float | None = None) -> Captured | None:
    """The same, None where it does not apply."""
    try:
        return captured(scene, speed)
    except (SceneError, ValueError):
        return None


def left_behind(scene: Scene) -> str:
    """The sentence after a run whose speed rises, or in which weights can be left behind."""
    found = captured_or_none(scene)
    changes = scene.profile().changes or scene.operation.motor
    return found.sentence() if found and (changes or not found.found.all_pass) else ""


def _as_json(motion: LeftBehind) -> dict[str, Any]:
    return {
        "weights": motion.weights,
        "by_group": list(motion.numbers),
        "possible": motion.possible,
        "release_speed": _number(motion.release_speed),
        "drag_ratio": _number(motion.drag_ratio),
        "frequency": _number(motion.frequency),
        "amplitude": [_number(a) for a in motion.amplitude],
    }


def _number(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
