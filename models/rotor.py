"""A rotor on viscous-elastic supports as one linear system.

    M q'' + (C + C_i - w G J) q' + (K - w C_i J) q = u (w^2 - i w') e^{i beta} + S^T F

where J turns x into y and y into -x.  Filimonikhina 2017 (4), Dubovik 2006 (5), Polushkin 2016 and
Filimonikhin 2011 (1) all describe a rotor of this form; they differ only in the matrices.  In
complex notation z = x + i y the equation of an isotropic rotor reads

    M z'' + (C + C_i - i w G) z' + (K - i w C_i) z = u (w^2 - i w') e^{i beta} + S^T F

and is half the size of the real one; an anisotropic rotor needs both axes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .rotor_kinds import flexible_matrices, two_support_matrices

Matrix = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LinearRotor:
    """Matrices and planes of a linear rotor with n stations and p correction planes.

    Attributes:
        mass: (n, n) mass matrix, the same in both axes [kg].
        damping_x, damping_y: (n, n) damping of supports and air, per axis [N s/m].
        stiffness_x, stiffness_y: (n, n) stiffness, per axis [N/m].
        internal_damping: (n, n) damping of the rotating shaft C_i [N s/m].
        gyroscopic: (n, n) gyroscopic matrix G, multiplied by the speed [kg].
        planes: (p, n) matrix S: displacement of the planes from that of the stations.
        unbalance: (n,) complex generalised unbalance u in the rotor frame [kg m].
        deflection: (d, n) rows whose largest modulus is the shaft's bending.
    """

    mass: Matrix
    damping_x: Matrix
    damping_y: Matrix
    stiffness_x: Matrix
    stiffness_y: Matrix
    internal_damping: Matrix
    gyroscopic: Matrix
    planes: Matrix
    unbalance: NDArray[np.complex128]
    deflection: Matrix

    @classmethod
    def planar(
        cls,
        mass: float,
        stiffness: float | Sequence[float],
        damping: float | Sequence[float] = 0.0,
        internal_damping: float = 0.0,
        unbalance: float = 0.0,
        unbalance_angle: float = 0.0,
    ) -> LinearRotor:
        """Disc in one plane: Filimonikhina 2017 (4), Dubovik 2006 (5).

        Args:
            mass: disc without balancer weights or liquid [kg].
            stiffness, damping: one number, or (x, y) [N/m, N s/m].
            internal_damping: Dubovik's p, damping of the rotating shaft [N s/m].
            unbalance, unbalance_angle: static moment [kg m] and its angle in the rotor [rad].
        """
        k_x, k_y = np.broadcast_to(np.asarray(stiffness, float), 2)
        c_x, c_y = np.broadcast_to(np.asarray(damping, float), 2)

        def cell(value: float) -> Matrix:
            return np.array([[float(value)]])

        return cls(
            mass=cell(mass),
            damping_x=cell(c_x),
            damping_y=cell(c_y),
            stiffness_x=cell(k_x),
            stiffness_y=cell(k_y),
            internal_damping=cell(internal_damping),
            gyroscopic=cell(0.0),
            planes=cell(1.0),
            unbalance=np.array([unbalance * np.exp(1j * unbalance_angle)]),
            deflection=cell(1.0),
        )

    @classmethod
    def two_support(
        cls,
        *,
        mass: float,
        inertia: float,
        span: float,
        stiffness: Sequence[Sequence[float]],
        damping: Sequence[Sequence[float]] = ((0.0, 0.0), (0.0, 0.0)),
        polar_inertia: float = 0.0,
        com: float | None = None,
        planes: Sequence[float] = (),
        unbalances: Sequence[tuple[float, float, float]] = (),
    ) -> LinearRotor:
        """Rigid rotor, q = displacement at its two supports: Polushkin 2016 (8), (9).

        The run-up torque is taken to act along the tilted axis: the polar inertia then leaves no
        term with w'.

        Args:
            mass, inertia, polar_inertia: m [kg], transverse It about the centre of mass and polar
                Ip [kg m^2]; the paper has Ip = 0.
            span, com: between the supports, and centre of mass from support 1 (default: the middle;
                it may lie outside) [m].
            stiffness, damping: ((k1x, k1y), (k2x, k2y)) [N/m, N s/m].
            planes: correction planes' distances from support 1, overhung ones too [m].
            unbalances: (position from support 1 [m], amount [kg m], angle in the rotor [rad]).

        Raises:
            ValueError: a value is not finite or out of its range.
        """
        return cls(
            **two_support_matrices(
                mass, inertia, polar_inertia, span, com, stiffness, damping, planes, unbalances
            )
        )

    @classmethod
    def flexible(
        cls,
        *,
        stations: Sequence[float],
        masses: Sequence[float],
        supports: Sequence[int],
        support_stiffness: Sequence[Sequence[float]],
        support_damping: Sequence[Sequence[float]] = ((0.0, 0.0), (0.0, 0.0)),
        bending_stiffness: float | None = None,
        compliance: Sequence[Sequence[float]] | None = None,
        internal_damping: float = 0.0,
        unbalances: Sequence[tuple[float, float, float]] = (),
    ) -> LinearRotor:
        """Discs on a massless shaft, q = their displacements: Filimonikhin 2011 (1).

        Every disc is a correction plane.  The shaft's material is viscous (Dubovik's p = c * its
        viscosity / E), so C_i is proportional to the shaft's stiffness, supports left out.

        Args:
            stations, masses: (n,) places [m], ascending, and discs [kg], each positive.
            supports: two different stations, from 1, in any order; discs may overhang.
            support_stiffness, support_damping: ((x, y), (x, y)) in that order [N/m, N s/m].
            bending_stiffness: E I of a uniform shaft [N m^2], or else
            compliance: (n-2, n-2) of the shaft simply supported there, without supports [m/N].
            internal_damping: p [N s/m] that belongs to c = 1/(largest delta_jj), what a disc would
                feel where the shaft is softest; with one disc it is Dubovik's p.
            unbalances: (a disc's place [m], amount [kg m], angle in the rotor [rad]).

        Raises:
            ValueError: a value is not finite or out of its range, or the shaft is not elastic.
        """
        return cls(
            **flexible_matrices(
                stations,
                masses,
                supports,
                support_stiffness,
                support_damping,
                bending_stiffness,
                compliance,
                internal_damping,
                unbalances,
            )
        )

    @property
    def stations(self) -> int:
        """Number n of stations."""
        return int(self.mass.shape[0])

    @property
    def plane_count(self) -> int:
        """Number p of correction planes."""
        return int(self.planes.shape[0])

    @property
    def isotropic(self) -> bool:
        """True when both axes are alike, so that z = x + i y needs no conjugate."""
        return bool(
            np.array_equal(self.stiffness_x, self.stiffness_y)
            and np.array_equal(self.damping_x, self.damping_y)
        )

    def with_added_mass(self, added_mass: ArrayLike) -> LinearRotor:
        """The same rotor carrying `added_mass` [kg] (p,) rigidly at its planes."""
        added = np.asarray(added_mass, float)
        return replace(self, mass=self.mass + self.planes.T @ (added[:, None] * self.planes))

    def coefficients(self, speed: float) -> tuple[NDArray, NDArray, NDArray]:
        """Mass, velocity and displacement matrices at a constant speed [rad/s].

        Complex (n, n) for an isotropic rotor (z = x + i y), else real (2n, 2n) for (x, y).
        """
        if self.isotropic:
            damping = self.damping_x + self.internal_damping - 1j * speed * self.gyroscopic
            stiffness = self.stiffness_x - 1j * speed * self.internal_damping
            return self.mass.astype(complex), damping, stiffness
        internal = self.internal_damping
        turned, followed = speed * self.gyroscopic, speed * internal
        damped = [[self.damping_x + internal, turned], [-turned, self.damping_y + internal]]
        stiff = [[self.stiffness_x, followed], [-followed, self.stiffness_y]]
        return np.kron(np.eye(2), self.mass), np.block(damped), np.block(stiff)
