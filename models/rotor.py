"""A rotor on viscous-elastic supports as one linear system.

    M q'' + (C + C_i - w G J) q' + (K - w C_i J) q = u (w^2 - i w') e^{i beta} + S^T F + M g

with gravity g at every station, where J turns x into y and y into -x.  Every station is a
displacement: of a point of the shaft, of the axis of a tilting disc, or of another body.
Filimonikhina 2017 (4), Dubovik 2006 (5), Polushkin 2016 and Filimonikhin 2011 (1) all describe a
rotor of this form, without gravity; they differ only in the matrices.  A ring part filled with
liquid adds the coordinate y of its wave as one more station (`models.ring`), whose equation has
terms of its own.  In complex notation
z = x + i y the equation of an isotropic rotor reads

    M z'' + (C + C_i - i w G) z' + (K - i w C_i) z = u (w^2 - i w') e^{i beta} + S^T F

and is half the size of the real one; an anisotropic rotor needs both axes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, wraps
from typing import Any, Concatenate, ParamSpec

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import rotor_kinds, rotor_matrices
from .arrays import Numbers, numbers
from .ring import Ring
from .supports import OUTSIDE, Bearing, CubicSpring, Stop, Support, summed, supported
from .supports import Slider as Slider

Matrix = NDArray[np.float64]
Parameters = ParamSpec("Parameters")


def _made_of(
    matrices: Callable[Parameters, dict[str, Any]],
) -> Callable[Concatenate[type[LinearRotor], Parameters], LinearRotor]:
    """A constructor with the parameters and the description of a kind of rotor."""

    @wraps(matrices)
    def make(
        cls: type[LinearRotor], *args: Parameters.args, **values: Parameters.kwargs
    ) -> LinearRotor:
        return cls(**matrices(*args, **values))

    return make


@dataclass(frozen=True, eq=False)
class LinearRotor:
    """Matrices and planes of a linear rotor with n stations and p correction planes.

    Attributes:
        mass: (n, n) mass matrix, the same in both axes [kg].
        elastic: (n, n) stiffness of the shaft, the same in both axes [N/m].
        supports: springs and dampers that do not turn with the shaft.
        internal_damping: (n, n) damping of the rotating shaft C_i [N s/m].
        gyroscopic: (n, n) gyroscopic matrix G, multiplied by the speed [kg].
        planes: (p, n) matrix S: displacement of the planes from that of the stations.
        unbalance: (n,) complex generalised unbalance u in the rotor frame [kg m].
        deflection: (d, n) rows whose largest modulus is the shaft's bending.
        gravity: acceleration of what falls, across the axis in fixed axes, gx + i gy [m/s^2].
        sliders: dry friction in the supports.
        cubics, stops: what else holds it and is not linear.
        beside: cubic springs, stops and sliders with a free stroke that small motions about rest do
            not feel, left out of it.
        inner: how many of the stations, the last ones before waves, are inner displacements of
            rubber.
        locked: axis and station from 0 of what does not move, of bodies with one free axis.
        waves: rings of liquid that have become stations, see `with_ring`: number of the station,
            from 0, and the ring.
    """

    mass: Matrix
    elastic: Matrix
    supports: tuple[Support, ...]
    internal_damping: Matrix
    gyroscopic: Matrix
    planes: Matrix
    unbalance: NDArray[np.complex128]
    deflection: Matrix
    gravity: complex = 0j
    sliders: tuple[Slider, ...] = ()
    cubics: tuple[CubicSpring, ...] = ()
    stops: tuple[Stop, ...] = ()
    beside: tuple[CubicSpring | Stop | Slider, ...] = ()
    inner: int = 0
    locked: tuple[tuple[int, int], ...] = ()
    waves: tuple[tuple[int, Ring], ...] = ()

    @classmethod
    def planar(
        cls,
        mass: float,
        stiffness: float | Sequence[float],
        damping: float | Sequence[float] = 0.0,
        internal_damping: float = 0.0,
        unbalance: float = 0.0,
        unbalance_angle: float = 0.0,
        bearings: Sequence[Bearing] = (),
    ) -> LinearRotor:
        """Disc in one plane: Filimonikhina 2017 (4), Dubovik 2006 (5).

        Args:
            mass: disc without balancer weights or liquid [kg].
            stiffness, damping: one number, or (x, y) [N/m, N s/m].
            internal_damping: Dubovik's p, damping of the rotating shaft [N s/m].
            unbalance, unbalance_angle: static moment [kg m] and its angle in the rotor [rad].
            bearings: in place of the support's spring and damper.
        """
        k_x, k_y = np.broadcast_to(numbers(stiffness), 2)
        c_x, c_y = np.broadcast_to(numbers(damping), 2)

        def cell(value: float) -> Matrix:
            return numbers([[value]])

        return cls(
            mass=cell(mass),
            elastic=cell(0.0),
            supports=supported((0,), 1, [(k_x, k_y)], [(c_x, c_y)], bearings),
            internal_damping=cell(internal_damping),
            gyroscopic=cell(0.0),
            planes=cell(1.0),
            unbalance=np.array([unbalance * np.exp(1j * unbalance_angle)]),
            deflection=cell(1.0),
        )

    two_support = classmethod(_made_of(rotor_kinds.two_support))
    flexible = classmethod(_made_of(rotor_kinds.flexible))
    from_matrices = classmethod(_made_of(rotor_matrices.from_matrices))

    @property
    def stations(self) -> int:
        """Number n of stations."""
        return int(self.mass.shape[0])

    @property
    def plane_count(self) -> int:
        """Number p of correction planes."""
        return int(self.planes.shape[0])

    @cached_property
    def varies(self) -> bool:
        """Whether bearings change with the speed: then the matrices are those of `at` a speed."""
        return any(support.table is not None for support in self.supports)

    def at(self, speed: float) -> LinearRotor:
        """The rotor with the bearings that it has at a speed [rad/s].

        Raises:
            ValueError: a table of a bearing does not hold the speed.
        """
        if not self.varies:
            return self
        return replace(self, supports=tuple(support.at(speed) for support in self.supports))

    @property
    def at_top(self) -> LinearRotor:
        """The rotor at the highest speed of its tables; itself where it has none."""
        return self.at(self.table_speeds[1])

    @property
    def at_bottom(self) -> LinearRotor:
        """The rotor at the lowest speed of its tables; itself where it has none."""
        return self.at(self.table_speeds[0])

    @cached_property
    def without_tables(self) -> LinearRotor:
        """The rotor without the bearings that change with the speed."""
        if not self.varies:
            return self
        return replace(self, supports=tuple(each for each in self.supports if each.table is None))

    @property
    def tables(self) -> tuple[Numbers, list[tuple[Numbers, Numbers, Numbers]]]:
        """Bearings that change with the speed, all in rows at the same speeds (r,) [rad/s]: of each
        the row (n,) of its displacement, stiffness and damping (r, 2, 2)."""
        found = [(each.rows[0], each.table) for each in self.supports if each.table is not None]
        if not found:
            return np.zeros(0), []
        low, high = self.table_speeds
        every = np.unique(np.concatenate([table.speeds for _, table in found]))
        speeds = every[(every >= low) & (every <= high)]
        each = [
            (row, zip(*(table.at(float(w)) for w in speeds), strict=True)) for row, table in found
        ]
        return speeds, [(row, *map(np.array, both)) for row, both in each]

    @property
    def table_speeds(self) -> tuple[float, float]:
        """Lowest and highest speed that the tables of all bearings hold [rad/s]."""
        tables = [support.table.speeds for support in self.supports if support.table is not None]
        low = max((float(speeds[0]) for speeds in tables), default=0.0)
        return low, min((float(speeds[-1]) for speeds in tables), default=math.inf)

    def holds(self, low: float, high: float) -> bool:
        """Whether the tables of all bearings hold the speeds from `low` to `high` [rad/s]."""
        least, most = self.table_speeds
        slack = OUTSIDE * most if self.varies else 0.0
        return least - slack <= low and high <= most + slack

    @cached_property
    def springs(self) -> Numbers:
        """(2, 2, n, n) force along x, y by displacement along x, y of all supports [N/m].

        Raises:
            ValueError: bearings change with the speed.
        """
        self._refuse_varying()
        return summed(self.supports, "stiffness", self.stations)

    @cached_property
    def dampers(self) -> Numbers:
        """(2, 2, n, n) force along x, y by velocity along x, y of all supports [N s/m].

        Raises:
            ValueError: bearings change with the speed.
        """
        self._refuse_varying()
        return summed(self.supports, "damping", self.stations)

    def _refuse_varying(self) -> None:
        if self.varies:
            raise ValueError(
                "bearings: a table over the speed is not supported here; give stiffness and "
                "damping at one speed"
            )

    @cached_property
    def stiffness_x(self) -> Matrix:
        """(n, n) along x of shaft and supports [N/m]."""
        return self.elastic + self.springs[0, 0]

    @cached_property
    def stiffness_y(self) -> Matrix:
        """(n, n) along y of shaft and supports [N/m]."""
        return self.elastic + self.springs[1, 1]

    @property
    def damping_x(self) -> Matrix:
        """(n, n) of the supports along x [N s/m]."""
        return self.dampers[0, 0]

    @property
    def damping_y(self) -> Matrix:
        """(n, n) of the supports along y [N s/m]."""
        return self.dampers[1, 1]

    @cached_property
    def crossed(self) -> bool:
        """Whether a support pushes along one axis by a motion along the other one, or may."""
        if self.varies:
            return True
        blocks = (each[a, 1 - a] for each in (self.springs, self.dampers) for a in (0, 1))
        return not all(bool(np.all(block == 0)) for block in blocks)

    @cached_property
    def isotropic(self) -> bool:
        """True when both axes are alike and apart, so that z = x + i y needs no conjugate."""
        apart = self.sliders or self.cubics or self.stops
        return not (apart or self.crossed) and bool(
            np.array_equal(self.stiffness_x, self.stiffness_y)
            and np.array_equal(self.damping_x, self.damping_y)
        )

    @property
    def unbalance_columns(self) -> NDArray:
        """u by the turning unit vector: complex (n, 1) if isotropic, else (2n, 2) for x and y."""
        u = self.unbalance[:, None]
        return u if self.isotropic else np.block([[u.real, -u.imag], [u.imag, u.real]])

    @property
    def falling(self) -> NDArray:
        """Gravity at every station [m/s^2]: (n,) complex if isotropic, else (2n,) for x and y."""
        field = np.full(self.stations, self.gravity)
        field[[at for at, _ in self.waves]] = 0.0
        return field if self.isotropic else np.concatenate([field.real, field.imag])

    def sag(self, speed: float) -> NDArray:
        """Displacements at rest under gravity, ordered as `falling` [m].

        Internal damping, which turns with the shaft, draws them aside in proportion to the speed.

        Raises:
            ValueError: the supports have no stiffness that would carry the weight.
        """
        mass, _, stiffness = self.coefficients(speed)
        if self.waves and speed == 0.0:  # a liquid that does not turn forms no ring
            stiffness = stiffness + np.diag(self._is_wave).astype(stiffness.dtype)
            mass = np.where(self._is_wave[:, None], 0.0, mass)
        try:
            return np.linalg.solve(stiffness, mass @ self.falling)
        except np.linalg.LinAlgError:
            raise ValueError(
                "gravity: supports without stiffness cannot carry the rotor's weight"
            ) from None

    def rest_position(self, speed: float) -> NDArray[np.float64]:
        """The sag as x and y of every station (2, n) [m]; zero without gravity.

        Raises:
            ValueError: as `sag`.
        """
        if not self.gravity:
            return np.zeros((2, self.stations))
        sag = self.sag(speed)
        return np.array([sag.real, sag.imag]) if self.isotropic else sag.reshape(2, -1)

    @property
    def _is_wave(self) -> NDArray[np.bool_]:
        """Which of `falling` are of waves."""
        each = np.isin(np.arange(self.stations), [at for at, _ in self.waves])
        return each if self.isotropic else np.tile(each, 2)

    def refuse_sliders(self, what: str) -> None:
        """Raise ValueError, where the supports have dry friction, for what knows none."""
        if self.sliders:
            raise ValueError(f"sliders: {what} does not support dry friction in the supports")

    def refuse_rigid_twice(self) -> None:
        """Raise ValueError, where two rigid sliders are at one station and axis."""
        rigid = [(s.station, s.axis) for s in self.sliders if s.limit and not s.stiffness]
        if len(set(rigid)) < len(rigid):
            raise ValueError(
                "two rigid sliders at one support and axis are one with the sum of their limits: "
                "give that, or a stiffness"
            )

    def with_added_mass(self, added_mass: ArrayLike) -> LinearRotor:
        """The same rotor carrying `added_mass` [kg] (p,) rigidly at its planes."""
        added = numbers(added_mass)
        return replace(self, mass=self.mass + self.planes.T @ (added[:, None] * self.planes))

    def widened(self, more: int) -> LinearRotor:
        """The same rotor with more stations behind its own, free and without mass."""
        behind = (0, more)
        square: dict[str, Any] = {
            name: np.pad(getattr(self, name), (behind, behind))
            for name in ("mass", "elastic", "internal_damping", "gyroscopic")
        }
        rows: dict[str, Any] = {
            name: np.pad(getattr(self, name), ((0, 0), behind)) for name in ("planes", "deflection")
        }
        held: dict[str, Any] = {
            name: tuple(
                one
                if isinstance(one, Slider)  # its row may be shorter
                else replace(one, rows=np.pad(one.rows, ((0, 0), behind)))
                for one in getattr(self, name)
            )
            for name in ("supports", "cubics", "stops", "beside")
        }
        unbalance = np.pad(self.unbalance, behind)
        return replace(self, unbalance=unbalance, **held, **square, **rows)

    def with_ring(self, ring: Ring, plane: int) -> LinearRotor:
        """The same rotor with a ring at a plane (from 0), whose wave y is one more station.

        The equation of y, times m_L f, reads m_L f ((1 + f) y'' + A) + ... = 0: M stays symmetric.
        """
        row, mass, inertia = self.planes[plane], ring.liquid_mass, ring.wave_inertia
        grown = self.widened(1)
        grown.mass[:-1, :-1] += mass * np.outer(row, row)
        grown.mass[-1, :-1] = grown.mass[:-1, -1] = inertia * row
        grown.mass[-1, -1] = inertia * (1.0 + ring.hollow)
        return replace(grown, waves=(*self.waves, (self.stations, ring)))

    def wave_terms(self, speed: float) -> tuple[NDArray, NDArray]:
        """What the waves add to the velocity and displacement matrices, complex (n, n) each."""
        velocity, displacement = np.zeros((2, self.stations, self.stations), complex)
        for at, ring in self.waves:
            damping = ring.damping(speed)
            velocity[at, at] = ring.wave_inertia * (damping - 4j * speed)
            displacement[at, at] = -ring.wave_inertia * speed * (2.0 * speed + 1j * damping)
        return velocity, displacement

    def coefficients(self, speed: float) -> tuple[NDArray, NDArray, NDArray]:
        """Mass, velocity and displacement matrices at a constant speed [rad/s].

        Complex (n, n) for an isotropic rotor (z = x + i y), else real (2n, 2n) for (x, y).
        """
        if self.isotropic:
            damping = self.damping_x + self.internal_damping - 1j * speed * self.gyroscopic
            stiffness = self.stiffness_x - 1j * speed * self.internal_damping
            if self.waves:
                damped, stiffened = self.wave_terms(speed)
                damping, stiffness = damping + damped, stiffness + stiffened
            return self.mass.astype(complex), damping, stiffness
        return self.real_coefficients(speed)

    def real_coefficients(self, speed: float) -> tuple[NDArray, NDArray, NDArray]:
        """The same for (x, y), real (2n, 2n) for every rotor."""
        here, internal = self.at(speed), self.internal_damping
        turned, followed = speed * self.gyroscopic, speed * internal
        (_, k_xy), (k_yx, _) = here.springs
        (c_xx, c_xy), (c_yx, c_yy) = here.dampers
        damped = [[c_xx + internal, c_xy + turned], [c_yx - turned, c_yy + internal]]
        stiff = [[here.stiffness_x, k_xy + followed], [k_yx - followed, here.stiffness_y]]
        velocity, displacement = np.block(damped), np.block(stiff)
        if self.waves:
            more = self.wave_terms(speed)
            velocity, displacement = velocity + as_real(more[0]), displacement + as_real(more[1])
        return np.kron(np.eye(2), self.mass), velocity, displacement

    def free_rates(self, speed: float) -> NDArray:
        """Eigenvalues [1/s] of the free motion at a constant speed [rad/s].

        2n for an isotropic rotor, else 4n.
        """
        return np.linalg.eigvals(self.first_order(speed))

    def first_order(self, speed: float) -> NDArray:
        """A of (q, q')' = A (q, q') for the free motion at a constant speed [rad/s]."""
        mass, damping, stiffness = self.coefficients(speed)
        still = np.linalg.solve(mass, np.hstack([-stiffness, -damping]))
        return np.vstack([np.eye(len(mass), 2 * len(mass), len(mass)), still])


def as_real(matrix: NDArray) -> Matrix:
    """A complex matrix (n, n) of z = x + i y as a real one (2n, 2n) of x and y."""
    real, turned = matrix.real, matrix.imag
    return np.block([[real, -turned], [turned, real]])
