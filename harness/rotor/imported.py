"""Rotors from elsewhere as tables of a scene: matrices of any program, or a model of ROSS."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import UserError
from ..scene.rotor_matrices import Matrices

MODES = 6  # of the shaft, beside what forces in planes and bearings bend it to
COMPARED = 1.5  # times the highest speed: natural frequencies up to there have their error stated
RESOLVED = 1e-9  # of the largest singular value: shapes that others make
ARM = 0.37  # of an element: how far beyond a node its axis is another point
SAME = 1e-9  # of the largest entry: what both planes of a shaft may differ by

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Reduced:
    """A rotor that was reduced to a few displacements.

    Attributes:
        table: the rotor of a scene.
        error: largest relative error of a natural frequency up to `highest`, at rest and at speed.
        highest: natural frequency up to which errors are stated [rad/s].
    """

    table: Matrices
    error: float
    highest: float

    def __str__(self) -> str:
        """In words."""
        return (
            f"reduced to {len(self.table.stations)} displacements; natural frequencies up to "
            f"{self.highest:.4g} rad/s are within {self.error:.2g} of those of the model"
        )


class Rotor:
    """Makers of a rotor's table from what another program knows."""

    @staticmethod
    def from_matrices(
        *,
        mass: ArrayLike,
        stiffness: ArrayLike,
        damping: ArrayLike | None = None,
        internal_damping: ArrayLike | None = None,
        gyroscopic: ArrayLike | None = None,
        planes: ArrayLike | None = None,
        plane_positions: Sequence[float] = (),
        stations: Sequence[float] = (),
        supports: Sequence[int] = (1,),
        unbalances: Sequence[Any] = (),
    ) -> Matrices:
        """A rotor by its matrices between n points, each a displacement: the table of a scene.

        Args:
            mass, internal_damping, gyroscopic: (n, n), the same along both axes; `gyroscopic` is G
                of M z'' - i w G z', z = x + i y [kg, N s/m, kg].
            stiffness, damping: of all that does not turn: (n, n) for both axes, or (2n, 2n) of x of
                all points, then y [N/m, N s/m].
            planes: (p, n) displacement of the planes by the points'; default: the points.
            plane_positions, stations: places of planes and points along the axis [m]; default:
                0, 1, 2, ...
            supports: numbers of one or two points at which the balance is judged, from 1.
            unbalances: tables {position, amount, angle}, each at the place of a plane.

        Raises:
            SceneError: a matrix has another size, or the mass matrix is not symmetric and positive
                definite.

        >>> rotor = ab.Rotor.from_matrices(
        ...     mass=np.diag([2.0, 8.0]), stiffness=[[6e5, -4e5], [-4e5, 4.5e5]],
        ...     damping=np.diag([80.0, 40.0]),
        ... )
        >>> scene = ab.Scene(rotor=rotor, speed=100.0)
        >>> scene.rotor().critical.round(1)
        array([143.1, 579.5])
        """
        given = {
            "mass_matrix": mass, "stiffness_matrix": stiffness, "damping_matrix": damping,
            "internal_damping_matrix": internal_damping, "gyroscopic_matrix": gyroscopic,
            "plane_rows": planes,
        }  # fmt: skip
        square = {k: np.asarray(v, float).tolist() for k, v in given.items() if v is not None}
        return Matrices(
            **square, planes=tuple(plane_positions), stations=tuple(stations),
            supports=tuple(supports), unbalances=tuple(unbalances),
        )  # fmt: skip

    @staticmethod
    def from_ross(
        rotor: Any,
        planes: Sequence[int],
        *,
        speed: float,
        modes: int = MODES,
        unbalances: Sequence[Any] = (),
    ) -> Reduced:
        """A rotor of ROSS (PyPI: ross-rotordynamics), reduced to the modes that matter.

        The shapes are the lowest `modes` of the shaft on its bearings, and what unit forces in the
        planes and bearings bend it to; polar inertia, bearings with cross terms and discs are kept.
        Bearings that change with the frequency are those of `speed`; axial and torsional motion is
        left out.

        Args:
            rotor: a `ross.Rotor`.
            planes: numbers of the nodes at which balancers and unbalances can sit.
            speed: of operation [rad/s].
            modes: of the shaft in one plane.
            unbalances: tables {position, amount, angle}, each at the place of a plane.

        Raises:
            UserError: a node does not exist, or the model differs between its lateral planes.

        >>> reduced = ab.Rotor.from_ross(model, planes=[2, 4], speed=400.0)  # doctest: +SKIP
        >>> scene = ab.Scene(rotor=reduced.table, speed=400.0)  # doctest: +SKIP
        """
        full = _lateral(rotor, planes, speed)
        basis = _shapes(full, modes)
        points, places = _spread(full, basis)
        basis = basis @ np.linalg.inv(points @ basis)  # by the displacements of these points
        reduced = full.reduced(basis)
        highest = COMPARED * speed
        error = max(_difference(full, reduced, w, highest) for w in (0.0, speed))
        table = Rotor.from_matrices(
            mass=reduced.mass, stiffness=reduced.stiffness, damping=reduced.damping,
            gyroscopic=reduced.gyroscopic, planes=reduced.planes,
            plane_positions=[float(full.places[k]) for k in planes],
            stations=places.tolist(), supports=_judged(places, full), unbalances=unbalances,
        )  # fmt: skip
        return Reduced(table, error, highest)


