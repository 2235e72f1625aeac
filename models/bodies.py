"""Bodies that do not turn: a tub, a casing or a base that carries the rotor, or an absorber.

A body moves as the rotor's supports do: a planar rotor's has one displacement for each axis, any
other's two, p_1 and p_2 in the planes z_1, z_2 of the supports.  With a = (s - z_1)/l for the
centre of mass at s, l = z_2 - z_1,

    M_b = [[m (1 - a)^2 + It/l^2, m a (1 - a) - It/l^2], [m a (1 - a) - It/l^2, m a^2 + It/l^2]]

as that of the rigid rotor on two supports without polar inertia.  Internal damping of the shaft
acts on its bending, which is the motion of the rotor relative to what carries it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from .arrays import Numbers, numbers, zeros
from .rotor import LinearRotor
from .supports import Support, diagonal_pair, two_ways

GROUND, ROTOR = "ground", "rotor"
AXES = "xy"
APART = 2.5  # damping of coordinates that are held, over rate times mass; 2 is critical


class Foot(NamedTuple):
    """A spring and a damper under a body.

    Attributes:
        position: along the axis [m].
        stiffness, damping: (x, y) [N/m, N s/m].
    """

    position: float
    stiffness: Sequence[float]
    damping: Sequence[float] = (0.0, 0.0)


class Body(NamedTuple):
    """A body that does not turn.

    Attributes:
        name: of the body.
        mass: [kg].
        inertia: about a transverse axis through its centre of mass [kg m^2].
        centre: of mass, along the axis [m].
        feet: between it and what it stands on; none: it is free.
        on: "ground", "rotor" (an absorber) or another body's name.
        free: "xy", or "x" or "y" alone: its feet are rigid along the other axis.
    """

    name: str
    mass: float
    inertia: float = 0.0
    centre: float = 0.0
    feet: tuple[Foot, ...] = ()
    on: str = GROUND
    free: str = AXES


class Places:
    """Where rotor and bodies stand among the coordinates, and how their places move.

    Args:
        supports: places of the rotor's supports, one or two [m].
        rows: (p, n) of the rotor at `along` (p,) [m].
    """

    def __init__(
        self,
        supports: Sequence[float],
        rows: Numbers,
        along: Sequence[float],
        bodies: Sequence[Body],
    ) -> None:
        self.supports, self.rows, self.along = tuple(supports), rows, tuple(along)
        self.own = len(self.supports)
        self.free = {body.name: body.free for body in bodies}
        self.first = {body.name: rows.shape[1] + k * self.own for k, body in enumerate(bodies)}
        self.size = rows.shape[1] + self.own * len(bodies)

    def shares(self, position: float) -> list[float]:
        """Parts that a body's coordinates have in the displacement of its place."""
        if self.own == 1:
            return [1.0]
        begin, end = self.supports
        part = (position - begin) / (end - begin)
        return [1.0 - part, part]

    def rows_of(self, of: str, position: float) -> tuple[Numbers, Numbers]:
        """As `row`, along x and along y: zeros along an axis in which a body cannot move."""
        row = self.row(of, position)
        free = self.free.get(of, AXES)
        along_x, along_y = (row if axis in free else numbers([0.0] * self.size) for axis in AXES)
        return along_x, along_y

    def row(self, of: str, position: float) -> Numbers:
        """(size,) displacement of a place of the ground, the rotor or a body.

        Raises:
            ValueError: the rotor has no such place.
        """
        found: list[float] = [0.0] * self.size
        if of == ROTOR:
            at = min(range(len(self.along)), key=lambda k: abs(float(self.along[k] - position)))
            if self.own > 1 and self.along[at] != position:
                raise ValueError(
                    f"feet: position = {position:g} m: of a body on the rotor must be one of its "
                    f"places, {[float(z) for z in self.along]} m"
                )
            found[: self.rows.shape[1]] = self.rows[at].tolist()
        elif of != GROUND:
            at = self.first[of]
            found[at : at + self.own] = self.shares(position)
        return numbers(found)


