"""Dry friction in the coupled equations: weights and supports that stick and slip.

Apart from the units, which know the rest of the machine by signals: here the force of everything
that can stick is solved for with all accelerations at once.  Rolling resistance pushes a weight
against its sliding by c |n| (Goncharov 2017, section 2; c, n as in `contact.resistance`), a rigid
slider pushes its station by its limit; at rest both push as it takes to stay there, until that is
more than the limit.  A slider behind a spring has the spring's force as a state (Jenkins 1962).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import OptimizeResult

from ..arrays import Array
from .coupled import Monolith, Start
from .phases import solve_to_event

MARGIN = 1e-9  # of a limit: what holds may push by so much more, so that rounding frees nothing
TURN_RATE_ROUNDING = 1e-14  # of the rate at which a weight turns in space


@dataclass(frozen=True)
class Phase:
    """What holds between two events.

    Attributes:
        slips: (g,) -1 or 1, the direction in which each grip slips; 0 while it sticks.
        sides: (w,) 1 where the outer wall of the race carries a weight with resistance, else -1.
    """

    slips: Array
    sides: Array


class Dry:
    """The grips of a `Monolith`: weights with resistance, rigid sliders, sliders behind springs.

    The state is that of the monolith, and the springs' forces on the rotor [N].
    """

    def __init__(self, system: Monolith) -> None:
        self.system, n = system, system.stations
        self.count, self._vibration = system.weights, system.fastest_vibration
        mounted = [m for m in system.assembly.weights for _ in m.angles]
        self.weights = [k for k, m in enumerate(mounted) if m.rolling_resistance]
        self._of = [mounted[k] for k in self.weights]
        self._share = np.array([m.rolling_resistance / _lever(m.device) for m in self._of])
        sliders = [s for s in system.assembly.rotor.sliders if s.limit]
        if any(s.row or s.free_stroke for s in sliders):
            raise ValueError("sliders: the reference has them at stations and without free stroke")
        rigid = [s for s in sliders if not s.stiffness]
        springs = [s for s in sliders if s.stiffness]
        self.sliders, self.solved = rigid + springs, len(self.weights) + len(rigid)
        self._springs, self._rigid = springs, rigid
        self._limits = np.array([s.limit for s in self.sliders])
        turning = [4 * n + self.count + k for k in self.weights]
        # of every grip the place of its rate in the state
        self.places = turning + [(2 + s.axis) * n + s.station for s in self.sliders]

    def scales(self, start: Start) -> Array:
        """Typical size of each part of the state."""
        limits = [s.limit for s in self._springs]
        return np.concatenate([self.system.scales(start), limits])

    def rates(self, t: float, y: Array) -> Array:
        """Rate at which every grip slips (g,)."""
        rates = y[self.places]
        rates[: len(self.weights)] -= self.system.profile.speed(t)
        return rates

    def pushed(self, t: float, y: Array, pushes: Array) -> tuple[Array, Array]:
        """As `Monolith.accelerations`, with `pushes` (k, s) of the grips that are solved for."""
        trials, weights = len(pushes), len(self.weights)
        push, force = np.zeros((trials, self.count)), np.zeros((trials, 2 * self.system.stations))
        push[:, self.weights] = pushes[:, :weights]
        of_sliders = [*pushes[:, weights:].T, *y[self.system.size :]]
        for slider, value in zip(self.sliders, of_sliders, strict=True):
            force[:, slider.axis * self.system.stations + slider.station] += value
        return self.system.accelerations(t, y[: self.system.size], push, force)

    def answers(self, t: float, y: Array, pushes: Array) -> Array:
        """Accelerations of stations and weights, of the grips that are solved for, and loads n;
        of each of the `pushes` (k, s) a row."""
        a, phi2 = self.pushed(t, y, pushes)
        profile, rotor = self.system.profile, self.system.assembly.rotor
        w, w1 = profile.speed(t), profile.acceleration(t)
        grips = [*(phi2[:, self.weights] - w1).T, *(a[:, s.axis, s.station] for s in self._rigid)]
        relative = a[:, 0] + 1j * a[:, 1] - rotor.gravity
        turned = (1j * w1 - w * w) * np.exp(1j * (self.system.angle + profile.angle(t)))
        loads = []
        for k, m in zip(self.weights, self._of, strict=True):
            phi, rate = y[4 * self.system.stations + k :: self.count][:2]
            centre = relative @ rotor.planes[m.plane] + turned * m.offset
            inward = (centre * np.exp(-1j * phi)).real
            loads.append(m.device.track_radius * rate**2 - inward)  # type: ignore[union-attr]
        rest = np.array([*grips, *loads]).reshape(-1, len(pushes)).T
        return np.hstack([a.reshape(len(pushes), -1), phi2, rest])

    def balance(self, t: float, y: Array, phase: Phase) -> tuple[Array, Array, Array]:
        """Pushes of the grips, accelerations of stations and weights, limits of all grips (g,).

        Accelerations, loads and so limits are linear in the pushes that they are to agree with.
        """
        trials = np.vstack([np.zeros(self.solved), np.eye(self.solved)])
        answers = self.answers(t, y, trials)
        answers[1:] -= answers[0]
        lateral, weights = 2 * self.system.stations + self.count, len(self.weights)
        grips = answers[:, lateral : lateral + self.solved]
        limits = np.zeros((1 + self.solved, len(phase.slips)))
        limits[:, :weights] = self._share * phase.sides * answers[:, lateral + self.solved :]
        limits[0, weights:] = self._limits
        slips = phase.slips[: self.solved]
        left = np.where(slips == 0.0, grips, trials + slips * limits[:, : self.solved])
        pushes = np.linalg.solve(left[1:].T, -left[0])
        factors = np.concatenate([[1.0], pushes])
        return pushes, (factors @ answers)[:lateral], factors @ limits

    def accelerations(self, t: float, y: Array, phase: Phase) -> tuple[Array, Array]:
        """Of stations (2, n) and weights (N,)."""
        lateral, bend = np.split(self.balance(t, y, phase)[1], [2 * self.system.stations])
        return lateral.reshape(2, -1), bend

    def rhs(self, t: float, y: Array, phase: Phase) -> Array:
        """Derivative of the state."""
        n = self.system.stations
        accelerations = self.balance(t, y, phase)[1]
        springs = [
            0.0 if slips else -s.stiffness * y[place]
            for s, slips, place in zip(
                self._springs, phase.slips[self.solved :], self.places[self.solved :], strict=True
            )
        ]
        turning = y[4 * n + self.count : self.system.size]
        lateral, bend = np.split(accelerations, [2 * n])
        for j in np.flatnonzero(phase.slips[: self.solved] == 0.0):  # exactly at rest
            if j < len(self.weights):
                bend[self.weights[j]] = self.system.profile.acceleration(t)
            else:
                lateral[self.places[j] - 2 * n] = 0.0
        return np.concatenate([y[2 * n : 4 * n], lateral, turning, bend, springs])

    def watched(self, t: float, y: Array, phase: Phase) -> Array:
        """What falls through 0 where a grip comes to rest or lets go, or a weight changes walls."""
        pushes, _, limits = self.balance(t, y, phase)
        forces = np.concatenate([pushes, y[self.system.size :]])
        room = limits * (1.0 + MARGIN) - np.abs(forces)
        # by rounding nothing that has just let go comes to rest
        rests = phase.slips * self.rates(t, y) + TURN_RATE_ROUNDING * np.abs(y[self.places])
        stops = np.where(phase.slips == 0.0, room, rests)
        return np.concatenate([stops, limits[: len(self.weights)] / self._share])

    def after(
        self, t: float, y: Array, phase: Phase, happened: Sequence[int]
    ) -> tuple[Array, Phase]:
        """State and phase behind events, numbered as `watched`."""
        y, slips, sides = y.copy(), phase.slips.copy(), phase.sides.copy()
        forces = [*self.balance(t, y, phase)[0], *y[self.system.size :]]
        changed = [j - len(slips) for j in happened if j >= len(slips)]
        sides[changed] *= -1.0
        for j in happened:
            if j >= len(slips):
                continue
            if phase.slips[j]:  # all that slip there come to rest
                weight = j < len(self.weights)
                y[self.places[j]] = self.system.profile.speed(t) if weight else 0.0
                slips[[place == self.places[j] for place in self.places]] = 0.0
            else:
                slips[j] = -np.sign(forces[j])
                if j >= self.solved:
                    spring = j - self.solved
                    y[self.system.size + spring] = -slips[j] * self._springs[spring].limit
        return self.settled(t, y, Phase(slips, sides), changed)

    def settled(
        self, t: float, y: Array, phase: Phase, changed: Sequence[int] = ()
    ) -> tuple[Array, Phase]:
        """State and phase once walls carry what lies on them, and what cannot be held has let go.

        Args:
            changed: weights that have just come to the wall they are on, with a load of 0.

        Raises:
            ArithmeticError: there is none.
        """
        slips, sides = phase.slips.copy(), phase.sides.copy()
        weights = len(self.weights)
        for _ in range((1 + self.solved) * (1 + weights)):
            pushes, _, limits = self.balance(t, y, Phase(slips, sides))
            carried = limits[:weights] < 0.0
            carried[list(changed)] = False
            if carried.any():
                sides[carried] *= -1.0
                continue
            with np.errstate(divide="ignore", invalid="ignore"):  # no load holds nothing
                over = np.abs(pushes) / np.abs(limits[: self.solved] * (1.0 + MARGIN))
            over[slips[: self.solved] != 0.0] = 0.0
            if not (over > 1.0).any():
                return y, Phase(slips, sides)
            first = int(np.nanargmax(over))
            slips[first] = -np.sign(pushes[first])
        raise ArithmeticError(f"no weight knows which wall carries it at {t:g} s")

    def begin(self, start: Start) -> tuple[Array, Phase]:
        """State and phase at time 0: what moves slips, springs are slack."""
        y = np.concatenate([self.system.initial(start), np.zeros(len(self._springs))])
        slips = np.sign(self.rates(0.0, y))
        slips[self.solved :] = 0.0
        return self.settled(0.0, y, Phase(slips, np.ones(len(self.weights))))

    def fastest(self, _y: Array) -> float:
        """Fastest turning [rad/s], which limits a step."""
        return max(abs(self.system.profile.end), self._vibration)

    def solve(self, t: float, end: float, y: Array, phase: Phase, **options: Any) -> OptimizeResult:
        """The motion up to the next event."""
        return solve_to_event(self, t, end, y, phase, **options)


def _lever(device: object) -> float:
    return device.kappa * device.track_radius  # type: ignore[attr-defined]
