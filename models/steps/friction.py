"""Step of the linear rotor with dry friction in its supports, at constant or changing speed.

Between events (a slider sticks, lets go or turns round) the system is linear: displacements,
velocities and friction forces are Taylor series in time, whose recurrence takes the cubic forces,
unbalance, gravity and a cubic angular acceleration as they are (Jorba & Zou 2005).  A stretch is
half of what the fastest rate allows, so that the terms left out are below rounding, and every event
function is a polynomial on it: its first fall below 0 is isolated by bounds of the polynomial and
its slope, so that none is missed, and found to rounding.  Nothing is regularised: a rigid slider
that sticks is a constraint, whose force follows from the acceleration being 0.
"""

from __future__ import annotations

import math
import operator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..rotor import LinearRotor
from ..spin import drift
from .first_fall import first_fall
from .variable_speed import Drive, VariableSpeedStep

TERMS = 18  # 0.5**18/18! is far below rounding
_REACH = 0.5  # of a stretch, by the fastest rate
_ROUNDING = 1e-12  # of a limit: a force so near to it has reached it
_SWEEPS, _SETTLED = 10_000, 1e-15  # over sliders at rest, and of their limits
MOST_STRETCHES = 10_000  # of a step, events included


class Held(NamedTuple):
    """What friction remembers, (m,) each.

    Attributes:
        slips: -1 or 1, the direction in which a slider slips; 0 while it sticks.
        force: on the rotor [N].
    """

    slips: NDArray
    force: NDArray


def held_at_start(rotor: LinearRotor, rates: NDArray) -> Held:
    """Sliders with slack springs; rigid ones slip with the rotor, where it moves.

    Args:
        rates: (2n,) velocities of the stations, x before y [m/s].
    """
    slips, force = np.zeros(len(rotor.sliders)), np.zeros(len(rotor.sliders))
    for j, slider in enumerate(rotor.sliders):
        if slider.limit == 0.0:
            slips[j] = 1.0  # and never sticks
        elif slider.stiffness == 0.0:
            slips[j] = np.sign(rates[slider.axis * rotor.stations + slider.station])
            force[j] = -slips[j] * slider.limit
    return Held(slips, force)


class _Series(NamedTuple):
    """Taylor coefficients (terms + 1, ...) over a stretch of length 1."""

    places: NDArray
    rates: NDArray
    forces: NDArray