def with_bodies(
    rotor: LinearRotor,
    supports: Sequence[float],
    along: Sequence[float],
    bodies: Sequence[Body],
    carrier: str = GROUND,
) -> LinearRotor:
    """A rotor with bodies; their coordinates stand behind its own.

    Args:
        supports: places of its supports, one for each of `rotor.supports` [m].
        along: places of its planes [m].
        carrier: what the supports stand on.

    Raises:
        ValueError: a body stands on what there is not, or where the rotor has no place.
    """
    places = Places(supports, rotor.planes, along, bodies)
    _refuse_unknown(bodies, carrier, places.first)
    n, size = rotor.stations, places.size
    wide = rotor.widened(size - n)
    mass = wide.mass
    for body in bodies:
        at = slice(places.first[body.name], places.first[body.name] + places.own)
        mass[at, at] = _inertia(body, places)
    held = []
    for k, (support, place) in enumerate(zip(wide.supports, supports, strict=True), start=1):
        x, y = (support.rows[0] - row for row in places.rows_of(carrier, place))
        held.append(replace(two_ways(support, x, y), name=f"support[{k}]"))
    for body in bodies:
        for number, foot in enumerate(body.feet, start=1):
            own, under = (places.rows_of(of, foot.position) for of in (body.name, body.on))
            springs, dampers = diagonal_pair(foot.stiffness), diagonal_pair(foot.damping)
            one = Support.bearing(own[0], springs, dampers, name=f"{body.name}.foot[{number}]")
            held.append(two_ways(one, *(a - b for a, b in zip(own, under, strict=True))))
        held += _locked(body, places, mass)
    if n == 1:  # the disc's bending is its way from what carries it; other shafts bend alone
        if places.free.get(carrier, AXES) != AXES and bool(np.any(rotor.internal_damping != 0)):
            raise ValueError(
                f"internal_damping: not on the body {carrier!r}, which is free along "
                f"{places.free[carrier]} alone"
            )
        bent = np.eye(n, size) - places.row(carrier, supports[0])
        wide = replace(
            wide,
            internal_damping=bent.T @ rotor.internal_damping @ bent,
            deflection=rotor.deflection @ bent,
        )
    return replace(
        wide,
        supports=tuple(held),
        locked=tuple(
            (axis, places.first[body.name] + k)
            for body in bodies
            for axis, name in enumerate(AXES)
            if name not in body.free
            for k in range(places.own)
        ),
    )


def _locked(body: Body, places: Places, mass: Numbers) -> list[Support]:
    """What holds coordinates of a body along an axis in which it cannot move.

    They are there, as both axes have the same ones, and nothing pushes them.  They are held as by
    the feet of the free axis, with more than critical damping, and stay at zero: their rates are
    -rate/2 and -2 rate.  Equal ones would have no modes of their own, which proofs need.
    """
    if body.free == AXES:
        return []
    locked = 1 - AXES.index(body.free)
    first, own = places.first[body.name], places.own
    rows = np.eye(own, places.size, first)
    shares = [numbers([places.shares(foot.position)]) for foot in body.feet]
    pairs = zip(shares, body.feet, strict=True)
    springs = sum(
        (foot.stiffness[1 - locked] * one.T @ one for one, foot in pairs), np.eye(own) * 0
    )
    inertia = mass[first : first + own, first : first + own]
    # any rate would do, as nothing pushes them: it need not be exact
    roots = np.linalg.eigvals(np.linalg.solve(inertia.astype(float), springs.astype(float)))
    rate = float(np.abs(roots).max()) ** 0.5
    stiffness, damping = (zeros((2, 2, own, own), inertia) for _ in range(2))
    stiffness[locked, locked] = rate**2 * inertia
    damping[locked, locked] = APART * rate * inertia
    return [Support(rows, stiffness, damping, across=0)]


def _inertia(body: Body, places: Places) -> Numbers:
    """Mass matrix of a body's own coordinates."""
    at = numbers([places.shares(body.centre)])
    found = body.mass * at.T @ at
    if places.own == 2:
        begin, end = places.supports
        tilt = np.array([[-1.0, 1.0]]) / (end - begin)
        found = found + body.inertia * tilt.T @ tilt
    return found


def _refuse_unknown(bodies: Sequence[Body], carrier: str, names: Mapping[str, int]) -> None:
    known = [GROUND, *names]
    if carrier not in known:
        raise ValueError(f"on = {carrier!r}: must be one of {', '.join(map(repr, known))}")
    for body in bodies:
        others = [name for name in (GROUND, ROTOR, *names) if name != body.name]
        if body.on not in others:
            raise ValueError(
                f"body {body.name!r}: on = {body.on!r}: must be one of "
                f"{', '.join(map(repr, others))}"
            )
