"""Parameters of what is not linear in the supports: dry friction, cubic springs, stops."""

from __future__ import annotations

from collections.abc import Sequence

from ..variables import Variable, not_negative, parameter, positive
from .sizes import RotorSizes


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
