"""What remains where the weights cannot balance: a steady whirl, its size, and where it is stable.

floquet: harmonic balance and multipliers of the equations (`models.whirl`).
cosim: Newton's method on the one-revolution map of the coupled units, begun there, and its
multipliers.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

from ...models.linear.boundaries import Crossing
from ...models.whirl.search import MainWhirl, NotCovered, decays, main_whirl, whirl_boundaries
from ...models.whirl.steady import NoWhirl
from ...models.whirl.variation import neutral_turns
from ..errors import SimulationError
from ..master.revolution import Revolution, Vector
from ..output.workers import Progress
from ..scene import Scene
from .main_motion import MainMotion

_SHOWN = 5  # speeds between the boundaries, and the ends of the range
_SAME = 1e-3  # rad: how far the units' whirl may lie from that of the equations


@dataclass(frozen=True)
class WhirlAt:
    """The whirl at one speed.

    Attributes:
        speed: [rad/s].
        growth: largest growth rate of a small deviation [1/s]; NaN where none was found.
        amplitude: largest distance of each station from its middle [m]; empty without a whirl.
        angles: mean angles of the weights in the rotor [rad]; those that touch are one.
        drift: of three and more weights among positions of the same moment [rad/s].
    """

    speed: float
    growth: float = math.nan
    amplitude: tuple[float, ...] = ()
    angles: tuple[float, ...] = ()
    drift: float = 0.0

    @property
    def stable(self) -> bool:
        """Whether it exists and small deviations decay."""
        return decays(self.growth, self.speed)

    def as_json(self) -> dict[str, Any]:
        """Plain lists and numbers; null where there is no whirl."""
        if not self.amplitude:
            return {"speed": self.speed, "stable": False, "growth": None, "amplitude": None}
        return {
            "speed": self.speed,
            "stable": self.stable,
            "growth": self.growth,
            "amplitude": list(self.amplitude),
            "angles": list(self.angles),
            "drift": self.drift,
        }


@dataclass(frozen=True)
class Whirls:
    """What remains of the vibration over a range of speeds.

    Attributes:
        why: the weights cannot balance.
        at: the whirl at the ends of the range and between its boundaries.
        methods: speeds at which a stable whirl begins or ends, by method.
        refused: why each other method does not apply.
    """

    why: str
    at: tuple[WhirlAt, ...]
    methods: dict[str, tuple[Crossing, ...]]
    refused: dict[str, str] = field(default_factory=dict)

    def as_json(self) -> dict[str, Any]:
        """Plain lists and numbers."""
        return {
            "why": self.why,
            "at": [one.as_json() for one in self.at],
            "methods": {
                name: [{"speed": c.speed, "above": c.above} for c in crossings]
                for name, crossings in self.methods.items()
            },
            "not_applicable": dict(self.refused),
        }

    def lines(self) -> list[str]:
        """The same in words."""
        if not self.at:
            return [f"The weights cannot balance: {self.why}. {self.refused['floquet']}."]
        stable = [one for one in self.at if one.stable]
        if not stable:
            return [f"The weights cannot balance: {self.why}. No stable whirl was found either."]
        least, most = (pick(stable, key=lambda one: max(one.amplitude)) for pick in (min, max))
        sizes = f"{1e3 * max(least.amplitude):.4g} mm"
        if least is not most:
            sizes += f" (at {least.speed:.4g} rad/s) to {1e3 * max(most.amplitude):.4g} mm"
        return [
            f"The weights cannot balance: {self.why}.",
            f"A whirl of {sizes} (at {most.speed:.4g} rad/s) remains where it is stable, "
            f"{_bands(self.at[0], self.at[-1], self.methods['floquet'])}.",
            *self._drift(),
        ]

    def _drift(self) -> list[str]:
        fastest = max(one.drift for one in self.at)
        if not fastest:
            return []
        return [
            "Its weights could stand in many ways, among which they drift by up to "
            f"{fastest:.2g} rad/s; the vibration stays."
        ]


def _bands(first: WhirlAt, last: WhirlAt, crossings: Sequence[Crossing]) -> str:
    """Where the whirl is stable, in words."""
    edges = [c.speed for c in crossings]
    if first.stable:
        edges.insert(0, first.speed)
    if len(edges) % 2:
        edges.append(last.speed)
    bands = [f"{a:.6g} to {b:.6g}" for a, b in zip(edges[::2], edges[1::2], strict=True)]
    return f"{', '.join(bands)} rad/s" if bands else "nowhere in the range"


def whirl_at(scene: Scene, speed: float) -> WhirlAt:
    """The whirl of a scene at a speed [rad/s], by the equations."""
    try:
        whirl, growth = main_whirl(scene.assembly(), speed)
    except (NoWhirl, NotCovered):
        return WhirlAt(speed)
    angles = np.angle(np.exp(1j * whirl.angles))
    return WhirlAt(
        speed, growth, tuple(whirl.amplitude.tolist()), tuple(angles.tolist()), whirl.drift
    )


def whirls(
    scene: Scene,
    span: tuple[float, float],
    why: str,
    narrowest: float | None = None,
    progress: Progress | None = None,
) -> Whirls:
    """The whirl of a scene over a range of speeds [rad/s], by the equations.

    Args:
        why: the weights cannot balance.
        narrowest: spacing of the scan [rad/s]; a hundredth of the range by default.
        progress: called with the finished fraction.
    """
    report = progress or (lambda done: None)
    try:
        crossings = whirl_boundaries(scene.assembly(), *span, narrowest=narrowest, progress=report)
    except (ValueError, ArithmeticError) as error:
        return Whirls(why, (), {}, {"floquet": str(error)})
    edges = [span[0], *(c.speed for c in crossings), span[1]]
    middles = [0.5 * (a + b) for a, b in pairwise(edges)]
    even = np.linspace(*span, _SHOWN + 2).tolist()
    shown = sorted({*even, *middles})
    return Whirls(why, tuple(map(partial(whirl_at, scene), shown)), {"floquet": tuple(crossings)})


def has_map(scene: Scene, speed: float) -> bool:
    """Whether the units' one-revolution map tells of the whirl: no weights touch or drift in it."""
    one = whirl_at(scene, speed)
    count = sum(len(m.angles) for m in scene.assembly().weights)
    return len(one.angles) in (0, count) and one.drift == 0.0