class FrictionStep:
    """The rotor's matrices, its sliders, and the step that uses them.

    Raises:
        ValueError: two rigid sliders at one station and axis.
    """

    def __init__(self, rotor: LinearRotor, turning_force: bool = True) -> None:
        self.rotor = rotor
        self.smooth = VariableSpeedStep(rotor, turning_force)
        dof = self.smooth.dof
        self.at = np.array([s.axis * rotor.stations + s.station for s in rotor.sliders])
        self.limit = np.array([s.limit for s in rotor.sliders])
        self.stiffness = np.array([s.stiffness for s in rotor.sliders])
        self.rigid = (self.stiffness == 0.0) & (self.limit > 0.0)
        if len(set(self.at[self.rigid])) < self.rigid.sum():
            raise ValueError(
                "sliders: two rigid ones at one support and axis are one with the sum of their "
                "limits; give that, or a stiffness"
            )
        self.push = self.smooth.inverse[:, self.at]  # acceleration by the sliders' forces
        # acceleration by all limits at the place of each slider
        self.mobility = np.diag(self.push[self.at]) * np.array(
            [self.limit[self.at == place].sum() for place in self.at]
        )
        still, per_speed = self.smooth.still.copy(), self.smooth.per_speed
        np.add.at(still.T, self.at, -(self.push * self.stiffness).T)
        self._norms = [_norm(m[:, half]) for half in (slice(dof), slice(dof, None))
                       for m in (still, per_speed)]  # fmt: skip

    def advance(
        self, state: NDArray, held: Held, drive: Drive, step: float
    ) -> tuple[NDArray, Held]:
        """State (q, v), x before y, and sliders one `step` [s] later.

        Raises:
            ArithmeticError: the motion is too fast, or events follow each other too closely, for
                `MOST_STRETCHES` in the step.
        """
        time = 0.0
        held = self.resolved(state, held, drive, 0.0)
        for _ in range(MOST_STRETCHES):
            # no longer than what is left: forces of short steps may have any slope
            stretch = min(self._stretch(drive, time), step - time)
            series = self._series(state, held, drive, time, stretch, TERMS)
            fraction, which = self._first_event(series, held, stretch)
            powers = fraction ** np.arange(TERMS + 1)
            state = np.concatenate([powers @ series.places, powers @ series.rates])
            held = held._replace(force=powers @ series.forces)
            if which < 0 and stretch == step - time:
                return state, held
            time += fraction * stretch
            if which >= 0:
                held = self._changed(state, held, drive, time, which, fraction > 0.0)
        raise ArithmeticError(
            f"more than {MOST_STRETCHES} stretches and events of the sliders in {step:.6g} s, "
            f"{time:.6g} s reached: use smaller communication steps"
        )

    def plane_motion(
        self, state: NDArray, held: Held, drive: Drive, t: float
    ) -> tuple[NDArray, NDArray, Held]:
        """Acceleration and jerk of the planes in fixed axes (2p,), and the friction, at time t."""
        acceleration, jerk, force = self._motion(state, held, drive, t)
        planes = self.smooth.planes
        return planes @ acceleration, planes @ jerk, held._replace(force=force)

    def torque(self, state: NDArray, held: Held, drive: Drive, t: float) -> tuple[float, float]:
        """As `VariableSpeedStep.torque`; friction in the supports shows in the acceleration."""
        if not t:
            held = self.resolved(state, held, drive, t)
        return self.smooth.torque(state, drive, t, self._motion(state, held, drive, t)[:2])

    def _motion(
        self, state: NDArray, held: Held, drive: Drive, t: float
    ) -> tuple[NDArray, NDArray, NDArray]:
        """Acceleration and jerk of the stations (2n,), and the sliders' forces, at time t."""
        stretch = self._stretch(drive, t)
        series = self._series(state, held, drive, t, stretch, 2)
        acceleration, jerk = series.rates[1] / stretch, 2.0 * series.rates[2] / stretch**2
        return acceleration, jerk, series.forces[0]

    def resolved(self, state: NDArray, held: Held, drive: Drive, t: float) -> Held:
        """Whether each rigid slider at rest sticks or slips, and which way.

        The forces are the least-squares solution within the limits (Moreau 1988: Gauss' principle),
        by projected Gauss-Seidel sweeps, which converge for any mass matrix.
        """
        rates = state[self.smooth.dof :][self.at]
        (resting,) = np.nonzero(self.rigid & ((held.slips == 0.0) | (rates == 0.0)))
        if not len(resting):
            return held
        slips, force = held.slips.copy(), held.force.copy()
        slips[resting], force[resting] = 1.0, 0.0  # as if without them
        free = self._series(state, Held(slips, force), drive, t, 1.0, 1).rates[1][self.at[resting]]
        mobility, limit = self.push[np.ix_(self.at[resting], resting)], self.limit[resting]
        holding = np.zeros(len(resting))
        for _ in range(_SWEEPS):
            before = holding.copy()
            for i in range(len(holding)):
                change = (free[i] + mobility[i] @ holding) / mobility[i, i]
                holding[i] = min(max(holding[i] - change, -limit[i]), limit[i])
            if (np.abs(holding - before) <= _SETTLED * limit).all():
                break
        slips[resting] = np.where(np.abs(holding) < limit, 0.0, -np.sign(holding))
        force[resting] = holding
        return Held(slips, force)

    def _stretch(self, drive: Drive, t: float) -> float:
        """Length of a stretch from time t on [s]."""
        _, speed, rates = _turning(drive, t, 1.0)
        w, spin_up, *faster = abs(speed[0]), *map(abs, rates)
        spring, spring_1, damper, damper_1 = self._norms
        rate = math.sqrt(spring + w * spring_1) + damper + w * damper_1 + w
        stretch = _REACH / (rate + math.sqrt(spin_up))
        while sum(change * stretch**k for k, change in enumerate(faster, start=3)) > _REACH**3:
            stretch *= 0.5
        return stretch

    def _series(
        self, state: NDArray, held: Held, drive: Drive, t: float, stretch: float, terms: int
    ) -> _Series:
        smooth, dof, h = self.smooth, self.smooth.dof, stretch
        w = _turning(drive, t, h).speed
        push = _pushes(smooth, drive, t, stretch, terms)
        matrix = smooth.still + w[0] * smooth.per_speed
        motion = np.zeros((terms + 1, 2 * dof))
        forces = np.zeros((terms + 1, len(self.at)))
        stuck = self.rigid & (held.slips == 0.0)
        spring = np.where(held.slips == 0.0, self.stiffness, 0.0)
        stopped = self.at[stuck]
        mobility = self.push[np.ix_(stopped, stuck)]
        motion[0] = state
        motion[0, dof + stopped] = 0.0
        forces[0] = np.where(stuck, 0.0, held.force)
        for k in range(terms + 1):
            if k:
                forces[k] = -spring * motion[k, self.at]
            rate = matrix @ motion[k] + push[k] + self.push @ forces[k]
            for j in range(1, min(k, 4) + 1):
                if w[j]:
                    rate += w[j] * (smooth.per_speed @ motion[k - j])
            if len(stopped):
                forces[k, stuck] = -np.linalg.solve(mobility, rate[stopped])
                rate += self.push[:, stuck] @ forces[k, stuck]
                rate[stopped] = 0.0
            if k < terms:
                motion[k + 1, :dof] = h / (k + 1) * motion[k, dof:]
                motion[k + 1, dof:] = h / (k + 1) * rate
        return _Series(motion[:, :dof], motion[:, dof:], forces)

    def _first_event(self, series: _Series, held: Held, stretch: float) -> tuple[float, int]:
        """When, as a fraction of the stretch, which slider changes first: -1 for none."""
        first, which = 1.0, -1
        for j, limit in enumerate(self.limit):
            if limit == 0.0:
                continue
            # where a slider starts from rest the first acceleration may be rounding, too
            still = _ROUNDING * stretch * self.mobility[j]
            rounding = [_ROUNDING * limit, 0.0, 0.5 * still * stretch * self.stiffness[j]]
            if held.slips[j]:
                rounding = [0.0, still]
                functions = [held.slips[j] * series.rates[:, self.at[j]]]
            else:
                functions = [-series.forces[:, j], series.forces[:, j].copy()]
                for function in functions:
                    function[0] += limit
            for function in functions:
                fall = first_fall(function, first, rounding)
                if fall < first:
                    first, which = fall, j
        return first, which

    def _changed(
        self, state: NDArray, held: Held, drive: Drive, t: float, j: int, arrived: bool
    ) -> Held:
        """The sliders after the event of slider j; `arrived`: by a motion, not at once."""
        slips, force = held.slips.copy(), held.force.copy()
        if slips[j] == 0.0:
            slips[j] = -math.copysign(1.0, force[j])
            force[j] = -slips[j] * self.limit[j]
            return Held(slips, force)
        slips[j] = state[self.smooth.dof + self.at[j]] = 0.0
        held = Held(slips, force)
        return self.resolved(state, held, drive, t) if arrived and self.rigid[j] else held


