"""Inertia and forces of a rotor, its weights and its shaft, by Lagrange's equations.

Formulated apart from the units, which work in the rotor frame and split the force: here the axes
are fixed, the weights' angles phi absolute, and the shaft's angle is one more coordinate, which a
speed profile prescribes or a motor drives.  Filimonikhina 2017 (4) with the liquid of Dubovik 2006
(3) and the w' terms of (5), and the shaft's row.  The wave of a ring part filled with liquid is one
more station.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..assembly import Assembly, weights_of
from ..race import path
from ..weights import Weights


class _Place(NamedTuple):
    """On a race: rho, rho' and rho'', l = |rho' + i rho| and l'; each (..., N) [m]."""

    rho: Array
    slope: Array
    bend: Array
    length: Array
    stretched: Array


class Lagrange:
    """I q'' = f of an assembly, q = (x, y, phi, angle of the shaft), 2 n + N + 1 of them.

    n stations; N weights of all balancers, in their order.  Gravity is not in f: it acts as if
    everything were accelerated against it.
    """

    def __init__(self, assembly: Assembly) -> None:
        rotor = assembly.with_waves(assembly.rotor)
        self.tables = rotor.tables[1]
        self.speeds = rotor.tables[0]
        self.rotor = rotor = rotor.without_tables
        n = rotor.stations
        each = [(m, one) for m in assembly.weights for one in weights_of(m).each]
        self.weights = len(each)
        self.mass, self.radius, drag, kappa, size = np.array(
            [(d.mass, d.track_radius, d.drag, d.kappa, d.radius) for _, d in each]
        ).reshape(-1, 5).T  # fmt: skip
        square = self.mass * self.radius**2
        self.races = [one.race for _, one in each]
        self.round = not any(self.races)
        self.rolling, self.size, self.slowing = (kappa - 1.0) * self.mass, size, drag
        self.offset = np.array([m.offset for m, _ in each], complex)
        self.turned_inertia = kappa * square
        self.drag = drag * self.radius**2
        liquids = tuple(m for m in assembly.balancers if not isinstance(m.device, Weights))
        loaded = replace(assembly, balancers=liquids).loaded_rotor.mass
        turns = np.hstack([np.zeros((self.weights, 2 * n)), np.eye(self.weights)])
        # a body that rolls turns by (1 + r/R) w - phi', times R/r; kappa - 1 = J/(m r^2)
        rolls = np.hstack([turns, -1.0 - (size / self.radius)[:, None]])
        self.inertia = rolls.T @ (((kappa - 1.0) * square)[:, None] * rolls) * float(self.round)
        self.inertia[:n, :n] = self.inertia[n : 2 * n, n : 2 * n] = loaded
        rows = rotor.planes[[m.plane for m, _ in each]].reshape(-1, n)
        self.path = np.zeros((self.weights, len(self.inertia)), complex)
        self.path[:, : 2 * n] = np.hstack([rows, 1j * rows])

    def __call__(self, angle: Array | float, w: Array | float, y: Array) -> tuple[Array, Array]:
        """I (..., D, D) and f (..., D) of states (x, y, vx, vy, phi, phi'), (..., 4 n + 2 N).

        Args:
            angle, w: of the shaft [rad, rad/s], numbers or columns (..., 1).
        """
        rotor, n, here = self.rotor, self.rotor.stations, np.arange(self.weights)
        x, yy, v_x, v_y = (y[..., j * n : (j + 1) * n] for j in range(4))
        phi, rates = y[..., 4 * n : 4 * n + self.weights], y[..., 4 * n + self.weights :]
        z, v, turn = x + 1j * yy, v_x + 1j * v_y, np.exp(1j * angle)
        centre, arm, u = self.offset * turn, self.radius * np.exp(1j * phi), rotor.unbalance * turn
        along, carried, bent = 1j * arm, 1j * centre, rates**2 * arm
        race = None if self.round else self._races(phi - angle)
        if race is not None:
            p, theta = np.exp(1j * phi), rates - w
            along, carried = (race.slope + 1j * race.rho) * p, 1j * centre - race.slope * p
            bent = p * (race.rho * rates**2 - race.bend * theta**2)
            bent = bent - 2j * p * race.slope * theta * rates
        # velocity of a weight, vx + i vy, by the velocities of the coordinates
        way = np.broadcast_to(self.path, (*y.shape[:-1], *self.path.shape)).copy()
        way[..., here, 2 * n + here], way[..., -1] = along, carried
        momentum = np.swapaxes(self.mass[:, None] * way.conj(), -1, -2)
        inertia = self.inertia + (momentum @ way).real
        inertia[..., -1, :n] -= u.imag
        inertia[..., -1, n : 2 * n] += u.real
        inertia[..., : 2 * n, -1] = inertia[..., -1, : 2 * n]
        force = (momentum @ (w * w * centre + bent)[..., None])[..., 0].real
        sheared, lag = (v - 1j * w * z) @ rotor.internal_damping.T, self.drag * (rates - w)
        if race is not None:
            lag = self.slowing * race.length**2 * (rates - w)
            # a body that rolls turns by ((l + r) w - l phi')/r
            rolls = np.zeros((*y.shape[:-1], self.weights, way.shape[-1]))
            rolls[..., here, 2 * n + here], rolls[..., -1] = race.length, -race.length - self.size
            spun = np.swapaxes(self.rolling[:, None] * rolls, -1, -2)
            inertia = inertia + spun @ rolls
            force = force - (spun @ (race.stretched * (rates - w) ** 2)[..., None])[..., 0]
        push = w * w * u - sheared + 1j * w * (v @ rotor.gyroscopic.T)
        force[..., :n] += push.real - x @ rotor.stiffness_x.T - v_x @ rotor.damping_x.T
        force[..., n : 2 * n] += push.imag - yy @ rotor.stiffness_y.T - v_y @ rotor.damping_y.T
        self._add_tables(force, w, (x, yy), (v_x, v_y))
        self._add_waves(force, w, z, v)
        self._add_springs(force, (x, yy), (v_x, v_y))
        force[..., 2 * n : -1] -= lag
        force[..., -1] += lag.sum(axis=-1) + (z.conj() * sheared).sum(axis=-1).imag
        return inertia, force

    def _add_tables(
        self, force: Array, w: Array | float, place: tuple[Array, Array], rate: tuple[Array, Array]
    ) -> None:
        """Forces (..., D) of bearings that change with the speed, by x, y and their rates."""
        n = self.rotor.stations
        for row, stiffness, damping in self.tables:
            both, rates_of_both = (np.stack([a @ row, b @ row], axis=-1) for a, b in (place, rate))
            pull = self._here(stiffness, w) @ both[..., None]
            pull = (pull + self._here(damping, w) @ rates_of_both[..., None])[..., 0]
            force[..., :n] -= pull[..., :1] * row
            force[..., n : 2 * n] -= pull[..., 1:] * row

    def _add_waves(self, force: Array, w: Array | float, z: Array, v: Array) -> None:
        """Forces (..., D) on the waves of rings of liquid, by z = x + i y and its rate (..., n)."""
        n = self.rotor.stations
        for at, ring in self.rotor.waves:
            wave, rate = z[..., at], v[..., at]
            turning = np.broadcast_to(w, (*z.shape[:-1], 1))[..., 0]
            damping = ring.wave_damping + ring.root_damping * np.sqrt(np.abs(turning))
            own = 4j * turning * rate + 2.0 * turning**2 * wave
            own = ring.wave_inertia * (own - damping * (rate - 1j * turning * wave))
            force[..., at] += own.real
            force[..., n + at] += own.imag

    def _add_springs(
        self, force: Array, place: tuple[Array, Array], rate: tuple[Array, Array]
    ) -> None:
        """Forces (..., D) of cubic springs, and of cross terms of the supports."""
        rotor, n, (x, y), (v_x, v_y) = self.rotor, self.rotor.stations, place, rate
        for spring in rotor.cubics:
            pull = spring.force(np.stack([x @ spring.rows[0], y @ spring.rows[1]]))
            force[..., :n] += pull[0][..., None] * spring.rows[0]
            force[..., n : 2 * n] += pull[1][..., None] * spring.rows[1]
        if rotor.crossed:
            (_, k_xy), (k_yx, _) = rotor.springs
            (_, c_xy), (c_yx, _) = rotor.dampers
            force[..., :n] -= y @ k_xy.T + v_y @ c_xy.T
            force[..., n : 2 * n] -= x @ k_yx.T + v_x @ c_yx.T

    def _races(self, theta: Array) -> _Place:
        """Where weights at angles (..., N) in the rotor are on races that are not round."""
        columns = [
            path(radius, lobes, theta[..., k])
            for k, (radius, lobes) in enumerate(zip(self.radius, self.races, strict=True))
        ]
        rho, slope, bend, _ = (np.stack(column, axis=-1) for column in zip(*columns, strict=True))
        length = np.hypot(slope, rho)
        stretched = slope * (bend + rho) / length
        return _Place(rho, slope, bend, length, stretched)

    def _here(self, rows: Array, w: Array | float) -> Array:
        """A bearing's (..., 2, 2) at speeds (..., 1) from the rows (r, 2, 2) of its table."""
        at = np.asarray(w, float)
        found = [np.interp(at, self.speeds, rows[:, i, j]) for i in (0, 1) for j in (0, 1)]
        return np.stack(found, axis=-1).reshape(*at.shape[:-1], 2, 2)
