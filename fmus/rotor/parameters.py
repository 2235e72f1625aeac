"""Parameters of each kind of rotor."""

from __future__ import annotations

from collections.abc import Sequence

from ...models.constants import DEFAULT_UNBALANCE, SPACING, SPAN, STEEL_20_MM
from ..variables import Variable, not_negative, parameter, positive, tunable
from .matrices import amount, matrices
from .sizes import RotorSizes


def planar(sizes: RotorSizes) -> list[Variable]:
    """A disc in its plane: Filimonikhina 2017, Dubovik 2006."""
    if sizes.stations != 1:
        raise ValueError(f"stations = {sizes.stations!r}: a planar rotor has exactly 1")
    return [
        positive("mass", 2.0, "kg", "Mass of the disc without weights or liquid"),
        not_negative("stiffness_x", 8.0e4, "N/m", "Stiffness of the supports along x"),
        not_negative("stiffness_y", 8.0e4, "N/m", "Stiffness of the supports along y"),
        not_negative("damping_x", 40.0, "N.s/m", "Damping of the supports along x"),
        not_negative("damping_y", 40.0, "N.s/m", "Damping of the supports along y"),
        not_negative("internal_damping", 0.0, "N.s/m", "Damping inside the turning shaft"),
        tunable("unbalance", DEFAULT_UNBALANCE, "kg.m", "Unbalance of the rotor", minimum=0.0),
        tunable("unbalance_angle", 0.0, "rad", "Angle of the unbalance in the rotor"),
    ]


def two_support(sizes: RotorSizes) -> list[Variable]:
    """A rigid body on two supports: Polushkin 2016."""
    if sizes.stations != 2:
        raise ValueError(
            f"stations = {sizes.stations!r}: a rotor on two supports has exactly 2, its supports"
        )
    places = [SPAN * i / (sizes.planes + 1) for i in range(1, sizes.planes + 1)]
    where = "Distance from support 1"
    return [
        positive("mass", 12.0, "kg", "Mass of the rotor without weights or liquid"),
        positive("inertia", 0.7, "kg.m2", "Transverse moment of inertia about the centre of mass"),
        not_negative("polar_inertia", 0.1, "kg.m2", "Moment of inertia about the axis of rotation"),
        positive("span", SPAN, "m", "Distance between the supports"),
        parameter("com", SPAN / 2.0, "m", "Distance of the centre of mass from support 1"),
        *_supports(2.0e5, 150.0),
        *_planes(places, where),
        *_unbalances(sizes, places[0], where),
    ]


def flexible(sizes: RotorSizes) -> list[Variable]:
    """Discs on an elastic shaft: Filimonikhin 2011."""
    n = sizes.stations
    if n < 2:
        raise ValueError(f"stations = {n!r}: a flexible rotor has at least 2, its supports")
    z = [SPACING * j for j in range(n)]
    where = "Place on the shaft, which is that of a station"
    discs = [
        v
        for j, place in enumerate(z, start=1)
        for v in (
            parameter(
                f"station[{j}].z",
                place,
                "m",
                "Place of the station on the shaft, beyond the one before",
            ),
            positive(f"station[{j}].mass", 1.0, "kg", "Mass of the disc at the station"),
        )
    ]
    places = [z[(i + n // 2) % n] for i in range(sizes.planes)]
    softest = "Damping inside the turning shaft, where it is softest"
    return [
        *discs,
        parameter("support[1].position", z[0], "m", where),
        parameter("support[2].position", z[-1], "m", where),
        *_supports(2.0e5, 150.0),
        *_shaft(sizes, z),
        not_negative("internal_damping", 0.0, "N.s/m", softest),
        *_planes(places, where),
        *_unbalances(sizes, z[n // 2], where),
    ]


PARAMETERS = {
    "planar": planar,
    "two_support": two_support,
    "flexible": flexible,
    "matrices": matrices,
}


def _supports(stiffness: float, damping: float) -> list[Variable]:
    return [
        parameter(f"support[{s}].{what}_{axis}", start, unit,
                  f"{what.capitalize()} of support {s} along {axis}", minimum=0.0, above=above)
        for s in (1, 2)
        for what, start, unit, above in (
            ("stiffness", stiffness, "N/m", True),
            ("damping", damping, "N.s/m", False),
        )
        for axis in "xy"
    ]  # fmt: skip


def _planes(places: Sequence[float], where: str) -> list[Variable]:
    return [
        parameter(f"plane[{i}].position", place, "m", where) for i, place in enumerate(places, 1)
    ]


def _unbalances(sizes: RotorSizes, place: float, where: str) -> list[Variable]:
    return [
        v
        for k in range(1, sizes.unbalances + 1)
        for v in (
            parameter(f"unbalance[{k}].position", place, "m", where),
            *amount(k),
        )
    ]


def _shaft(sizes: RotorSizes, z: Sequence[float]) -> list[Variable]:
    """How the shaft bends, by one of the two descriptions."""
    if sizes.shaft == "uniform":
        text = "Bending stiffness E I of the uniform shaft"
        return [positive("bending_stiffness", STEEL_20_MM, "N.m2", text)]
    text = "Displacement of a station by a unit force at another, neither a support"
    inner = range(1, len(z) - 1)
    return [
        parameter(f"compliance[{j},{k}]", _compliance(z[j], z[k], z[-1]), "m/N", text)
        for j in inner
        for k in inner
        if j <= k
    ]


def _compliance(a: float, b: float, span: float) -> float:
    """Displacement at a by a unit force at b >= a of a uniform shaft supported at 0 and span."""
    rest = span - b
    return a * rest * (span**2 - rest**2 - a**2) / (6.0 * span * STEEL_20_MM)
