"""What a time run of an assembly leaves behind: states over time, and every signal by its name."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..assembly import Assembly, Mounted
from ..liquid import Liquid
from ..race import arms, path
from ..ring import Ring
from ..weights import Weights

_INDEXED = re.compile(r"(?:(station|plane|weight)\[(\d+)\]\.)?(\w+)")
_STILL = 1e-6  # a range below this part of the largest of its kind is no scale of its own


@dataclass(frozen=True, eq=False)
class Trajectory:
    """States of an assembly at T times.

    Attributes:
        assembly: whose motion it is.
        time: (T,) [s].
        x, y, vx, vy: (T, n) stations in fixed axes [m, m/s]; the waves of rings stand behind them.
        angle, speed, angular_acceleration: (T,) of the rotor [rad, rad/s, rad/s^2].
        theta, angle_rate: by balancer, (T, N) angles of the weights in the rotor [rad] and their
            rates [rad/s].
        ax, ay: (T, n) accelerations of the stations [m/s^2].
        angle_acceleration: by balancer, (T, N) second derivatives of theta [rad/s^2].
    """

    assembly: Assembly
    time: Array
    x: Array
    y: Array
    vx: Array
    vy: Array
    angle: Array
    speed: Array
    angular_acceleration: Array
    ax: Array
    ay: Array
    theta: dict[str, Array] = field(default_factory=dict)
    angle_rate: dict[str, Array] = field(default_factory=dict)
    angle_acceleration: dict[str, Array] = field(default_factory=dict)

    @property
    def bending(self) -> Array:
        """Largest modulus of the shaft's deflections, (T,) [m]."""
        rows = self.assembly.rotor.deflection.T
        return np.abs((self.x + 1j * self.y)[:, : len(rows)] @ rows).max(axis=1)

    def wave(self, balancer: str) -> NDArray[np.complex128]:
        """y of a ring's liquid in the rotor frame, (T,) [m]."""
        column = self.assembly.rotor.stations + self._number(balancer)
        return (self.x[:, column] + 1j * self.y[:, column]) * np.exp(-1j * self.angle)

    def wave_rate(self, balancer: str) -> NDArray[np.complex128]:
        """Its derivative as the turning rotor sees it, (T,) [m/s]."""
        column = self.assembly.rotor.stations + self._number(balancer)
        rate = (self.vx[:, column] + 1j * self.vy[:, column]) * np.exp(-1j * self.angle)
        return rate - 1j * self.speed * self.wave(balancer)

    def moment(self, balancer: str) -> NDArray[np.complex128]:
        """Static moment of a balancer's weights in the rotor, (T,) [kg m]."""
        mounted = self._mounted(balancer)
        device = mounted.device
        assert isinstance(device, Weights)
        masses, theta = np.array([one.mass for one in device.each]), self.theta[balancer]
        moment: NDArray[np.complex128] = (arms(device, theta) * np.exp(1j * theta)) @ masses
        return moment + masses.sum() * mounted.offset

    def plane_acceleration(self, plane: int) -> NDArray[np.complex128]:
        """Acceleration of a plane (from 0), less gravity, in the rotor frame, (T,) [m/s^2]."""
        rotor = self.assembly.rotor
        a = (self.ax + 1j * self.ay)[:, : rotor.stations]
        fixed = a @ rotor.planes[plane] - rotor.gravity
        return fixed * np.exp(-1j * self.angle)

    def force(self, balancer: str) -> NDArray[np.complex128]:
        """Force of a balancer beyond its added mass, in the rotor frame, (T,) [N].

        The weights' part of F in Filimonikhina 2017 (4), sum m R (phi'^2 - i phi'') e^{i theta}.
        """
        mounted = self._mounted(balancer)
        device = mounted.device
        if isinstance(device, Liquid):
            return np.zeros(len(self.time), complex)
        if isinstance(device, Ring):  # 0 = (1 + f) y'' + A + ..., F = -m_L (A + f y'')
            column = self.assembly.rotor.stations + self._number(balancer)
            second = (self.ax[:, column] + 1j * self.ay[:, column]) * np.exp(-1j * self.angle)
            pulled = self.plane_acceleration(mounted.plane) + device.hollow * second
            return (
                device.added_mass * self.plane_acceleration(mounted.plane)
                - device.liquid_mass * pulled
            )
        theta, theta1 = self.theta[balancer], self.angle_rate[balancer]
        theta2 = self.angle_acceleration[balancer]
        phi1, phi2 = theta1 + self.speed[:, None], theta2 + self.angular_acceleration[:, None]
        masses = np.array([one.mass for one in device.each])
        rho, slope, bend, _ = path(device.track_radius, device.race, theta)
        pulls = rho * (phi1**2 - 1j * phi2)
        pulls -= bend * theta1**2 + slope * (theta2 + 2j * theta1 * phi1)
        whirl = self.speed**2 - 1j * self.angular_acceleration
        return (pulls * np.exp(1j * theta)) @ masses + masses.sum() * mounted.offset * whirl

    def signal(self, name: str) -> Array:
        """A signal over time, (T,), by the name the units give it.

        `rotor.x`, `rotor.station[2].vy`, `rotor.plane[1].a_xi`, `rotor.bending`,
        `weights.weight[1].angle`, `weights.moment_xi`, `motor.speed`, `liquid.clearance`; indices
        from 1.

        Raises:
            KeyError: there is no such signal; the message names those there are.
        """
        owner, _, rest = name.partition(".")
        match = _INDEXED.fullmatch(rest)
        values = None
        if match:
            kind, index, what = match[1], int(match[2] or 1) - 1, match[3]
            if owner == "motor" and rest == "speed":
                values = self.speed
            elif owner == "rotor":
                values = self._rotor_signal(kind, index, what)
            elif any(m.name == owner for m in self.assembly.balancers):
                values = self._balancer_signal(self._mounted(owner), kind, index, what)
        if values is None:
            raise KeyError(f"{name}: no such signal; there are {', '.join(self.names())}")
        return values

    __getitem__ = signal

    def names(self) -> list[str]:
        """Names of the state signals: displacements, velocities, weights' angles and rates."""
        stations = self.assembly.rotor.stations
        places = [""] if stations == 1 else [f"station[{j + 1}]." for j in range(stations)]
        names = [f"rotor.{place}{what}" for place in places for what in ("x", "y", "vx", "vy")]
        for mounted in self.assembly.rings:
            for what in ("wave", "wave_speed"):
                names += [f"{mounted.name}.{what}_{axis}" for axis in ("xi", "eta")]
        for mounted in self.assembly.weights:
            for k in range(self.theta[mounted.name].shape[1]):
                names += [f"{mounted.name}.weight[{k + 1}].{what}" for what in ("angle", "speed")]
        return names

    def _mounted(self, balancer: str) -> Mounted:
        return next(m for m in self.assembly.balancers if m.name == balancer)

    def _number(self, ring: str) -> int:
        return [m.name for m in self.assembly.rings].index(ring)

    def _rotor_signal(self, kind: str | None, index: int, what: str) -> Array | None:
        if kind is None and what in ("angle", "speed", "bending"):
            return getattr(self, what)
        stations, planes = self.assembly.rotor.stations, self.assembly.rotor.plane_count
        station = kind == "station" or (kind is None and stations == 1)
        if station and 0 <= index < stations and what in ("x", "y", "vx", "vy"):
            return getattr(self, what)[:, index]
        if kind == "plane" and 0 <= index < planes:
            if what in ("x", "y"):
                return getattr(self, what)[:, :stations] @ self.assembly.rotor.planes[index]
            if what in ("a_xi", "a_eta"):
                return _part(self.plane_acceleration(index), what)
        return None

    def _balancer_signal(
        self, mounted: Mounted, kind: str | None, index: int, what: str
    ) -> Array | None:
        device, name = mounted.device, mounted.name
        if kind is None and what in ("F_xi", "F_eta"):
            return _part(self.force(name), what)
        if isinstance(device, Liquid):
            if kind is None and what == "clearance":
                row = self.assembly.rotor.planes[mounted.plane]
                shift = (self.x + 1j * self.y)[:, : len(row)] @ row
                return device.gap - np.abs(shift)
            return None
        if isinstance(device, Ring):
            return self._ring_signal(name, device, kind, what)
        if kind == "weight" and 0 <= index < device.count and what in ("angle", "speed"):
            return (self.theta if what == "angle" else self.angle_rate)[name][:, index]
        if kind is None and what in ("moment_xi", "moment_eta"):
            return _part(self.moment(name), what)
        if kind is None and what == "spread":
            return np.abs(np.exp(2j * self.theta[name]).mean(axis=1))
        return None

    def _ring_signal(self, name: str, ring: Ring, kind: str | None, what: str) -> Array | None:
        if kind is not None:
            return None
        if what == "thinness":
            return (1.0 - ring.hollow) * np.abs(self.wave(name)) / ring.gap
        stem, _, axis = what.rpartition("_")
        if axis not in ("xi", "eta") or stem not in ("wave", "wave_speed", "moment"):
            return None
        if stem == "moment":
            return _part(ring.wave_inertia * self.wave(name), what)
        return _part(self.wave(name) if stem == "wave" else self.wave_rate(name), what)


def _part(value: NDArray[np.complex128], name: str) -> Array:
    return value.real if name.endswith("_xi") else value.imag


def differences(reference: Trajectory, other: Trajectory) -> dict[str, float]:
    """Largest difference of every state signal, relative to the signal's range in `reference`.

    A signal that stands still has no range: one whose range is below 1e-6 of the largest of its
    kind (displacements, velocities, angles, rates) is measured by 1e-6 of that largest range.
    """
    names = reference.names()
    reach = {name: float(np.ptp(reference.signal(name))) for name in names}
    largest: dict[str, float] = {}
    for name in names:
        kind = _kind(name)
        largest[kind] = max(largest.get(kind, 0.0), reach[name])
    gaps = {}
    for name in names:
        gap = float(np.abs(other.signal(name) - reference.signal(name)).max())
        scale = max(reach[name], _STILL * largest[_kind(name)])
        gaps[name] = gap / scale if gap > 0.0 and scale > 0.0 else gap
    return gaps


def _kind(name: str) -> str:
    what = name.rpartition(".")[2]
    return {"x": "length", "y": "length", "vx": "velocity", "vy": "velocity"}.get(what, what)
