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
from typing import Any

import numpy as np
from scipy.linalg import solve_triangular
from scipy.optimize import OptimizeResult, brentq, nnls

from ..arrays import Array
from ..assembly import weights_of
from .coupled import Monolith, Start
from .driven import Driven
from .phases import LONGEST, solve_to_event

Pair = tuple[int, int, float, float]  # two neighbours, distance of touching, turns between them
MARGIN = 1e-12  # rad: a gap this far below zero is closed, so that rounding closes none; a slow
# closing is late by MARGIN over its speed
OVERLAP = 2e-10  # rad: what the integration may leave of a contact that lasts
SHIFTS = 8  # each halves what gaps of a chain of weights are off
LOWEST = 1e-9  # rad: a bounce that would rise less ends in contact
MOST_IMPACTS = 100  # at one time, each of which ends or turns round what approaches


class Colliding:
    """Contacts of the weights of a `Monolith`, or of those that a motor drives."""

    def __init__(self, system: Monolith | Driven) -> None:
        """Find who is beside whom on every track where weights can meet."""
        self.system: Any = system
        self.first = 4 * system.stations
        self.count = system.weights
        self.pairs: list[Pair] = []
        self.restitution: dict[Pair, float] = {}
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
            begin += n

    def gap(self, pair: Pair, y: Array) -> float:
        """Angle between the surfaces of two neighbours [rad]."""
        a, b, touching, turns = pair
        return float(y[self.first + b] - y[self.first + a]) + turns - touching

    def rates(self, y: Array) -> Array:
        """Of the weights' angles in a state, (N,), a view [rad/s]."""
        begin = self.first + self.count
        return y[begin : begin + self.count]

    def approach(self, pair: Pair, y: Array) -> float:
        """Rate at which a gap closes [rad/s]."""
        rates = self.rates(y)
        return float(rates[pair[0]] - rates[pair[1]])

    def closing(self, t: float, y: Array, joined: Sequence[Pair]) -> list[float]:
        """Times in which gaps may close [s], so that no first step goes beyond.

        A gap that closes would be as far below 0 as it is above.  One that opens may come back:
        u t = p t^2 / 2 for weights that part by u and are pressed together by p.
        """
        turned = self.accelerations(t, y, joined)[1]
        found = []
        for pair in self.pairs:
            gap, rate = self.gap(pair, y) + MARGIN, self.approach(pair, y)
            pressed = float(turned[pair[0]] - turned[pair[1]])
            if gap > 0.0 and rate > 0.0:
                found.append(2.0 * gap / rate)
            elif pair not in joined and rate < 0.0 and pressed > 0.0:
                found.append(-2.0 * rate / pressed)
        return found

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
        pushed = rows / self.system.lagrange.turned_inertia
        return pushed, rows @ (self.system.accelerations(t, y, pushed)[1] - free).T

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
        still = self.system.array_rhs(t, y)
        moved = self.system.array_rhs(t, y, held)
        return np.asarray(y + (moved - still))

    def accelerations(self, t: float, y: Array, joined: Sequence[Pair]) -> tuple[Array, ...]:
        """Of stations (2, n) and weights (N,), and of the shaft where a motor drives it."""
        a, phi2, *shaft = self.system.accelerations(t, y, self.pushes(t, y, joined)[1])
        return a, _in_step(phi2, joined), *shaft

    def rhs(self, t: float, y: Array, joined: Sequence[Pair]) -> Array:
        """Derivative of the state, (size,), with contacts that last."""
        found = np.asarray(self.system.array_rhs(t, y, self.pushes(t, y, joined)[1]))
        _in_step(self.rates(found), joined)
        return found

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
            rates = self.rates(y)
            opening = np.array([rates[b] - rates[a] for a, b, *_ in touching])
            if opening.min() >= -1e-13 * np.abs(rates).max():
                return y
            right = solve_triangular(factor, (1.0 + e) * opening, trans="T")
            impulses = nnls(factor, -right)[0]
            y = self.after_impact(t, y, impulses @ pushed)
        raise ArithmeticError(f"impacts at {t:g} s do not come to an end")

    def settled(self, t: float, y: Array, touching: Sequence[Pair]) -> tuple[Array, list[Pair]]:
        """After a collision: bounces too low are ended, and contacts that would pull left out."""
        joined = list(touching)
        free = self.system.accelerations(t, y)[1]
        for pair in touching:
            pressed = free[pair[0]] - free[pair[1]]
            apart = max(0.0, -self.approach(pair, y))
            if apart * apart > 2.0 * LOWEST * max(pressed, 0.0):
                joined.remove(pair)
        if joined:  # what bounces no more has given its momentum to the rotor
            rates = self.rates(y)
            y = self.after_impact(t, y, self._against(t, y, joined, rates, free)[1])
        y = y.copy()
        phi, rates = y[self.first : self.first + self.count], self.rates(y)
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

    def begin(self, start: Start) -> tuple[Array, list[Pair]]:
        """State at time 0, and neighbours that touch and do not approach each other."""
        y = self.system.initial(start)
        near = [p for p in self.pairs if self.gap(p, y) <= MARGIN and not self.approach(p, y)]
        return y, near

    def scales(self, start: Start) -> Array:
        """Typical size of each part of the state."""
        return self.system.scales(start)

    def fastest(self, y: Array) -> float:
        """Fastest turning [rad/s], which limits a step."""
        return max(self.system.top, float(np.abs(self.rates(y)).max()))

    def watched(self, t: float, y: Array, joined: Sequence[Pair]) -> Array:
        """Of joined neighbours the push, of others the gap: what falls through 0 at an event."""
        pushes = dict(zip(joined, self.pushes(t, y, joined)[0].tolist(), strict=True))
        return np.array([pushes[p] if p in pushes else self.gap(p, y) + MARGIN for p in self.pairs])

    def solve(
        self, t: float, end: float, y: Array, joined: Sequence[Pair], **options: Any
    ) -> OptimizeResult:
        """The motion up to the next event.

        Raises:
            ArithmeticError: a collision was missed.
        """
        longest = LONGEST / self.fastest(y)
        first = min([end - t, longest, *self.closing(t, y, joined)])
        found = solve_to_event(self, t, end, y, joined, first_step=first, **options)
        dip = self._first_dip(joined, found)
        if dip is not None:  # it closed and opened within a step: stop between the two
            first = min(first, dip - t)
            found = solve_to_event(self, t, dip, y, joined, first_step=first, **options)
        if any(self.gap(pair, found.y[:, -1]) < -OVERLAP for pair in self.pairs):
            raise ArithmeticError(f"weights pass through each other before {found.t[-1]:g} s")
        return found

    def _first_dip(self, joined: Sequence[Pair], solved: OptimizeResult) -> float | None:
        """First time at which the gap of a pair not joined is smallest and below zero [s]."""
        dips = []
        for pair in [pair for pair in self.pairs if pair not in joined]:

            def closing(t: float, pair: Pair = pair) -> float:
                return self.approach(pair, solved.sol(t))

            signs = np.sign([closing(t) for t in solved.t])
            for k in np.flatnonzero((signs[:-1] > 0.0) & (signs[1:] < 0.0)):
                lowest = brentq(closing, solved.t[k], solved.t[k + 1], xtol=1e-300, rtol=1e-15)
                if self.gap(pair, solved.sol(lowest)) < -MARGIN:
                    dips.append(lowest)
        return min(dips, default=None)

    def after(
        self, t: float, y: Array, joined: list[Pair], happened: Sequence[int]
    ) -> tuple[Array, list[Pair]]:
        """State and contacts after the events of these pairs."""
        opened = [self.pairs[i] for i in happened if self.pairs[i] in joined]
        closed = [self.pairs[i] for i in happened if self.pairs[i] not in joined]
        if not closed:
            return y, [pair for pair in joined if pair not in opened]
        # a pair that touches and parts may approach again by the impacts of others
        touching = [
            pair
            for pair in self.pairs
            if pair in joined or pair in closed or self.gap(pair, y) <= MARGIN
        ]
        y = self.collide(t, y, touching)
        return self.settled(t, y, touching)


def _in_step(values: Array, joined: Sequence[Pair]) -> Array:
    """Values of the weights, in place: of a run equal but for rounding, which adds up in a long
    contact."""
    for run in _runs(joined):
        values[run] = values[run].mean()
    return values


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