class WhirlMotion(MainMotion):
    """Multipliers and growth about the whirl, measured on the coupled units.

    Raises:
        NoWhirl: there is none at a speed.
        SimulationError: the units have none, or another than the equations.
    """

    def __init__(self, scene: Scene, *, separate: bool = False) -> None:
        self.units = Revolution(scene, separate=separate)
        self._angles = self._places_of_angles()

    def at(self, speed: float) -> None:
        """Go to the whirl at a speed [rad/s]: Newton's method from that of the equations."""
        scene = self.units.scene
        main = main_whirl(scene.assembly(), speed)
        guess = self._state(main)
        self.state = self._resolved(lambda: self.units.steady(speed, guess)[0])
        off = float(np.abs(self.state - guess)[self._angles].max())
        if off > _SAME:
            raise SimulationError(
                f"{scene.name}: at {speed:g} rad/s the units' whirl lies {off:.2g} rad from that "
                "of the equations: use more steps per revolution"
            )
        self._keep(neutral_turns(main.whirl))

    def _state(self, main: MainWhirl) -> Vector:
        """States of the units, rotor at angle 0, in the whirl of the equations."""
        place, velocity = main.whirl.rotor_at(0.0)
        theta, rate, _ = main.whirl.weights_at(np.zeros(1))
        weights = np.stack([theta[0], rate[0]], axis=1).ravel()
        return np.concatenate([place.real, place.imag, velocity.real, velocity.imag, weights])

    def _keep(self, neutral: np.ndarray) -> None:
        """Coordinates that neutral turns of the weights (K, m) do not change."""
        count = len(self.units.states)
        self.neutral = np.zeros((count, neutral.shape[1]))
        self.neutral[self._angles] = neutral
        left = np.linalg.svd(self.neutral)[0] if neutral.shape[1] else np.eye(count)
        self._columns = left[:, neutral.shape[1] :]
        self._rows = self._columns.T

    def multipliers(self, speed: float) -> np.ndarray:
        """Multipliers of one revolution but the neutral ones, largest modulus first."""
        self.at(speed)
        return super().multipliers(speed)

    def growth(self, speed: float) -> float:
        """As of a main motion; where there is no whirl, an e-fold a radian."""
        try:
            return super().growth(speed)
        except NoWhirl:
            return speed
