"""A rotor's unit by matrices: what it is built for and started with where no kind of unit fits."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...models.rotor import LinearRotor
from .feeds import Start

Acting = Sequence[tuple[float, float, NDArray[np.float64]]]
"""Unbalances: amount [kg m], angle in the rotor [rad], and row (n,) by which they act."""


def matrix_start(rotor: LinearRotor, planes: Sequence[int], acting: Acting) -> Start:
    """Parameters of the unit of a rotor.

    Args:
        planes: numbers of the planes that the unit has, from 1.
        acting: its unbalances; the unit has at least one.
    """
    nothing = [(0.0, 0.0, np.zeros(rotor.stations))]
    values = _tables(rotor) | _forces(rotor)
    rotor = rotor.without_tables
    for name, matrix in _matrices(rotor):
        values |= _entries(name, matrix)
    rows = rotor.planes if len(rotor.planes) else np.eye(1, rotor.stations)  # a unit has one
    values |= _entries("plane_row", rows[[p - 1 for p in planes]])
    for k, (amount, angle, _) in enumerate(acting or nothing, start=1):
        values |= {f"unbalance[{k}].amount": amount, f"unbalance[{k}].angle": angle}
    values |= _entries("unbalance_row", np.array([row for _, _, row in acting or nothing]))
    bending = np.zeros((max(1, rotor.stations - 2), rotor.stations))
    bending[: len(rotor.deflection)] = rotor.deflection
    return values | _entries("bending_row", bending)


def _matrices(rotor: LinearRotor) -> Iterator[tuple[str, Any]]:
    """The unit's matrices, by name."""
    springs = rotor.springs.copy()
    springs[[0, 1], [0, 1]] += rotor.elastic
    for what, blocks in (("damping", rotor.dampers), ("stiffness", springs)):
        for i, to in enumerate("xy"):
            for j, by in enumerate("xy"):
                yield f"{what}_{to}{by}", blocks[i, j]
    yield "mass", (rotor.mass + rotor.mass.T) / 2.0
    yield "internal_damping", rotor.internal_damping
    yield "gyroscopic", rotor.gyroscopic


def _tables(rotor: LinearRotor) -> Start:
    """Bearings that change with the speed."""
    speeds, tables = rotor.tables
    values: Start = {f"table_speed[{k}]": float(w) for k, w in enumerate(speeds, start=1)}
    for t, (row, stiffness, damping) in enumerate(tables, start=1):
        values |= {f"table_row[{t},{k}]": float(part) for k, part in enumerate(row, start=1)}
        for what, blocks in (("stiffness", stiffness), ("damping", damping)):
            for (k, i, j), value in np.ndenumerate(blocks):
                values[f"table_{what}_{'xy'[i]}{'xy'[j]}[{t},{k + 1}]"] = float(value)
    return values


def _forces(rotor: LinearRotor) -> Start:
    """What the forces of supports and feet follow from."""
    from ...models.forces import force_rows  # of rotors by matrices alone

    values: Start = {}
    for number, one in enumerate(force_rows(rotor), start=1):
        values[f"force[{number}].table"] = float(one.table + 1)
        for what, rows in (("stiffness", one.stiffness), ("damping", one.damping)):
            for (i, j, k), value in np.ndenumerate(rows):
                values[f"force_{what}_{'xy'[i]}{'xy'[j]}[{number},{k + 1}]"] = float(value)
    return values


def _entries(name: str, matrix: NDArray[np.float64]) -> Start:
    """A matrix as parameters."""
    return {f"{name}[{i + 1},{j + 1}]": float(value) for (i, j), value in np.ndenumerate(matrix)}
