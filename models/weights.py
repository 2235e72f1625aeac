"""Balls, rollers and pendulums of an auto-balancer: what they are, and where they stand."""

from __future__ import annotations

from cmath import rect
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

KAPPA = {"balls": 7.0 / 5.0, "rollers": 3.0 / 2.0, "pendulums": 1.0}


@dataclass(frozen=True)
class Lobes:
    """A harmonic of a race.

    Attributes:
        order: n, number of lobes.
        amplitude: eps, half of the peak-to-valley of that order [m].
        angle: of a lobe in the rotor [rad].
    """

    order: int
    amplitude: float
    angle: float = 0.0

    @property
    def bend(self) -> float:
        """What it takes from the curvature of a circle, times the radius squared: of all lobes
        together less than the radius, or the race bends inwards [m]."""
        return max(self.order**2 - 1, 1) * self.amplitude


@dataclass(frozen=True)
class Weights:
    """N weights on one track, alike or each with its own mass, drag and radius.

    Attributes:
        count: number N of weights.
        mass: of each [kg]; of unequal ones the mean, and so for drag and radius.
        track_radius: of the weights' centres R [m].
        drag: viscous force per speed along the track, of each, b [N s/m].
        kappa: 7/5 ball, 3/2 roller, 1 pendulum (`KAPPA`).
        radius: of a body that rolls, r [m].
        masses, drags, radii: (N,) of each, where they differ.
        race: lobes of a track that is not round; of a circle none.
    """

    count: int
    mass: float
    track_radius: float
    drag: float = 0.0
    kappa: float = 1.0
    radius: float = 0.0
    masses: tuple[float, ...] = ()
    drags: tuple[float, ...] = ()
    radii: tuple[float, ...] = ()
    race: tuple[Lobes, ...] = ()

    @property
    def unequal(self) -> bool:
        """Whether the weights differ."""
        return bool(self.masses or self.drags or self.radii)

    @cached_property
    def each(self) -> tuple[Weights, ...]:
        """The weights one by one."""
        columns = (
            values or (value,) * self.count
            for values, value in (
                (self.masses, self.mass), (self.drags, self.drag), (self.radii, self.radius)
            )
        )  # fmt: skip
        return tuple(
            Weights(1, mass, self.track_radius, drag, self.kappa, radius, race=self.race)
            for mass, drag, radius in zip(*columns, strict=True)
        )

    def refuse_unequal(self, what: str) -> None:
        """Raise ValueError where the weights differ, for what is of equal ones.

        Args:
            what: is refused, such as "Goncharov's slow root".
        """
        if self.unequal:
            raise ValueError(
                f"{what}: only for equal weights, and those of this balancer differ; give single "
                "values of mass, drag and weight_radius"
            )

    def refuse_lobes(self, what: str) -> None:
        """Raise ValueError where the race is not round, for what is of circles.

        Args:
            what: is refused, such as "Goncharov's slow root".
        """
        if self.race:
            raise ValueError(f"{what}: only for round tracks, and that of this balancer has lobes")

    @property
    def added_mass(self) -> float:
        """N m [kg], carried by the rotor as if fixed to the track's centre."""
        return self.count * self.mass

    @property
    def moment(self) -> float:
        """Static moment of one weight about the track's centre, m R [kg m]."""
        return self.mass * self.track_radius

    @property
    def point_capacity(self) -> float:
        """Largest unbalance that point weights balance, N m R [kg m]."""
        return self.count * self.moment

    @cached_property
    def lever(self) -> float:
        """-1/(kappa R): what the acceleration across a weight turns into along its angle [1/m]."""
        return -1.0 / (self.kappa * self.track_radius)

    @cached_property
    def spin_share(self) -> float:
        """s: part of the track's angular acceleration by which a free weight falls behind."""
        return (1.0 - (self.kappa - 1.0) * self.radius / self.track_radius) / self.kappa

    @cached_property
    def damping_rate(self) -> float:
        """d = b/(kappa m) [1/s]."""
        return self.drag / (self.kappa * self.mass)


def static_moment(weights: Weights, angles: Sequence[float]) -> complex:
    """Sum of m R e^{i theta} in the rotor frame [kg m]."""
    return weights.moment * sum(rect(1.0, angle) for angle in angles)


def alignment(angles: Sequence[float]) -> float:
    """Goncharov 2017 (2): p = |sum e^{2 i theta}|/n, 0 for evenly spread weights, 1 for a pair."""
    return abs(sum(rect(1.0, 2.0 * angle) for angle in angles)) / len(angles)
