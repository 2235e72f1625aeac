"""Values of a rotor's parameters made into a `LinearRotor`, for each kind of rotor."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...models.arrays import Array
from ...models.constants import SAME_PLACE
from ...models.forces import force_rows
from ...models.rotor import LinearRotor
from .sizes import RotorSizes

Values = Mapping[str, float]


def planar(values: Values, sizes: RotorSizes) -> LinearRotor:
    """A disc in its plane: Filimonikhina 2017, Dubovik 2006."""
    rotor = LinearRotor.planar(
        values["mass"],
        (values["stiffness_x"], values["stiffness_y"]),
        (values["damping_x"], values["damping_y"]),
        values["internal_damping"],
        values["unbalance"],
        values["unbalance_angle"],
    )
    # several planes are several ports at the one disc
    return replace(rotor, planes=np.ones((sizes.planes, 1)))


def two_support(values: Values, sizes: RotorSizes) -> LinearRotor:
    """A rigid body on two supports: Polushkin 2016."""
    return LinearRotor.two_support(
        mass=values["mass"],
        inertia=values["inertia"],
        polar_inertia=values["polar_inertia"],
        span=values["span"],
        com=values["com"],
        stiffness=_supports(values, "stiffness"),
        damping=_supports(values, "damping"),
        planes=[values[f"plane[{i}].position"] for i in range(1, sizes.planes + 1)],
        unbalances=_unbalances(values, sizes),
    )


def flexible(values: Values, sizes: RotorSizes) -> LinearRotor:
    """Discs on an elastic shaft: Filimonikhin 2011."""
    n = sizes.stations
    z = [values[f"station[{j}].z"] for j in range(1, n + 1)]
    ends = [_station_at(z, f"support[{s}].position", values) + 1 for s in (1, 2)]
    shaft: dict = {"bending_stiffness": values.get("bending_stiffness")}
    if sizes.shaft == "compliance":
        shaft = {"compliance": _symmetric(values, n - 2)}
    rotor = LinearRotor.flexible(
        stations=z,
        masses=[values[f"station[{j}].mass"] for j in range(1, n + 1)],
        supports=ends,
        support_stiffness=_supports(values, "stiffness"),
        support_damping=_supports(values, "damping"),
        internal_damping=values["internal_damping"],
        # one without amount may keep its default place, where there is no station
        unbalances=[u for u in _unbalances(values, sizes) if u[1] != 0.0],
        **shaft,
    )
    # only the planes that carry something are ports
    ports = [_station_at(z, f"plane[{i}].position", values) for i in range(1, sizes.planes + 1)]
    return replace(rotor, planes=rotor.planes[ports])


def matrices(values: Values, sizes: RotorSizes) -> LinearRotor:
    """Any linear rotor by its matrices."""
    n = sizes.stations

    def square(name: str) -> NDArray[np.float64]:
        return rows(name, n)

    def rows(name: str, count: int) -> NDArray[np.float64]:
        of = range(1, count + 1)
        return np.array([[values[f"{name}[{j},{k}]"] for k in range(1, n + 1)] for j in of])

    def both(name: str) -> NDArray[np.float64]:
        return np.block([[square(f"{name}_{to}{by}") for by in "xy"] for to in "xy"])

    numbers = range(1, sizes.unbalances + 1)
    amounts = [
        values[f"unbalance[{k}].amount"] * np.exp(1j * values[f"unbalance[{k}].angle"])
        for k in numbers
    ]
    return LinearRotor.from_matrices(
        mass=square("mass"),
        stiffness=both("stiffness"),
        damping=both("damping"),
        internal_damping=square("internal_damping"),
        gyroscopic=square("gyroscopic"),
        planes=rows("plane_row", sizes.planes),
        unbalance=np.array(amounts) @ rows("unbalance_row", sizes.unbalances),
        deflection=rows("bending_row", max(1, n - 2)),
    )


def forces_of_rotor(values: Values, sizes: RotorSizes, rotor: LinearRotor) -> Array:
    """Rows (2 f, 4 n) of F_x, F_y of every support, by displacements, then velocities of the
    stations, x and y alternating."""
    rows = [(one.stiffness, one.damping) for one in force_rows(rotor)]
    return _force_matrix(np.array(rows))


def forces_of_matrices(values: Values, sizes: RotorSizes, rotor: LinearRotor) -> Array:
    """The same from the parameters of supports, then feet."""
    numbers, stations = range(1, len(sizes.forces) + 1), range(1, sizes.stations + 1)
    rows = [
        [[[[values[f"force_{what}_{to}{by}[{k},{j}]"] for j in stations] for by in "xy"]
          for to in "xy"] for what in ("stiffness", "damping")]
        for k in numbers
    ]  # fmt: skip
    return _force_matrix(np.reshape(np.array(rows), (len(rows), 2, 2, 2, sizes.stations)))


def _force_matrix(rows: Array) -> Array:
    """From (f, 2, 2, 2, n): stiffness or damping, force along x or y, by motion along x or y."""
    count, n = rows.shape[0], rows.shape[-1]
    return rows.transpose(0, 2, 1, 4, 3).reshape(2 * count, 4 * n)


FORCES = {
    "planar": forces_of_rotor,
    "two_support": forces_of_rotor,
    "flexible": forces_of_rotor,
    "matrices": forces_of_matrices,
}

ROTORS = {
    "planar": planar,
    "two_support": two_support,
    "flexible": flexible,
    "matrices": matrices,
}


def _supports(values: Values, what: str) -> list[list[float]]:
    return [[values[f"support[{s}].{what}_{axis}"] for axis in "xy"] for s in (1, 2)]


def _unbalances(values: Values, sizes: RotorSizes) -> list[tuple[float, float, float]]:
    return [
        (
            values[f"unbalance[{k}].position"],
            values[f"unbalance[{k}].amount"],
            values[f"unbalance[{k}].angle"],
        )
        for k in range(1, sizes.unbalances + 1)
    ]


def _symmetric(values: Values, size: int) -> list[list[float]]:
    """The compliance from its upper triangle."""
    return [
        [values[f"compliance[{min(j, k)},{max(j, k)}]"] for k in range(1, size + 1)]
        for j in range(1, size + 1)
    ]


def _station_at(z: list[float], name: str, values: Values) -> int:
    """Index of the station at a place; raises ValueError when there is none."""
    place = values[name]
    nearest = min(range(len(z)), key=lambda j: abs(z[j] - place))
    if not abs(z[nearest] - place) <= SAME_PLACE * abs(z[-1] - z[0]):
        raise ValueError(f"{name} = {place!r} m: must be the place of a station, one of {z} m")
    return nearest
