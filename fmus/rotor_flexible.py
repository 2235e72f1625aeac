"""Discs on an elastic shaft as a unit's parameters: Filimonikhin 2011."""

from __future__ import annotations

from dataclasses import replace

from ..models.rotor import LinearRotor
from ..models.shaft import beam_compliance
from .rotor_parts import (
    SHAFTS,
    Sizes,
    Values,
    planes,
    support_values,
    supports,
    unbalance_values,
    unbalances,
)
from .variables import Variable, parameter

_SPACING = 0.1  # m, between the stations of a shaft nobody has described yet
_STEEL_20_MM = 1.6e3  # N m^2, E I of a steel shaft of 20 mm
_ONTO = 1e-9  # of the shaft's length: a place this near to a station is the station


def flexible_variables(sizes: Sizes) -> list[Variable]:
    n = sizes.stations
    if n < 2:
        raise ValueError(f"stations = {n!r}: a flexible rotor has at least 2, its supports")
    if sizes.shaft not in SHAFTS:
        raise ValueError(f"shaft = {sizes.shaft!r}: must be one of {', '.join(map(repr, SHAFTS))}")
    z = [_SPACING * j for j in range(n)]
    discs = [
        v
        for j, place in enumerate(z, start=1)
        for v in (
            parameter(f"station[{j}].z", place, "m", "Place on the shaft, beyond the one before"),
            parameter(f"station[{j}].mass", 1.0, "kg", "Of its disc", minimum=0.0, above=True),
        )
    ]
    ends = [
        parameter("support[1].position", z[0], "m", "Place on the shaft, that of a station"),
        parameter("support[2].position", z[-1], "m", "Place on the shaft, that of a station"),
    ]
    places = [z[(i + n // 2) % n] for i in range(sizes.planes)]
    where = "Place on the shaft, that of a station"
    return [
        *discs,
        *ends,
        *supports(2.0e5, 150.0),
        *_shaft(sizes, z),
        parameter(
            "internal_damping", 0.0, "N.s/m", "Of the shaft, where it is softest", minimum=0.0
        ),
        *planes(places, where),
        *unbalances(sizes, z[n // 2], where),
    ]


def flexible(values: Values, sizes: Sizes) -> LinearRotor:
    n = sizes.stations
    z = [values[f"station[{j}].z"] for j in range(1, n + 1)]
    ends = [_station_at(z, f"support[{s}].position", values) + 1 for s in (1, 2)]
    stiffness, damping = support_values(values)
    shaft: dict = {"bending_stiffness": values.get("bending_stiffness")}
    if sizes.shaft == "compliance":
        shaft = {"compliance": _symmetric(values, n - 2)}
    rotor = LinearRotor.flexible(
        stations=z,
        masses=[values[f"station[{j}].mass"] for j in range(1, n + 1)],
        supports=ends,
        support_stiffness=stiffness,
        support_damping=damping,
        internal_damping=values["internal_damping"],
        # one without amount may keep its default place, where there is no station
        unbalances=[u for u in unbalance_values(values, sizes) if u[1] != 0.0],
        **shaft,
    )
    # only the planes that carry something are ports
    ports = [_station_at(z, f"plane[{i}].position", values) for i in range(1, sizes.planes + 1)]
    return replace(rotor, planes=rotor.planes[ports])


def _shaft(sizes: Sizes, z: list[float]) -> list[Variable]:
    """How the shaft bends, by one of the two descriptions."""
    if sizes.shaft == "uniform":
        text = "E I of the uniform shaft"
        return [parameter("bending_stiffness", _STEEL_20_MM, "N.m2", text, minimum=0.0, above=True)]
    delta = beam_compliance(z, (0, len(z) - 1), _STEEL_20_MM)
    text = "Displacement at one by a unit force at the other of the stations that are no supports"
    return [
        parameter(f"compliance[{j + 1},{k + 1}]", float(delta[j, k]), "m/N", text)
        for j in range(len(delta))
        for k in range(j, len(delta))
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
    if not abs(z[nearest] - place) <= _ONTO * abs(z[-1] - z[0]):
        raise ValueError(f"{name} = {place!r} m: must be the place of a station, one of {z} m")
    return nearest
