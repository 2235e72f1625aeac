"""Parameters of each kind of rotor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ...models.constants import DEFAULT_UNBALANCE, SPACING, SPAN, STEEL_20_MM
from ..unit import Sizes, count, one_of
from ..variables import Variable, not_negative, parameter, positive, tunable

# matrices of a rotor between two stations: unit, start on the diagonal, description
_FORCE = "Force along {} on a station by the {} along {} of another, of supports{}"
GIVEN: dict[str, tuple[str, float, str]] = {
    "mass": ("kg", 1.0, "Mass matrix, the same along both axes"),
    **{
        f"damping_{to}{by}": ("N.s/m", 40.0 * (to == by), _FORCE.format(to, "velocity", by, ""))
        for to in "xy" for by in "xy"
    },
    **{
        f"stiffness_{to}{by}": ("N/m", 8.0e4 * (to == by),
                                _FORCE.format(to, "displacement", by, " and shaft"))
        for to in "xy" for by in "xy"
    },
    "internal_damping": ("N.s/m", 0.0, "Damping matrix of the turning shaft"),
    "gyroscopic": ("kg", 0.0, "Gyroscopic matrix, multiplied by the speed"),
}  # fmt: skip

# of the force of a support or foot by the motion of a station: unit and description
FORCES: dict[str, tuple[str, str]] = {
    f"force_{what}_{to}{by}": (unit, f"Force of a support, then foot, along {to} by the {motion} "
                               f"of a station along {by}")
    for what, unit, motion in (("stiffness", "N/m", "displacement"),
                               ("damping", "N.s/m", "velocity"))
    for to in "xy" for by in "xy"
}  # fmt: skip

# of a bearing over the speed, in each row of its table: unit and description
TABLED: dict[str, tuple[str, str]] = {
    f"table_{what}_{to}{by}": (unit, f"Force along {to} by the {motion} along {by}")
    for what, unit, motion in (("stiffness", "N/m", "displacement"),
                               ("damping", "N.s/m", "velocity"))
    for to in "xy" for by in "xy"
}  # fmt: skip


@dataclass(frozen=True)
class RotorSizes(Sizes):
    """Sizes of a rotor.

    Attributes:
        kind: planar | two_support | flexible | matrices.
        stations, planes, unbalances, sliders: numbers of them.
        cubics, stops: springs that are not linear, and stops.
        tables, speeds: bearings that change with the speed, and rows of their tables.
        shaft: how a flexible rotor's is given: "uniform" (bending stiffness) or "compliance" (a
            matrix).
        supports, feet: of a rotor by its matrices, those whose forces are outputs.
    """

    kind: str = one_of("planar", "two_support", "flexible", "matrices")
    stations: int = count(1)
    planes: int = count(1)
    unbalances: int = count(1, of=("two_support", "flexible", "matrices"))
    shaft: str = one_of("uniform", "compliance", of=("flexible",))
    sliders: int = count(0)
    tables: int = count(0, of=("matrices",))
    speeds: int = count(0, of=("matrices",))
    supports: int = count(0, of=("matrices",), native=False)
    feet: int = count(0, of=("matrices",), native=False)
    cubics: int = count(0)
    stops: int = count(0)

    @property
    def forces(self) -> list[str]:
        """Supports, then feet, whose forces are outputs."""
        known = {"planar": 1, "two_support": 2, "flexible": 2}.get(self.kind, self.supports)
        if known > 2:
            raise ValueError(f"supports = {known}: a rotor has at most 2")
        supports = [f"support[{k}]" for k in range(1, known + 1)]
        return supports + [f"foot[{k}]" for k in range(1, self.feet + 1)]


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


def friction(sizes: RotorSizes) -> list[Variable]:
    """Sliders in parallel with the supports' springs: dry friction, each axis for itself; of given
    matrices across rows of the stations, more than one only behind a spring."""
    text = "Stiffness of the spring in series with the slider along {}; 0: none"
    stroke = "Way along {} from one end of the free stroke, without force, to the other"
    centre = "Displacement along {} in the middle of the free stroke at the start"
    given = sizes.kind == "matrices"
    support = "Number of the support that has it"
    if given:
        support = "Number of the force, of supports and then of feet, that it is part of"
    numbers = range(1, sizes.sliders + 1)
    rows = _rows_of_axes("slider_row", numbers, sizes.stations) if given else []
    sliders = [
        v
        for k in numbers
        for v in (
            parameter(f"slider[{k}].support", 1.0, "1", support, minimum=1.0),
            *(not_negative(f"slider[{k}].limit_{axis}", 0.0, "N", f"Largest friction along {axis}")
              for axis in "xy"),
            *(not_negative(f"slider[{k}].stiffness_{axis}", 0.0, "N/m", text.format(axis))
              for axis in "xy"),
            *(not_negative(f"slider[{k}].free_stroke_{axis}", 0.0, "m", stroke.format(axis))
              for axis in "xy"),
            *(parameter(f"slider[{k}].centre_{axis}", 0.0, "m", centre.format(axis))
              for axis in "xy"),
        )
    ]  # fmt: skip
    ends = "Shortest step that ends where a slider sticks, lets go or turns, or a stop is touched"
    own = [not_negative("shortest_stopped_step", 0.0, "s", f"{ends}; 0: none does")]
    return [*rows, *sliders, *own[: sizes.sliders + sizes.stops]]


def restraints(sizes: RotorSizes) -> list[Variable]:
    """Cubic springs and stops, across a row of the stations along each axis."""
    cubics, stops = range(1, sizes.cubics + 1), range(1, sizes.stops + 1)
    axes = "0: the first stiffness pulls along the displacement; 1: each along its own axis"
    limit = "Displacement up to which the spring is known; 0: any"
    support = "Number of the force, of supports and then of feet, that it is part of; 0: of none"
    gap = "Displacement from which the stop pushes back; a row of 0 for an axis leaves it out"
    return [
        *(v for k in cubics for v in (
            *(parameter(f"cubic[{k}].stiffness_{axis}", 0.0, "N/m3",
                        f"Force along {axis} by the cube of the displacement") for axis in "xy"),
            not_negative(f"cubic[{k}].axes", 0.0, "1", axes),
            not_negative(f"cubic[{k}].limit", 0.0, "m", limit),
            not_negative(f"cubic[{k}].support", 1.0, "1", support),
        )),
        *_rows_of_axes("cubic_row", cubics, sizes.stations),
        *(v for k in stops for v in (
            positive(f"stop[{k}].gap", 1e-3, "m", gap),
            positive(f"stop[{k}].stiffness", 1e5, "N/m", "Stiffness of the stop"),
            not_negative(f"stop[{k}].damping", 0.0, "N.s/m", "Damping of the stop; it never pulls"),
            not_negative(f"stop[{k}].support", 1.0, "1", support),
        )),
        *_rows_of_axes("stop_row", stops, sizes.stations),
    ]  # fmt: skip


def _rows_of_axes(name: str, of: Sequence[int], stations: int) -> list[Variable]:
    """Rows along x and along y; each starts at one station."""
    return [
        parameter(f"{name}_{axis}[{k},{j}]", float((k - 1) % stations == j - 1), "1",
                  f"Displacement along {axis} by that of a station")
        for k in of for j in range(1, stations + 1) for axis in "xy"
    ]  # fmt: skip


def matrices(sizes: RotorSizes) -> list[Variable]:
    """Any linear rotor: its matrices between stations, each a displacement."""
    n = sizes.stations
    bends = range(1, max(2, n - 1))
    numbers = range(1, n + 1)
    return [
        *(parameter(f"{name}[{j},{k}]", start * (j == k), unit, text)
          for j in numbers for k in numbers for name, (unit, start, text) in GIVEN.items()),
        *_rows("plane_row", range(1, sizes.planes + 1), n, "Displacement of the plane"),
        *(v for k in range(1, sizes.unbalances + 1) for v in _amount(k)),
        *_rows("unbalance_row", range(1, sizes.unbalances + 1), n,
               "Displacement where the unbalance is"),
        *(parameter(f"bending_row[{j},{k}]", 0.0, "1", "Bending of the shaft by a station's motion")
          for j in bends for k in numbers),
        *_tables(sizes),
        *_forces(sizes),
    ]  # fmt: skip


def _forces(sizes: RotorSizes) -> list[Variable]:
    """What the forces of supports, then feet, follow from."""
    numbers, stations = range(1, len(sizes.forces) + 1), range(1, sizes.stations + 1)
    table = "Number of the table of the bearing over the speed that it is of; 0: none"
    return [
        *(parameter(f"force[{k}].table", 0.0, "1", table, minimum=0.0) for k in numbers),
        *(parameter(f"{name}[{k},{j}]", 0.0, unit, text)
          for k in numbers for j in stations for name, (unit, text) in FORCES.items()),
    ]  # fmt: skip


def _tables(sizes: RotorSizes) -> list[Variable]:
    """Bearings that change with the speed, on lines between the rows of a table."""
    tables, rows = range(1, sizes.tables + 1), range(1, sizes.speeds + 1)
    if bool(tables) != (len(rows) > 1):
        raise ValueError(f"speeds = {sizes.speeds}: tables have 2 or more, a rotor without has 0")
    text = "Speed of this row of all tables, above that of the row before"
    return [
        *(parameter(f"table_speed[{k}]", 100.0 * k, "rad/s", text) for k in rows),
        *_rows("table_row", tables, sizes.stations, "Displacement across the bearing"),
        *(parameter(f"{name}[{t},{k}]", 0.0, unit, f"{text}, in a bearing at this speed")
          for t in tables for k in rows for name, (unit, text) in TABLED.items()),
    ]  # fmt: skip


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
            *_amount(k),
        )
    ]


def _amount(k: int) -> list[Variable]:
    return [
        tunable(f"unbalance[{k}].amount", DEFAULT_UNBALANCE * (k == 1), "kg.m",
                "Amount of the unbalance", minimum=0.0),
        tunable(f"unbalance[{k}].angle", 0.0, "rad", "Angle of the unbalance in the rotor"),
    ]  # fmt: skip


def _rows(name: str, of: Sequence[int], stations: int, what: str) -> list[Variable]:
    """Rows of numbers by which something follows the stations; each starts at one station."""
    return [
        parameter(f"{name}[{j},{k}]", float((j - 1) % stations == k - 1), "1",
                  f"{what} by that of a station")
        for j in of
        for k in range(1, stations + 1)
    ]  # fmt: skip


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
