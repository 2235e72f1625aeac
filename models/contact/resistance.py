"""Rolling resistance with true sticking, and a track whose centre is off the rotor's.

The two causes of residual unbalance named by Goncharov 2017 (section 2, after Nesterenko 1985 and
Yang 2005).  A weight at e + R e^{i theta} in the rotor (e: offset of the track's centre) moves by

    theta'' + d theta' = g - sign(theta') c |n|,        theta' = 0 while |g| <= c |n|,
    g = -Im(a_c e^{-i theta})/(kappa R) - w',           n = R (w + theta')^2 - Re(a_c e^{-i theta}),
    a_c = a + (i w' - w^2) e,                           c = mu/(kappa R),

with a_c the acceleration of the track's centre, m |n| the force between weight and race (either
wall of the race may carry it), and mu the coefficient of rolling resistance: lever arm of the
resistance over the weight's radius for balls and rollers (5e-6 m to 5e-5 m for hardened steel),
friction times journal radius over R for pendulums.  The load is planar: no gravity.

Balance.  a_c = 0 balances the weights, so an offset leaves the track's centre on the axis of
rotation and the rotor's displacement is -e, whatever the unbalance.  With resistance any position
with |Im(a_c e^{-i theta})| <= mu |R w^2 - Re(a_c e^{-i theta})| is an equilibrium: the dead zone.
"""

from __future__ import annotations

import cmath
from collections.abc import Sequence
from dataclasses import dataclass

from ..weights import CONVERGED, MAX_ITERATIONS, quadrature
from .contact import group_factor


def shifted(
    signal: Sequence[complex], offset: complex, speed: float, spin_up: float
) -> tuple[complex, complex, complex, complex]:
    """Signal of the track's centre from that of the plane's: (i w' - w^2) e, exact for linear w.

    Args:
        signal: acceleration and its derivatives at the start of the step, rotor frame.
        offset: of the track's centre in the rotor frame, e [m].
        speed, spin_up: at the start of the step, and constant over it [rad/s, rad/s^2].
    """
    a0, a1, a2, a3 = signal
    return (
        a0 + (1j * spin_up - speed * speed) * offset,
        a1 - 2.0 * speed * spin_up * offset,
        a2 - 2.0 * spin_up * spin_up * offset,
        a3,
    )


@dataclass(frozen=True)
class Slide:
    """Drive of a group that slides one way: what `substep` is to weights without resistance.

    Attributes:
        radius: R [m].
        gain: -1/(kappa R) [1/m].
        grip: sign(theta') mu/(kappa R) [1/m].
        drag: d [1/s].
        count, alpha: weights of the group, half the angle between neighbours [rad].
    """

    radius: float
    gain: float
    grip: float
    drag: float
    count: int
    alpha: float

    def sides(self, a: complex, angle: float, rate: float, speed: float) -> tuple[float, ...]:
        """Which wall of the race carries each weight: 1 outer, -1 inner; empty: all the outer."""
        centrifugal = self.radius * (speed + rate) ** 2
        if abs(a) < centrifugal:
            return ()
        return tuple(
            1.0 if centrifugal >= (a * cmath.rect(1.0, -angle - turn)).real else -1.0
            for turn in self._turns()
        )

    def _turns(self) -> list[float]:
        return [(2 * k - self.count + 1) * self.alpha for k in range(self.count)]

    def drive(
        self,
        end: tuple[complex, complex],
        angle: float,
        rate: float,
        speed: float,
        spin_up: float,
        sides: tuple[float, ...] | None = None,
    ) -> tuple[float, float]:
        """Mean of g - grip |n| over the group, and its time derivative along the motion.

        Args:
            end: acceleration of the track's centre and its slope, rotor frame.
            angle, rate: of the group's middle [rad, rad/s].
            sides: by default those of this instant.
        """
        a, slope = end
        if sides is None:
            sides = self.sides(a, angle, rate, speed)
        turning = speed + rate
        centrifugal = self.radius * turning * turning
        turn = cmath.rect(1.0, -angle)
        if sides:
            units = [turn * cmath.rect(1.0, -by) for by in self._turns()]
            pairs = list(zip(units, sides, strict=True))
        else:  # the sum over the group is known
            pairs = [(group_factor(self.count, self.alpha) * turn, 1.0)]
        g = dg = load = 0.0
        for unit, outward in pairs:
            z, dz = a * unit, slope * unit
            pull = self.grip * outward
            load += pull
            g += self.gain * z.imag + pull * z.real
            dg += self.gain * (dz.imag - rate * z.real) + pull * (dz.real + rate * z.imag)
        share = 1.0 / len(pairs)
        g = share * (g - load * centrifugal) - spin_up
        bend = g - self.drag * rate
        dg = share * (dg - 2.0 * load * self.radius * turning * (spin_up + bend))
        return g, dg

    def substep(
        self,
        angle: float,
        rate: float,
        ends: tuple[complex, complex, complex, complex],
        speed: float,
        spin_up: float,
        step: float,
    ) -> tuple[float, float]:
        """Angle and rate after `step`; order 4 as `weights.substep`, of which it is the twin.

        Raises:
            ArithmeticError: the implicit equations did not converge.
        """
        a0, da0, a1, da1 = ends
        e, s0, s1, s2, s3, t, t0, t1, t2, t3 = quadrature(self.drag, step)
        g0, g1 = self.drive((a0, da0), angle, rate, speed, spin_up)
        free_rate = e * rate + s0 * g0 + s1 * g1
        free_angle = angle + t * rate + t0 * g0 + t1 * g1
        new_angle, new_rate = free_angle, free_rate
        speed_end = speed + spin_up * step
        # kept during the iteration, which a load that changes sides in it would not let converge
        sides = self.sides(a1, free_angle, free_rate, speed_end)
        inverse = 1.0 / step
        for _ in range(MAX_ITERATIONS):
            end, slope = self.drive((a1, da1), new_angle, new_rate, speed_end, spin_up, sides)
            rise = (end - g0) * inverse
            g2 = (6.0 * rise - 4.0 * g1 - 2.0 * slope) * inverse
            g3 = (6.0 * (g1 + slope) - 12.0 * rise) * inverse * inverse
            last_angle, last_rate = new_angle, new_rate
            new_rate = free_rate + s2 * g2 + s3 * g3
            new_angle = free_angle + t2 * g2 + t3 * g3
            change = abs(new_angle - last_angle) + abs(new_rate - last_rate) * step
            if change <= CONVERGED * (1.0 + abs(new_angle)):
                return new_angle, new_rate
        raise ArithmeticError(
            f"the sliding weights' step of {step:g} s did not converge (angle {angle:g} rad, "
            f"rate {rate:g} rad/s, acceleration {abs(a0):g} m/s^2): use smaller steps"
        )
