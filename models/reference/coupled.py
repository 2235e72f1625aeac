"""A rotor that turns at given speeds and its balancers as one ordinary differential equation.

For one station, where it is several times faster, the weights' equations

    phi'' = -d (phi' - w) + f w' + (x'' sin phi - y'' cos phi)/(kappa R),
    d = b/(kappa m),    f = (kappa - 1)(1 + r/R)/kappa,

are put into the force: N weights leave the mass N m 1 - (m/kappa) sum [[s^2, -s c], [-s c, c^2]]
(s, c = sin phi, cos phi), which turns with them and is solved for at each evaluation.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ..arrays import Array
from ..assembly import Assembly, SpeedProfile, Start, weights_of
from ..restraints import at_rest
from .lagrange import Lagrange

Turning = tuple[Array, Array, Array]  # angle, speed and angular acceleration of the rotor
RightHandSide = Callable[[float, Array], "Array | list[float]"]


REST = Start()


class Monolith:
    """The coupled equations of `assembly` driven with `profile`.

    The state, (4 n + 2 N,) for n stations and N weights of all balancers in their order, is
    (x, y, vx, vy, phi, phi').  `rhs(t, y)` is its derivative: in plain numbers for one station,
    where it is several times faster, else in arrays.  Both are the same equations.
    """

    def __init__(self, assembly: Assembly, profile: SpeedProfile, angle: float = 0.0) -> None:
        """Set up the matrices; `angle` [rad] is the rotor's at time 0."""
        self.lagrange = Lagrange(assembly)
        rotor = self.lagrange.rotor
        self.assembly, self.profile, self.angle = assembly, profile, angle
        self.stations, self.weights = rotor.stations, self.lagrange.weights
        self._devices = [one for m in assembly.weights for one in weights_of(m).each]
        plain = self.stations == 1 and bool((rotor.planes == 1.0).all())
        plain = plain and not rotor.gyroscopic.any() and not self.lagrange.offset.any()
        plain = plain and self.lagrange.round
        plain = plain and not (rotor.crossed or rotor.waves or self.lagrange.tables)
        if rotor.stops:
            raise ValueError("stops: the reference has no stops")
        plain = plain and not rotor.cubics
        self.rhs: RightHandSide = self.scalar_rhs() if plain else self.array_rhs

    @property
    def top(self) -> float:
        """Fastest turning of the profile [rad/s]."""
        return self.profile.top

    @property
    def size(self) -> int:
        """Length of the state, 4 n + 2 N."""
        return 4 * self.stations + 2 * self.weights

    def turning(self, time: Array, _states: Array) -> Turning:
        """How the rotor turns at `time` (T,), each (T,) [rad, rad/s, rad/s^2]."""
        profile = self.profile
        angle, speed, change = np.array(
            [(profile.angle(t), profile.speed(t), profile.acceleration(t)) for t in time]
        ).T
        return self.angle + angle, speed, change

    def initial(self, start: Start = REST) -> Array:
        """State at time 0, (size,): at rest in the sag unless `start` says otherwise."""
        loaded, speed = self.assembly.loaded_rotor, self.profile.speed(0.0)
        sag = at_rest(loaded, speed).sag if loaded.cubics else loaded.rest_position(speed)
        waves = len(self.assembly.rings)  # which begin at rest
        own = self.stations - waves
        parts = [
            np.pad(np.broadcast_to(np.asarray(value, float), own), (0, waves)) + rest
            for value, rest in zip(
                (start.x, start.y, start.vx, start.vy), (*sag, 0.0, 0.0), strict=True
            )
        ]
        angles: list[float] = []
        rates: list[float] = []
        for m in self.assembly.weights:
            angles += m.angles
            rates += m.speeds or (0.0,) * len(m.angles)
        phi = np.array(angles) + start.angle
        return np.concatenate([*parts, phi, np.array(rates) + self.profile.speed(0.0)])

    def scales(self, start: Start = REST) -> Array:
        """Typical size of each part of the state, (size,): what absolute tolerances refer to."""
        rotor = self.assembly.rotor
        moment = max([self.assembly.largest_unbalance, *(d.moment for d in self._devices)])
        mass = float(np.abs(np.linalg.eigvalsh(self.assembly.loaded_rotor.mass)).max())
        speed = self.profile.top
        state = np.abs(self.initial(start))
        n = self.stations
        length = max(moment / mass, float(state[: 2 * n].max()))
        if rotor.gravity:
            length = max(length, float(np.abs(self.assembly.loaded_rotor.sag(speed)).max()))
        length = length or 1.0
        velocity = max(length * speed, float(state[2 * n : 4 * n].max())) or length
        ones = np.ones(self.weights)
        turning = max([speed, *state[4 * n + self.weights :]]) or 1.0
        lateral = np.repeat([length, velocity], 2 * n)
        return np.concatenate([lateral, ones, turning * ones])

    def accelerations(
        self, t: float, y: Array, push: Array | float = 0.0, force: Array | float = 0.0
    ) -> tuple[Array, Array]:
        """As `accelerations_of`, at time `t` [s]."""
        profile = self.profile
        turning = self.angle + profile.angle(t), profile.speed(t), profile.acceleration(t)
        return self.accelerations_of(turning, y, push, force)

    def accelerations_of(
        self,
        turning: Turning | tuple[float, float, float],
        y: Array,
        push: Array | float = 0.0,
        force: Array | float = 0.0,
    ) -> tuple[Array, Array]:
        """x'' and y'' of the stations, (..., 2, n) [m/s^2], and phi'' of the weights, (..., N)
        [rad/s^2], of states (..., size) while the rotor turns so: numbers, or columns (..., 1).

        Args:
            push: what else would accelerate each weight along its track on a rotor that is held,
                (..., N) [rad/s^2].
            force: what else pushes the stations along x, then along y, (..., 2 n) [N].
        """
        (angle, w, w1), lateral, rotor = turning, 2 * self.stations, self.lagrange.rotor
        inertia, own = self.lagrange(angle, w, y)
        own = own[..., :-1] - inertia[..., :-1, -1] * w1
        trials = own.shape[:-1]
        if np.ndim(push) or np.ndim(force):
            trials = np.broadcast_shapes(trials, np.shape(push)[:-1], np.shape(force)[:-1])
        right = np.broadcast_to(own, (*trials, own.shape[-1])).copy()
        right[..., :lateral] += force
        right[..., lateral:] += push * self.lagrange.turned_inertia
        found = np.asarray(np.linalg.solve(inertia[..., :-1, :-1], right[..., None]), float)[..., 0]
        a = found[..., :lateral].reshape(*trials, 2, -1)
        field = np.full(self.stations, rotor.gravity)
        field[[at for at, _ in rotor.waves]] = 0.0
        return a + np.array([field.real, field.imag]), found[..., lateral:]

    def array_rhs(self, t: float, y: Array, push: Array | float = 0.0) -> Array:
        """Derivative of the state, (size,), for any number of stations and planes."""
        n = self.stations
        a, phi2 = self.accelerations(t, y, push)
        return np.concatenate([y[2 * n : 4 * n], a.ravel(), y[4 * n + self.weights :], phi2])

    def scalar_rhs(self) -> RightHandSide:
        """Right-hand side of one station in plain numbers: no arrays, nothing looked up inside.

        Run times of the monolith are compared with this one.
        """
        rotor = self.assembly.rotor
        bare = float(rotor.mass[0, 0] + self.assembly.added_mass.sum())
        k_x, k_y = float(rotor.stiffness_x[0, 0]), float(rotor.stiffness_y[0, 0])
        inner, start = float(rotor.internal_damping[0, 0]), self.angle
        c_x, c_y = float(rotor.damping_x[0, 0]) + inner, float(rotor.damping_y[0, 0]) + inner
        u, u_angle = abs(complex(rotor.unbalance[0])), float(np.angle(rotor.unbalance[0]))
        g_x, g_y = rotor.gravity.real, rotor.gravity.imag
        rows = [
            (d.moment, d.mass / d.kappa, d.damping_rate, 1.0 / (d.kappa * d.track_radius),
             (1.0 - 1.0 / d.kappa) * (1.0 + d.radius / d.track_radius))
            for d in self._devices
        ]  # fmt: skip
        first_rate, profile = 4 + len(rows), self.profile
        steady, w = not profile.changes, profile.end
        start_of_steady = start - w * profile.times[0]
        sin, cos = math.sin, math.cos

        def rhs(t: float, y: Array) -> list[float]:
            state = y.tolist()
            x, yy, v_x, v_y = state[:4]
            if steady:
                speed, turned = w, start_of_steady + w * t + u_angle
            else:
                speed, turned = profile.speed(t), start + profile.angle(t) + u_angle
            c, s, pull, swirl = cos(turned), sin(turned), u * speed * speed, inner * speed
            f_x = pull * c - c_x * v_x - k_x * x - swirl * yy
            f_y = pull * s - c_y * v_y - k_y * yy + swirl * x
            if not steady:
                w1 = profile.acceleration(t)
                f_x += u * w1 * s
                f_y -= u * w1 * c
            else:
                w1 = 0.0
            m_xx = m_yy = bare
            m_xy = 0.0
            rates = state[first_rate:]
            held = []
            for phi, rate, (moment, share, drag, lever, follow) in zip(
                state[4:first_rate], rates, rows, strict=True
            ):
                c, s, square = cos(phi), sin(phi), rate * rate
                slip = drag * (rate - speed) - follow * w1
                m_xx -= share * s * s
                m_yy -= share * c * c
                m_xy += share * s * c
                f_x += moment * (square * c - slip * s)
                f_y += moment * (square * s + slip * c)
                held.append((lever * s, lever * c, slip))
            scale = 1.0 / (m_xx * m_yy - m_xy * m_xy)
            a_x = (m_yy * f_x - m_xy * f_y) * scale
            a_y = (m_xx * f_y - m_xy * f_x) * scale
            return [
                v_x, v_y, a_x + g_x, a_y + g_y, *rates,
                *[a_x * s - a_y * c - slip for s, c, slip in held],
            ]  # fmt: skip

        return rhs

    @property
    def dry(self) -> bool:
        """Whether anything can stick: weights with resistance, sliders in the supports."""
        resist = any(m.rolling_resistance for m in self.assembly.weights)
        return resist or bool(self.assembly.rotor.sliders)

    @property
    def fastest_vibration(self) -> float:
        """Largest modulus of an eigenvalue of the rotor [1/s]."""
        from ..linear.modes import modes  # a scene's start loads this module, and no SciPy

        return float(max(modes(self.assembly.loaded_rotor, self.profile.end).natural_frequencies))

    @property
    def fastest_mode(self) -> float:
        """Of the rotor's eigenvalues and the weights' drag [1/s]."""
        return max([self.fastest_vibration, *(d.damping_rate for d in self._devices)])

    def stops(self, end: float) -> list[float]:
        """Times up to which the motion is smooth [s]: at corners and changes a force jumps."""
        jumps = {*self.profile.times, *(time for time, _ in self.assembly.later)}
        return [*sorted(t for t in jumps if 0.0 < t < end), *([end] if end else [])]

    def after(self, time: float) -> Monolith:
        """The same with the unbalance from `time` [s] on."""
        later = self.assembly.later
        return Monolith(self.assembly.at(time), self.profile, self.angle) if later else self

    def between(self, begin: float, stop: float) -> Monolith:
        """The same up to `stop`, where the profile's acceleration is the one before it."""
        profile, beyond = self.profile, 2.0 * stop - begin
        low, slope = profile.speed(begin), profile.acceleration(begin)
        line = SpeedProfile((begin, beyond), (low, low + slope * (beyond - begin)))
        return Monolith(self.assembly.at(begin), line, self.angle + profile.angle(begin))