@dataclass(frozen=True, eq=False)
class _Lateral:
    """Lateral motion of a model: coordinates x and slopes of all nodes, the same in both planes.

    Attributes:
        mass, shaft, gyroscopic: (n, n).
        stiffness, damping: (2n, 2n) with the bearings.
        planes: (p, n).
        places: of the nodes [m].
        bearings: nodes that have one.
    """

    mass: Array
    shaft: Array
    gyroscopic: Array
    stiffness: Array
    damping: Array
    planes: Array
    places: Array
    bearings: tuple[int, ...]

    def reduced(self, basis: Array) -> _Lateral:
        """By shapes (n, m)."""
        both = np.kron(np.eye(2), basis)
        mass, shaft, turned = (
            basis.T @ each @ basis for each in (self.mass, self.shaft, self.gyroscopic)
        )
        stiffness, damping = (both.T @ each @ both for each in (self.stiffness, self.damping))
        return _Lateral(
            (mass + mass.T) / 2.0, shaft, turned, stiffness, damping, self.planes @ basis,
            self.places, self.bearings,
        )  # fmt: skip

    def frequencies(self, speed: float) -> Array:
        """Natural frequencies at a speed, ascending [rad/s]."""
        n = len(self.mass)
        turned = speed * np.kron(np.array([[0.0, 1.0], [-1.0, 0.0]]), self.gyroscopic)
        mass = np.kron(np.eye(2), self.mass)
        still = np.linalg.solve(mass, np.hstack([-self.stiffness, -(self.damping + turned)]))
        values = np.linalg.eigvals(np.vstack([np.eye(2 * n, 4 * n, 2 * n), still]))
        return np.sort(np.abs(values[values.imag > 0.0]))


