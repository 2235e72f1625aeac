"""Matrices of the rotor in ball arithmetic, without rounding.

Arrays hold python-flint's `arb`, or `Sloped` where the machines of a set differ.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, cast

from flint import arb

from ..arrays import Numbers
from ..constants import SAME_PLACE
from ..linear.small_motions import RotorParts
from .arrays import Unproved, balls
from .lines import on_line
from .rotor_tables import rotor_of_table
from .slopes import Exact, Number, ball


@dataclass(frozen=True, eq=False, kw_only=True)
class RotorBalls(RotorParts):
    """The matrices of a rotor, and where its unbalance is.

    Attributes:
        mass, planes: as in `LinearRotor`.
        places: (p,) of the planes [m].
        unbalances: (place [m], moment [kg m] along and across).
        rigid: the displacement at a place follows from those at two others.
    """

    mass: Numbers
    planes: Numbers
    places: tuple[Number, ...]
    unbalances: tuple[tuple[Number, Exact], ...]
    rigid: bool

    def at_planes(self, used: Sequence[int], loads: Sequence[tuple[Number, Exact]]) -> list[Exact]:
        """Moments at `used` planes that do what `loads` at their places do.

        Raises:
            Unproved: no moments there do.
        """
        total = [balls([0, 0]) for _ in used]
        span = max((ball(place).abs_upper() for place in self.places), default=arb(0))
        slack = arb(0) if self.rigid else span * SAME_PLACE
        for place, moment in loads:
            same = [
                k for k, p in enumerate(used)
                if self.places[p] is place or _at_most(ball(self.places[p] - place), slack)
            ]  # fmt: skip
            if same:
                total[same[0]] = total[same[0]] + moment
            elif self.rigid and len(used) == 2:
                first, second = (self.places[p] for p in used)
                share = (place - first) / (second - first)
                total[0] = total[0] + moment * (1 - share)
                total[1] = total[1] + moment * share
            elif not all(ball(part).is_zero() for part in moment):
                raise Unproved(
                    f"an unbalance at {float(ball(place)):g} m is not proved to be one in the "
                    "planes that carry weights: put it in such a plane, or weights in two planes"
                )
        return total


def _at_most(difference: arb, slack: arb) -> bool:
    return bool(abs(difference) <= slack + arb(2) ** -100)


@dataclass(frozen=True)
class RingBalls:
    """What `LinearRotor.with_ring` takes of a ring of liquid, every number a ball."""

    liquid_mass: Number
    hollow: Number
    wave_damping: Number
    viscosity: int = 0
    root_damping: int = 0

    @property
    def wave_inertia(self) -> Number:
        """As of `Ring`."""
        return self.liquid_mass * self.hollow


def rotor_balls(
    table: Mapping[str, Any],
    added: Sequence[tuple[int, Number]],
    rings: Sequence[tuple[int, RingBalls]] = (),
    speed: float = 0.0,
) -> RotorBalls:
    """The rotor of a scene's table, every number a ball, with `added` masses [kg] and rings of
    liquid at its planes.

    A bearing over the speed has a `SpeedTable` under the key `table`; the rotor has the lines of
    these tables at `speed` [rad/s].

    Raises:
        Unproved: it is not proved that there is such a rotor.
    """
    kind = table["kind"]
    if kind == "planar":
        places = [arb(0)]
        loads = [(places[0], table["unbalance"], table["unbalance_angle"])]
    else:
        places = table["stations"] if kind == "flexible" else table["planes"]
        loads = [(u["position"], u["amount"], u["angle"]) for u in table["unbalances"]]
    if table.get("skews"):
        raise Unproved("rotor.skews: no weights in planes undo the couple of a disc that is askew")
    rotor = rotor_of_table(table, places)
    masses = balls([0] * rotor.plane_count)
    for plane, mass in added:
        masses[plane] += mass
    rotor = rotor.with_added_mass(masses)
    for plane, ring in rings:
        rotor = rotor.with_ring(cast(Any, ring), plane)
    by_speed = None
    if rotor.varies:
        rotor, growing = on_line(rotor, speed)
        by_speed = RotorParts(**_in_balls(RotorParts.of(growing)))
    return RotorBalls(
        **_in_balls(RotorParts.of(rotor)), by_speed=by_speed,
        mass=rotor.mass, planes=rotor.planes, places=tuple(places),
        unbalances=tuple((place, balls([size * angle.cos(), size * angle.sin()]))
                         for place, size, angle in loads),
        rigid=kind == "two_support",
    )  # fmt: skip


def _in_balls(parts: RotorParts) -> dict[str, Any]:
    """The fields of a rotor's parts, every number a ball."""
    names = (
        "stiffness", "half_stiffness", "damping", "half_damping", "internal", "gyroscopic",
        "centrifugal",
    )  # fmt: skip
    turning = parts.turning and tuple(map(balls, parts.turning))
    return {name: balls(getattr(parts, name)) for name in names} | {"turning": turning}
