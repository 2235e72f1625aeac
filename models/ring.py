"""A ring part filled with liquid: what it balances, where it dries, and its waves.

The liquid fills the ring from the wall (radius a) to a free surface (radius b < a) and turns with
the rotor.  With f = (b/a)^2 and m_L = rho pi (a^2 - b^2) h it reacts on a centre that moves with
acceleration A (less gravity) by two complex states y, y' in fixed axes.  They were derived for this
project, for an inviscid liquid and small waves in a plane; with a planar rotor they give a quartic
with complex coefficients, as in Li, Wang and Yuan 2018:

    F = -m_L (A + f y''),    (1 + f) y'' + d (y' - i w y) - 4 i w y' - 2 w^2 y = -A.

f y is the offset of the liquid's centre of mass from the ring's centre; d is the damping of waves.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

BELIEVED, WARNED, DRY = 0.1, 0.3, 1.0  # of the thinness ratio: limits of belief


@dataclass(frozen=True)
class Ring:
    """Geometry [m], density [kg/m^3] and damping of a ring part filled with liquid.

    Attributes:
        wall_radius: a.
        inner_radius: b, of the free surface at rest in the turning ring.
        height: h, along the axis.
        density: rho.
        wave_damping: d [1/s], at every speed.
        viscosity: kinematic [m^2/s]; what it adds to d grows as the root of the speed.

    Raises:
        ValueError: the surface is not inside the wall.
    """

    wall_radius: float
    inner_radius: float
    height: float
    density: float
    wave_damping: float = 0.0
    viscosity: float = 0.0

    def __post_init__(self) -> None:
        if not 0.0 < self.inner_radius < self.wall_radius:
            raise ValueError(
                f"inner_radius = {self.inner_radius!r} m: must be above 0 and smaller than "
                f"wall_radius = {self.wall_radius!r} m"
            )

    @property
    def hollow(self) -> float:
        """f = (b/a)^2, the share of the ring without liquid."""
        return (self.inner_radius / self.wall_radius) ** 2

    @property
    def gap(self) -> float:
        """Thickness of the layer at rest, a - b [m]."""
        return self.wall_radius - self.inner_radius

    @property
    def liquid_mass(self) -> float:
        """m_L = rho pi (a^2 - b^2) h [kg]."""
        # the factored difference of squares keeps its digits in a thin layer
        area = math.pi * self.gap * (self.wall_radius + self.inner_radius)
        return self.density * area * self.height

    @property
    def added_mass(self) -> float:
        """m_L/(1 + f) [kg]: what the ring's centre carries at once."""
        return self.liquid_mass / (1.0 + self.hollow)

    @property
    def wave_inertia(self) -> float:
        """m_L f [kg], by which the equation of y becomes one of a mass matrix."""
        return self.liquid_mass * self.hollow

    @property
    def wave_speeds(self) -> tuple[float, float]:
        """nu/w of the slow and the fast free wave of a ring that is held, d = 0."""
        apart = math.sqrt(2.0 * (1.0 - self.hollow))
        return (2.0 - apart) / (1.0 + self.hollow), (2.0 + apart) / (1.0 + self.hollow)

    @property
    def root_damping(self) -> float:
        """What the viscosity adds to d, over the root of the speed [1/s^0.5].

        The boundary layer at the wall alone: laminar, a long ring, sqrt(2) f nu_s^2/(a s)
        sqrt(kv/s) with nu_s the slow free wave and s = |nu_s - w|.
        """
        slow = self.wave_speeds[0]
        apart = abs(slow - 1.0)
        wall = math.sqrt(2.0) * self.hollow * slow**2 / (self.wall_radius * apart)
        return wall * math.sqrt(self.viscosity / apart)

    def damping(self, speed: float) -> float:
        """d at a speed [rad/s] of the rotor [1/s]."""
        return self.wave_damping + self.root_damping * math.sqrt(abs(speed))

    @property
    def is_damped(self) -> bool:
        """Whether waves are damped at all."""
        return self.wave_damping > 0.0 or self.viscosity > 0.0

    def thinness(self, wave: complex) -> float:
        """(1 - f) |y|/(a - b): 1 where the layer thins to nothing at the wall."""
        return (1.0 - self.hollow) * abs(wave) / self.gap

    def response(self, whirl: float, speed: float) -> complex:
        """y by the displacement of the ring's centre, where that turns at `whirl` [rad/s]."""
        d = self.damping(speed)
        own = -(1.0 + self.hollow) * whirl**2 + 1j * d * (whirl - speed)
        own += 4.0 * speed * whirl - 2.0 * speed**2
        return whirl**2 / own

    def force(self, whirl: float, speed: float) -> complex:
        """Force of the liquid by that displacement [N/m]."""
        return self.liquid_mass * whirl**2 * (1.0 + self.hollow * self.response(whirl, speed))

    # -- the steady state, in which the liquid turns with the rotor ------------------------------

    @property
    def onset_moment(self) -> float:
        """Unbalance that the liquid undoes where drying begins, rho pi h b^2 (a - b) [kg m]."""
        return self.density * math.pi * self.height * self.inner_radius**2 * self.gap

    @property
    def capacity(self) -> float:
        """Most unbalance that it undoes, far off the axis: 2/3 rho h (a sin A)^3 [kg m].

        The liquid is then a segment, A - sin A cos A = pi (1 - f).
        """
        area = math.pi * (1.0 - self.hollow)
        half = _root(lambda x: area - (x - math.sin(x) * math.cos(x)), 0.0, math.pi)
        return 2.0 / 3.0 * self.density * self.height * (self.wall_radius * math.sin(half)) ** 3

    def surface_radius(self, displacement: float) -> float:
        """b', of the free surface about the axis of rotation [m], from the volume."""
        a, b = self.wall_radius, self.inner_radius
        if displacement <= self.gap:
            return b
        hole = math.pi * b * b
        return _root(lambda r: hole - _lens(displacement, a, r)[0], b, a + displacement)

    def moment(self, displacement: float) -> float:
        """Static moment of the liquid about the axis of rotation [kg m].

        Until drying rho pi a^2 h e, as of a full chamber; beyond, the wall's circle less the hole,
        which two segments bound.

        Args:
            displacement: of the ring's centre from the axis, e [m], 0 or more.
        """
        surface = self.surface_radius(displacement)
        _, hole = _lens(displacement, self.wall_radius, surface)
        full = math.pi * self.wall_radius**2 * displacement
        return self.density * self.height * (full - hole)

    def relative_moment(self, displacement: float) -> float:
        """The same about the ring's centre: the unbalance that the liquid undoes [kg m]."""
        return self.moment(displacement) - self.liquid_mass * displacement


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    from scipy.optimize import brentq  # a run does without

    return float(brentq(function, low, high, xtol=1e-15, rtol=1e-14))


def _lens(apart: float, wall: float, surface: float) -> tuple[float, float]:
    """Area, and moment about the centre of `surface`, of what two circles have in common.

    The wall's centre is `apart` from that of the surface.
    """
    if apart <= wall - surface:
        return math.pi * surface**2, 0.0
    if apart >= wall + surface:
        return 0.0, 0.0
    if apart <= surface - wall:
        return math.pi * wall**2, math.pi * wall**2 * apart
    chord = (apart * apart + surface * surface - wall * wall) / (2.0 * apart)
    alpha = math.acos(max(-1.0, min(1.0, chord / surface)))
    gamma = math.acos(max(-1.0, min(1.0, (apart - chord) / wall)))
    one = surface**2 * (alpha - math.sin(alpha) * math.cos(alpha))
    other = wall**2 * (gamma - math.sin(gamma) * math.cos(gamma))
    moment = 2.0 / 3.0 * ((surface * math.sin(alpha)) ** 3 - (wall * math.sin(gamma)) ** 3)
    return one + other, moment + apart * other
