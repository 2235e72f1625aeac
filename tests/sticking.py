"""Weights that stick and slide on a rotor that moves, as events of one equation.

Apart from the units: the monolith's accelerations, with the resistance of every weight as a push
that is solved for, phase by phase between the times at which one comes to rest or breaks away.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from autobalancer.models.assembly import SpeedProfile
from autobalancer.models.reference.coupled import Monolith, Start

Array = NDArray[np.float64]


class Sticking:
    """N weights with resistance `mu` on a planar rotor."""

    def __init__(self, system: Monolith, mu: float) -> None:
        self.system = system
        (mounted,) = system.assembly.weights
        self.count, self.radius = mounted.device.count, mounted.device.track_radius
        self.share = mu / (mounted.device.kappa * self.radius)

    def parts(self, t: float, y: Array, push: Array) -> tuple[Array, Array, Array]:
        """Acceleration of the rotor, theta'' of the weights, and their largest push c n."""
        gravity = self.system.assembly.rotor.gravity
        a, phi2 = self.system.accelerations(t, y, push)
        phi, rate = y[4:].reshape(2, -1)
        felt = complex(*a[:, 0]) - gravity
        load = self.radius * rate**2 - (felt * np.exp(-1j * phi)).real
        return a[:, 0], phi2 - self.system.profile.acceleration(t), self.share * load

    def pushes(self, t: float, y: Array, signs: Array) -> Array:
        """Push on every weight: it is linear in the pushes what they must fulfil."""

        def left(push: Array) -> Array:
            _, bend, limit = self.parts(t, y, push)
            assert (limit > 0.0).all()
            return np.where(signs == 0.0, bend, push + signs * limit)

        none = left(np.zeros(self.count))
        columns = [left(unit) - none for unit in np.eye(self.count)]
        return np.linalg.solve(np.array(columns).T, -none)

    def rhs(self, t: float, y: Array, signs: Array) -> Array:
        a, bend, _ = self.parts(t, y, self.pushes(t, y, signs))
        spin_up = self.system.profile.acceleration(t)
        return np.concatenate([y[2:4], a, y[4 + self.count :], bend + spin_up])

    def event(self, t: float, y: Array, signs: Array, k: int) -> float:
        """Falls through 0 where weight k comes to rest, or breaks away."""
        if signs[k]:
            return signs[k] * (y[4 + self.count + k] - self.system.profile.speed(t))
        push = self.pushes(t, y, signs)
        return self.parts(t, y, push)[2][k] * (1.0 + 1e-9) - abs(push[k])

    def after(self, t: float, y: Array, signs: Array, k: int) -> Array:
        """Who slides which way once weight k has come to rest, or can no longer rest."""
        held = signs.copy()
        held[k] = 0.0
        push = self.pushes(t, y, held)
        if abs(push[k]) > self.parts(t, y, push)[2][k]:
            held[k] = -np.sign(push[k])
        return held


def integrate(system: Monolith, start: Start, mu: float, end: float) -> tuple[Array, Array, int]:
    """Angles of the weights in the rotor at the end, who still slides, and how many events."""
    bodies, y, t, events = Sticking(system, mu), system.initial(start), 0.0, 0
    signs = np.zeros(bodies.count)
    for k in range(bodies.count):
        signs = bodies.after(t, y, signs, k)
    profile: SpeedProfile = system.profile
    stops = [s for s in (profile.seconds, end) if 0.0 < s <= end]
    while t < end:
        stop = next(s for s in stops if s > t)
        watched = []
        for k in range(bodies.count):

            def event(s: float, y: Array, k: int = k, signs: Array = signs) -> float:
                return bodies.event(s, y, signs, k)

            event.terminal, event.direction = True, -1
            watched.append(event)
        found = solve_ivp(
            lambda s, y, signs=signs, stop=stop: bodies.rhs(min(s, stop - 1e-12), y, signs),
            (t, stop), y, "DOP853", events=watched, rtol=1e-9, atol=1e-11, max_step=0.01,
        )  # fmt: skip
        t, y = float(found.t[-1]), found.y[:, -1].copy()
        for k, times in enumerate(found.t_events):
            if len(times):
                y[4 + bodies.count + k] = profile.speed(t)
                signs = bodies.after(t, y, signs, k)
                events += 1
    return y[4 : 4 + bodies.count] - start.angle - profile.angle(end), signs, events