def _lateral(rotor: Any, planes: Sequence[int], speed: float) -> _Lateral:
    """Matrices of a ROSS rotor in the planes x z and y z.

    Slopes dx/dz and dy/dz are the rotations beta and -alpha; the gyroscopic matrix of ROSS
    multiplies the speed and stands with the damping.
    """
    per_node, nodes = int(rotor.number_dof), len(rotor.nodes)
    for node in planes:
        if not 0 <= node < nodes:
            raise UserError(f"planes: {node}: must be a node of the model, 0 to {nodes - 1}")
    alpha = 3 if per_node == 6 else 2
    first = per_node * np.arange(nodes)
    along_x = np.concatenate([first, first + alpha + 1])
    along_y = np.concatenate([first + 1, first + alpha])
    signs = np.concatenate([np.ones(nodes), -np.ones(nodes)])
    mass, stiffness, damping, turned = (
        np.array(each, float)
        for each in (rotor.M(speed), rotor.K(speed), rotor.C(speed), rotor.G())
    )

    def block(matrix: Array, to: Array, by: Array) -> Array:
        left = signs if to is along_y else np.ones(2 * nodes)
        right = signs if by is along_y else np.ones(2 * nodes)
        return left[:, None] * matrix[np.ix_(to, by)] * right

    def whole(matrix: Array) -> Array:
        pair = (along_x, along_y)
        return np.block([[block(matrix, to, by) for by in pair] for to in pair])

    in_x, in_y = block(mass, along_x, along_x), block(mass, along_y, along_y)
    gyroscopic = block(turned, along_x, along_y)
    if np.abs(in_x - in_y).max() > SAME * np.abs(in_x).max():
        raise UserError("from_ross: the masses differ between x and y: not a rotor that is round")
    shaft = whole(stiffness)
    bearings, held = [], shaft.copy()
    for bearing in rotor.bearing_elements:
        node = int(bearing.n)
        bearings.append(node)
        at = np.array([node, node + 2 * nodes])
        held[np.ix_(at, at)] -= np.array(bearing.K(speed), float)[:2, :2]
    n = 2 * nodes
    rows = np.zeros((len(planes), n))
    rows[range(len(planes)), list(planes)] = 1.0
    return _Lateral(
        in_x, held[:n, :n], gyroscopic, shaft, whole(damping), rows,
        np.asarray(rotor.nodes_pos, float), tuple(dict.fromkeys(bearings)),
    )  # fmt: skip


def _shapes(full: _Lateral, modes: int) -> Array:
    """Shapes (n, m): modes of the shaft on springs, and what forces bend it to."""
    from scipy.linalg import eigh

    n = len(full.mass)
    means = (full.stiffness[:n, :n] + full.stiffness[n:, n:]) / 2.0
    means = (means + means.T) / 2.0
    _, vectors = eigh(means, full.mass)
    loads = np.zeros((n, len(full.planes) + len(full.bearings)))
    loads[:, : len(full.planes)] = full.planes.T
    for k, node in enumerate(full.bearings, start=len(full.planes)):
        loads[node, k] = 1.0
    shapes = np.hstack([vectors[:, :modes], np.linalg.solve(means, loads)])
    size = np.sqrt(np.einsum("ij,jk,ki->i", shapes.T, full.mass, shapes))
    left, values, _ = np.linalg.svd(shapes / size, full_matrices=False)
    return np.asarray(left[:, values > RESOLVED * values[0]])


def _spread(full: _Lateral, basis: Array) -> tuple[Array, Array]:
    """Rows (m, n) and places (m,) [m] of points whose displacements tell shapes (n, m) apart best.

    They are nodes, or points of the axis a little beyond them, which tell its slope.
    """
    from scipy.linalg import qr

    count = len(full.places)
    arm = ARM * float(np.diff(full.places).min())
    unit = np.eye(2 * count)
    rows = np.vstack([unit[:count], unit[:count] + arm * unit[count:]])
    places = np.concatenate([full.places, full.places + arm])
    _, _, order = qr((rows @ basis).T, pivoting=True)
    chosen = np.sort(order[: basis.shape[1]])
    chosen = chosen[np.argsort(places[chosen], kind="stable")]
    return rows[chosen], places[chosen]


def _difference(full: _Lateral, reduced: _Lateral, speed: float, highest: float) -> float:
    """Largest relative error of a natural frequency up to the highest, or of the lowest four."""
    right, ours = full.frequencies(speed), reduced.frequencies(speed)
    count = min(len(ours), max(4, int((right <= highest).sum())))
    return float((np.abs(ours[:count] - right[:count]) / right[:count]).max())


def _judged(places: Array, full: _Lateral) -> list[int]:
    """Numbers of one or two stations next to the outer bearings."""
    held = full.places[list(full.bearings)] if full.bearings else full.places[:1]
    found = [1 + int(np.argmin(np.abs(places - end))) for end in (held.min(), held.max())]
    return list(dict.fromkeys(found))