def _pushes(smooth: VariableSpeedStep, drive: Drive, t: float, h: float, terms: int) -> NDArray:
    """Taylor coefficients (terms + 1, dof) of what moves the rotor, over a stretch h from t on."""
    forces = drive.forces
    angle, w, spin_up = _turning(drive, t, h)
    powers = [complex(np.exp(1j * angle))]  # in plain numbers: one by one they are faster
    for k in range(terms):
        powers.append(1j * h / (k + 1) * sum(map(operator.mul, w, powers[:-6:-1])))
    turn = np.array(powers)
    cubic = [
        forces[0] + t * (forces[1] + t * (forces[2] / 2 + t * forces[3] / 6)),
        h * (forces[1] + t * (forces[2] + t * forces[3] / 2)),
        h * h * (forces[2] + t * forces[3]) / 2,
        h**3 * forces[3] / 6,
    ]
    pull = np.convolve(w, w).astype(complex)
    pull[:4] -= 1j * np.array(spin_up)
    values = np.zeros((terms + 1, forces.shape[1] + 1), complex)
    for m, term in enumerate(cubic[: terms + 1]):
        if smooth.turning_force:
            values[m:, :-1] += np.outer(turn[: terms + 1 - m], term)
        else:
            values[m, :-1] = term
    for m, factor in enumerate(pull[: terms + 1]):
        values[m:, -1] += factor * turn[: terms + 1 - m]
    p = forces.shape[1]
    planes = np.hstack([values[:, :p].real, values[:, :p].imag])
    unbalance = np.stack([values[:, p].real, values[:, p].imag], axis=1)
    pushes = planes @ smooth.force.T + unbalance @ smooth.unbalance.T
    if smooth.falling is not None:
        pushes[0] += smooth.falling
    return pushes


class _Turning(NamedTuple):
    """How the rotor turns over a stretch: Taylor coefficients of its speed and acceleration.

    Attributes:
        angle: at the start.
        speed, spin_up: (5,), (4,).
    """

    angle: float
    speed: tuple[float, ...]
    spin_up: tuple[float, ...]


def _turning(drive: Drive, t: float, h: float) -> _Turning:
    """Over a stretch h from time t on."""
    _, second, third = drive.rates
    gone, faster, more, change = drift(drive.rates, t)
    spin_up = (
        drive.angular_acceleration + more,
        h * change,
        h * h * (second + t * third) / 2.0,
        h**3 * third / 6.0,
    )
    speed = drive.speed + drive.angular_acceleration * t + faster
    angle = drive.angle + drive.speed * t + 0.5 * drive.angular_acceleration * t * t + gone
    return _Turning(angle, (speed, *(h * a / k for k, a in enumerate(spin_up, start=1))), spin_up)


def _norm(matrix: NDArray) -> float:
    """Largest sum of a row's absolute values."""
    return float(np.abs(matrix).sum(axis=1).max())
