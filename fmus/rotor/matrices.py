"""Parameters of a rotor by its matrices."""

from __future__ import annotations

from collections.abc import Sequence

from ...models.constants import DEFAULT_UNBALANCE
from ..variables import Variable, parameter, tunable
from .sizes import RotorSizes

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


def matrices(sizes: RotorSizes) -> list[Variable]:
    """Any linear rotor: its matrices between stations, each a displacement."""
    n = sizes.stations
    bends = range(1, max(2, n - 1))
    numbers = range(1, n + 1)
    return [
        *(parameter(f"{name}[{j},{k}]", start * (j == k), unit, text)
          for j in numbers for k in numbers for name, (unit, start, text) in GIVEN.items()),
        *_rows("plane_row", range(1, sizes.planes + 1), n, "Displacement of the plane"),
        *(v for k in range(1, sizes.unbalances + 1) for v in amount(k)),
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


def amount(k: int) -> list[Variable]:
    """Amount and angle of the unbalance of a number; the first is there by default."""
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
