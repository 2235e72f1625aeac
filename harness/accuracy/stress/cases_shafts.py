"""Stress cases of flexible shafts and rigid rotors on two supports, with weights in two planes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from functools import partial
from typing import Any

from .case import BOTH_WAYS, Case, Outcome, against_monolith, left_to_the_master


def _places(stations: Iterable[int]) -> tuple[str, ...]:
    return tuple(f"rotor.station[{j}].{axis}" for j in stations for axis in "xy")


# what a stiff support all but holds has no range, its weights neither: the rest is compared
_MOVING = {
    "supports of the shaft a thousand times as stiff": _places((1, 2, 3)),
    "one support of the shaft 1e10 times as stiff as the other": (
        *_places((1, 2)),
        *(f"left.moment_{axis}" for axis in ("xi", "eta")),
    ),
}
_MOMENTS = tuple(f"{name}.moment_{axis}" for name in ("left", "right") for axis in ("xi", "eta"))


def cases() -> Iterator[Case]:
    """Stiffness of shaft and supports, spinning tops, heavy weights, speeds far above and below."""
    shaft: dict[str, dict[str, Any]] = {
        "shaft a thousand times as stiff": {"rotor.compliance": [[0.5e-3]]},
        "shaft a hundred times as soft": {"rotor.compliance": [[50.0]]},
        "supports of the shaft a thousand times as stiff": {
            "rotor.support_stiffness": [1e3, 1e3],
            "rotor.support_damping": [6.0, 6.0],
        },
        "one support of the shaft 1e10 times as stiff as the other": {
            "rotor.support_stiffness": [1.0, 1e10],
            "rotor.support_damping": [0.2, 1e4],
        },
        "shaft with weights as heavy as its discs": {
            "left.mass": 0.15, "right.mass": 0.15, "left.drag": 1.5, "right.drag": 1.5,
        },
        "shaft at a hundred times its speed": {"operation.speed": 400.0},
    }  # fmt: skip
    rigid: dict[str, dict[str, Any]] = {
        "rigid rotor with the polar inertia of a disc": {"rotor.polar_inertia": 6.5},
        "rigid rotor on supports a thousand times as stiff": {
            "rotor.stiffness": [500.0, 500.0],
            "rotor.damping": [1.0, 1.0],
        },
        "rigid rotor with its centre of mass over a support": {"rotor.com": 0.0},
        "rigid rotor with both planes outside its supports": {"rotor.planes": [-6.0, 12.0]},
        "rigid rotor at a thousand times its speed": {"operation.speed": 4000.0},
    }
    for scene, extremes in (("three_mass_shaft", shaft), ("two_plane_rodrigues", rigid)):
        for name, changes in extremes.items():
            run = partial(_against, scene, changes, _MOVING.get(name))
            yield Case(name, BOTH_WAYS, run)


def _against(name: str, changes: Mapping[str, Any], moving: tuple[str, ...] | None) -> Outcome:
    build = left_to_the_master(name, changes)
    places = _places(range(1, len(build.rotor.points) + 1))
    return against_monolith(build, signals=moving or (*places, *_MOMENTS), rtol=1e-11)
