"""Weights of finite size in the coupled equations: integrated from contact to contact.

Formulated apart from the units: a contact is a constraint phi_j'' = phi_i'' on the whole system,
kept by a pair of equal and opposite pushes along the track, which are solved for with the rotor's
acceleration at every evaluation; it opens when its push turns into a pull.

An impact gives such pushes at once: v+ = v- + D L with the response D of the whole system, which
follows from the accelerations that unit pushes make.  L >= 0, v+ + e v- >= 0, and one of the two is
0 for each pair: the conditions for the least |C L + C^-T (1 + e) v-|^2, L >= 0, with D = C^T C.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import solve_triangular
from scipy.optimize import OptimizeResult, brentq, nnls

from ..arrays import Array
from .coupled import REST, Monolith, Start, weights_of

Pair = tuple[int, int, float, float]  # two neighbours, distance of touching, turns between them
MARGIN = 1e-12  # rad: a gap this far below zero is closed, so that rounding closes none; a slow
# closing is late by MARGIN over its speed
OVERLAP = 2e-10  # rad: what the integration may leave of a contact that lasts
SHIFTS = 8  # each halves what gaps of a chain of weights are off
LOWEST = 1e-9  # rad: a bounce that would rise less ends in contact
MOST_IMPACTS = 100  # at one time, each of which ends or turns round what approaches
MOST_EVENTS = 2000  # collisions and contacts that open in a run
LONGEST = 0.3  # rad of the fastest turning in a step: no gap may close and open within one


class Colliding:
    """Contacts of the weights of a `Monolith`."""

    def __init__(self, system: Monolith) -> None:
        """Find who is beside whom on every track where weights can meet."""
        self.system = system
        self.first = 4 * system.stations
        self.count = system.weights
        self.pairs: list[Pair] = []
        self.restitution: dict[Pair, float] = {}
        inertia: list[float] = []  # kappa m R^2 of every weight
        begin = 0
        for m in system.assembly.weights:
            n = len(m.angles)
            if m.half_angle and n > 1:
                order = sorted(range(n), key=lambda k, m=m: m.angles[k] % math.tau)  # type: ignore[misc]
                radii, track = weights_of(m).radii, weights_of(m).track_radius
                for a, b in zip(order, [*order[1:], order[0]], strict=True):
                    apart = (m.angles[b] - m.angles[a]) % math.tau
                    turns = apart - (m.angles[b] - m.angles[a])
                    touching = 2.0 * m.half_angle
                    if radii:
                        touching = 2.0 * math.asin((radii[a] + radii[b]) / (2.0 * track))
                    pair = (begin + a, begin + b, touching, turns)
                    self.pairs.append(pair)
                    self.restitution[pair] = m.restitution
            inertia += [d.kappa * d.moment * d.track_radius for d in weights_of(m).each]
            begin += n
        self.inertia = np.array(inertia)

    def gap(self, pair: Pair, y: Array) -> float:
        """Angle between the surfaces of two neighbours [rad]."""
        a, b, touching, turns = pair
        return float(y[self.first + b] - y[self.first + a]) + turns - touching

    def approach(self, pair: Pair, y: Array) -> float:
        """Rate at which a gap closes [rad/s]."""
        rates = y[self.first + self.count :]
        return float(rates[pair[0]] - rates[pair[1]])

    def closing(self, y: Array) -> list[float]:
        """Times in which gaps would be as far below 0 as they are above [s]: no step skips that."""
        gaps = [(self.gap(pair, y) + MARGIN, self.approach(pair, y)) for pair in self.pairs]
        return [2.0 * gap / rate for gap, rate in gaps if gap > 0.0 and rate > 0.0]

    def pushes(self, t: float, y: Array, joined: Sequence[Pair]) -> tuple[Array, Array]:
        """Pushes of joined neighbours (J,) [N m], and by them on every weight (N,) [rad/s^2]."""
        if not joined:
            return np.zeros(0), np.zeros(self.count)
        free = self.system.accelerations(t, y)[1]
        return self._against(t, y, joined, free, free)

    def responses(
        self, t: float, y: Array, pairs: Sequence[Pair], free: Array
    ) -> tuple[Array, Array]:
        """Rates by unit pushes on a held rotor (J, N), and opening speeds by them (J, J)."""
        rows = np.zeros((len(pairs), self.count))
        for row, (a, b, *_) in zip(rows, pairs, strict=True):
            row[a], row[b] = -1.0, 1.0
        pushed = rows / self.inertia
        answers = [self.system.accelerations(t, y, push)[1] - free for push in pushed]
        return pushed, rows @ np.array(answers).T

    def _against(
        self, t: float, y: Array, joined: Sequence[Pair], motion: Array, free: Array
    ) -> tuple[Array, Array]:
        """Pushes, as of `pushes`, by which joined neighbours lose their differences in `motion`."""
        pushed, response = self.responses(t, y, joined, free)
        opening = np.array([motion[b] - motion[a] for a, b, *_ in joined])
        sizes = np.asarray(np.linalg.lstsq(response, -opening, rcond=None)[0], float)
        return sizes, sizes @ pushed

    def after_impact(self, t: float, y: Array, held: Array) -> Array:
        """The state after a blow that changes rates by `held` (N,) on a rotor that is held."""
        still, phi_still = self.system.accelerations(t, y)
        moved, phi_moved = self.system.accelerations(t, y, held)
        after, n = y.copy(), self.system.stations
        after[2 * n : 4 * n] += (moved - still).ravel()
        after[self.first + self.count :] += phi_moved - phi_still
        return after

    def rhs(self, t: float, y: Array, joined: Sequence[Pair]) -> Array:
        """Derivative of the state, (size,), with contacts that last."""
        n = self.system.stations
        a, phi2 = self.system.accelerations(t, y, self.pushes(t, y, joined)[1])
        for run in _runs(
            joined
        ):  # equal already, but for rounding, which adds up in a long contact
            phi2[run] = phi2[run].mean()
        return np.concatenate([y[2 * n : 4 * n], a.ravel(), y[self.first + self.count :], phi2])

    def collide(self, t: float, y: Array, touching: Sequence[Pair]) -> Array:
        """The state after all impacts between neighbours that touch.

        Raises:
            ArithmeticError: they do not come to an end.
        """
        free = self.system.accelerations(t, y)[1]
        pushed, response = self.responses(t, y, touching, free)
        factor = np.linalg.cholesky(response).T
        e = np.array([self.restitution[pair] for pair in touching])
        for _ in range(MOST_IMPACTS):
            rates = y[self.first + self.count :]
            opening = np.array([rates[b] - rates[a] for a, b, *_ in touching])
            if opening.min() >= -1e-13 * np.abs(rates).max():
                return y
            right = solve_triangular(factor, (1.0 + e) * opening, trans="T")
            impulses = nnls(factor, -right)[0]
            y = self.after_impact(t, y, impulses @ pushed)
        raise ArithmeticError(f"impacts at {t:g} s do not come to an end")

    def settle(self, t: float, y: Array, touching: Sequence[Pair]) -> tuple[Array, list[Pair]]:
        """After a collision: bounces too low are ended, and contacts that would pull left out."""
        joined = list(touching)
        free = self.system.accelerations(t, y)[1]
        for pair in touching:
            pressed = free[pair[0]] - free[pair[1]]
            apart = max(0.0, -self.approach(pair, y))
            if apart * apart > 2.0 * LOWEST * max(pressed, 0.0):
                joined.remove(pair)
        if joined:  # what bounces no more has given its momentum to the rotor
            rates = y[self.first + self.count :]
            y = self.after_impact(t, y, self._against(t, y, joined, rates, free)[1])
        y = y.copy()
        phi, rates = y[self.first : self.first + self.count], y[self.first + self.count :]
        for _ in range(SHIFTS):  # back to gaps of zero, so that the next closing is seen
            for pair in self.pairs:
                short = self.gap(pair, y)
                if pair in touching or short < 0.0:  # the shift of a neighbour closes it as well
                    phi[pair[0]] += 0.5 * short
                    phi[pair[1]] -= 0.5 * short
        for run in _runs(joined):
            rates[run] = rates[run].mean()
        while joined:
            sizes, _ = self.pushes(t, y, joined)
            if sizes.min() >= 0.0:
                break
            del joined[int(sizes.argmin())]
        return y, joined


def _runs(pairs: Sequence[Pair]) -> list[list[int]]:
    """Weights of neighbouring pairs in a row, each run in order."""
    runs: list[list[int]] = []
    for a, b, *_ in pairs:
        if runs and runs[-1][-1] == a:
            runs[-1].append(b)
        else:
            runs.append([a, b])
    if len(runs) > 1 and runs[-1][-1] == runs[0][0]:  # across the end of the list
        runs[0] = [*runs.pop(), *runs[0][1:]]
    return runs


def integrate_contacts(
    system: Monolith, time: Array, initial: Start = REST, *, method: str, rtol: float
) -> Array:
    """States at ascending times, (T, size).

    Raises:
        ArithmeticError: the method gave up, collisions do not come to an end, or one was missed.
    """
    stops = system.stops(float(time[-1]))
    bodies, y, t = Colliding(system), system.initial(initial), 0.0
    states = np.empty((len(time), system.size))
    states[time == 0.0] = y
    absolute = rtol * system.scales(initial)
    near = [p for p in bodies.pairs if bodies.gap(p, y) <= MARGIN and not bodies.approach(p, y)]
    if not stops:
        return states
    bodies.system = system.between(t, stops[0])
    y, joined = bodies.settle(t, y, near)
    for _ in range(MOST_EVENTS):
        fastest = max(system.profile.top, float(np.abs(y[bodies.first + bodies.count :]).max()))

        def solve(end: float, t: float = t, y: Array = y, joined: Sequence[Pair] = tuple(joined),
                  longest: float = LONGEST / fastest) -> OptimizeResult:  # fmt: skip
            return solve_ivp(
                lambda t, y: bodies.rhs(t, y, joined), (t, end), y, method,
                events=_events(bodies, joined), rtol=rtol, atol=absolute, dense_output=True,
                max_step=longest, first_step=min([end - t, longest, *bodies.closing(y)]),
            )  # fmt: skip

        solved = solve(stops[0])
        dip = _first_dip(bodies, joined, solved)
        if dip is not None:  # it closed and opened within a step: stop between the two
            solved = solve(dip)
        if not solved.success:
            raise ArithmeticError(f"{method} stopped after {solved.t[-1]:g} s: {solved.message}")
        wanted = (time > t) & (time <= solved.t[-1])
        if wanted.any():
            states[wanted] = solved.sol(time[wanted]).T
        t, y = float(solved.t[-1]), solved.y[:, -1]
        if any(bodies.gap(pair, y) < -OVERLAP for pair in bodies.pairs):
            raise ArithmeticError(f"weights pass through each other before {t:g} s")
        if t == stops[0] and solved.status == 0:
            if not (stops := stops[1:]):
                return states
            bodies.system = system.between(t, stops[0])
            y, joined = bodies.settle(t, y, joined)
            continue
        happened = [i for i, times in enumerate(solved.t_events) if len(times)]
        y, joined = _after(bodies, t, y, joined, happened)
    raise ArithmeticError(f"more than {MOST_EVENTS} collisions and openings by {t:g} s")


def _first_dip(bodies: Colliding, joined: Sequence[Pair], solved: OptimizeResult) -> float | None:
    """First time at which the gap of a pair not joined is smallest and below zero [s]."""
    dips = []
    for pair in [pair for pair in bodies.pairs if pair not in joined]:

        def closing(t: float, pair: Pair = pair) -> float:
            return bodies.approach(pair, solved.sol(t))

        signs = np.sign([closing(t) for t in solved.t])
        for k in np.flatnonzero((signs[:-1] > 0.0) & (signs[1:] < 0.0)):
            lowest = brentq(closing, solved.t[k], solved.t[k + 1], xtol=1e-300, rtol=1e-15)
            if bodies.gap(pair, solved.sol(lowest)) < -MARGIN:
                dips.append(lowest)
    return min(dips, default=None)


def _events(bodies: Colliding, joined: Sequence[Pair]) -> list:
    """A gap that closes, by pair; for those joined, a push that turns into a pull."""
    events = []
    for pair in bodies.pairs:
        if pair in joined:
            place = joined.index(pair)

            def event(t: float, y: Array, place: int = place) -> float:
                return float(bodies.pushes(t, y, joined)[0][place])
        else:

            def event(t: float, y: Array, pair: Pair = pair) -> float:  # type: ignore[misc]
                return bodies.gap(pair, y) + MARGIN

        event.terminal, event.direction = True, -1  # type: ignore[attr-defined]
        events.append(event)
    return events


def _after(
    bodies: Colliding, t: float, y: Array, joined: list[Pair], happened: Sequence[int]
) -> tuple[Array, list[Pair]]:
    """State and contacts after the events of these pairs."""
    opened = [bodies.pairs[i] for i in happened if bodies.pairs[i] in joined]
    closed = [bodies.pairs[i] for i in happened if bodies.pairs[i] not in joined]
    if not closed:
        return y, [pair for pair in joined if pair not in opened]
    # a pair that touches and parts may approach again by the impacts of others
    touching = [
        pair
        for pair in bodies.pairs
        if pair in joined or pair in closed or bodies.gap(pair, y) <= MARGIN
    ]
    y = bodies.collide(t, y, touching)
    return bodies.settle(t, y, touching)
