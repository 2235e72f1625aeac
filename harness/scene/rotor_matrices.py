"""A rotor in a scene that is known by its matrices: of another program, or of a measurement."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import model_validator
from pydantic_core import PydanticCustomError

from ...models.rotor import LinearRotor
from ...models.supports import Support
from .feeds import Start
from .quantities import SI, Real, RealPair, Whole, refusal
from .rotor_keys import Friction, Unbalances
from .rotor_table import RotorTable
from .stop import Cubic, Holding, Stops

Matrix = tuple[tuple[Real, ...], ...]


class Matrices(RotorTable):
    """Any linear rotor by its matrices between n points, each a displacement."""

    damping_ratio: ClassVar[None] = None  # type: ignore[misc]

    kind: Literal["matrices"] = "matrices"
    mass_matrix: Annotated[Matrix, SI("kg")]
    """(n, n), the same along both axes, symmetric and positive definite."""
    stiffness_matrix: Annotated[Matrix, SI("N/m")]
    """Of shaft and supports: (n, n) for both axes, or (2n, 2n) of x of all points, then y."""
    damping_matrix: Annotated[Matrix | None, SI("N s/m")] = None
    """Of all that does not turn: (n, n) or (2n, 2n); default: none."""
    internal_damping_matrix: Annotated[Matrix | None, SI("N s/m")] = None
    """(n, n) of the turning shaft; default: none."""
    gyroscopic_matrix: Annotated[Matrix | None, SI("kg")] = None
    """(n, n) G of M z'' - i w G z', z = x + i y; default: none."""
    plane_rows: Annotated[Matrix | None, SI("")] = None
    """(p, n) displacement of the correction planes by the points'; default: the points."""
    planes: Annotated[tuple[Real, ...], SI("m")] = ()
    """Places of the planes along the axis; default: 0, 1, 2, ... m."""
    stations: Annotated[tuple[Real, ...], SI("m")] = ()
    """Places of the points along the axis; default: 0, 1, 2, ... m."""
    supports: tuple[Whole, ...] = (1,)
    """Numbers of one or two points at which the balance is judged."""
    unbalances: Unbalances = ()
    """Static moments, each at the place of a plane."""
    friction: Friction = ()
    """Dry friction at `supports`, or at "point[k]": sliders, also with a free stroke."""
    cubic_stiffness: Annotated[tuple[RealPair, ...] | None, SI("N/m^3")] = None
    """Force by the cube of the displacement; one entry for each of `supports`, 0 or more."""
    cubic: Cubic = "radial"
    """Along the displacement, k3 |d|^2 d, or "axes": k3 x^3 and k3 y^3, each along its own."""
    stops: Stops = ()
    """Elastic stops beyond a gap, at `supports` or at "point[k]"."""

    @model_validator(mode="after")
    def _is_a_rotor(self) -> Matrices:
        n = len(self.mass_matrix)
        rows = np.eye(n) if self.plane_rows is None else np.array(self.plane_rows)
        for key, count in (("stations", n), ("planes", len(rows))):
            given = getattr(self, key) or tuple(map(float, range(count)))
            if len(given) != count or len(set(given)) < count:
                raise refusal(key, f"must be {count} different places, one each")
            self.__dict__[key] = given
        if len(self.supports) not in (1, 2) or not all(1 <= s <= n for s in self.supports):
            raise refusal("supports", f"must be one or two numbers of points, 1 to {n}")
        for k, one in enumerate(self.unbalances, start=1):
            if one.position not in self.planes:
                places = ", ".join(f"{place:g}" for place in self.planes)
                words = f"must be the place of a plane, one of {places} m"
                raise refusal(f"unbalances[{k}].position", words)
        if self.cubic_stiffness is not None and len(self.cubic_stiffness) != len(self.supports):
            raise refusal("cubic_stiffness", f"must be {len(self.supports)}, one for each support")
        if any(k3 < 0.0 for pair in self.cubic_stiffness or () for k3 in pair):
            words = "must not be below 0: which part of the stiffness could soften is not known"
            raise refusal("cubic_stiffness", words)
        for key in ("bearings", "bodies", "support_loss_factor"):
            if getattr(self, key):
                raise refusal(key, "not with matrices: they hold all supports")
        try:
            self.build()
        except ValueError as error:
            if isinstance(error, PydanticCustomError):
                raise
            key, _, words = str(error).partition(": ")
            named = "plane_rows" if key == "planes" else f"{key}_matrix"
            raise refusal(named if words else "mass_matrix", words or key) from None
        return self

    @property
    def takes_matrices(self) -> bool:
        """It is built by them."""
        return True

    @property
    def mass(self) -> float:
        """Of all points when they move alike [kg]."""
        return float(np.sum(self.mass_matrix))

    @property
    def centre(self) -> float:
        """Place of the centre of mass [m]."""
        shares = np.sum(self.mass_matrix, axis=0)
        return float(shares @ np.array(self.stations) / self.mass)

    @property
    def support_stiffness(self) -> tuple[tuple[float, float], ...]:
        """Along x and y at the points of `supports` [N/m]."""
        return self._at_supports("stiffness_x", "stiffness_y")

    @property
    def support_damping(self) -> tuple[tuple[float, float], ...]:
        """Along x and y at the points of `supports` [N s/m]."""
        return self._at_supports("damping_x", "damping_y")

    def _at_supports(self, *names: str) -> tuple[tuple[float, float], ...]:
        rotor, points = self.build(), [number - 1 for number in self.supports]
        x, y = (getattr(rotor, name) for name in names)
        return tuple((float(x[k, k]), float(y[k, k])) for k in points)

    @property
    def _forces(self) -> dict[str, int]:
        """None: supports are in the matrices, and have no force of their own."""
        return {}

    def start(self, planes: Sequence[int]) -> Start:
        """Parameters of the unit."""
        return self._matrix_start(planes)

    def build(self) -> LinearRotor:
        """The rotor's matrices."""
        n = len(self.mass_matrix)
        rows = np.eye(n) if self.plane_rows is None else np.array(self.plane_rows, float)
        unbalance = np.zeros(n, complex)
        for one in self.unbalances:
            row = rows[self.planes.index(one.position)]
            unbalance += one.amount * np.exp(1j * one.angle) * row
        rotor = LinearRotor.from_matrices(
            mass=self.mass_matrix,
            stiffness=self.stiffness_matrix,
            damping=self.damping_matrix,
            internal_damping=self.internal_damping_matrix,
            gyroscopic=self.gyroscopic_matrix,
            planes=rows,
            unbalance=unbalance,
        )
        return self._with_supports(rotor)

    def _holding(self, rotor: LinearRotor) -> Holding:
        """Points: those of `supports` by number, all by name; their forces are no outputs."""
        nothing = np.zeros((2, 2, 1, 1))
        points = [Support(row[None], nothing, nothing) for row in np.eye(rotor.stations)]
        named: Holding = {f"point[{k}]": (one, 0) for k, one in enumerate(points, start=1)}
        return {k: (points[s - 1], 0) for k, s in enumerate(self.supports, start=1)} | named
