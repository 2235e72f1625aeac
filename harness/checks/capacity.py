"""Weights of finite size: what they leave of an unbalance, and Table 1 of Goncharov 2017."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator

import numpy as np

from ...models.papers import capacity as theory
from ...models.papers.settling import plane_response
from ..errors import SceneError
from ..result.result import Result
from ..result.run import cosimulate
from ..scene import Scene
from .goncharov import only_finite_weights
from .row import Row, Rows

POINTS, UP_TO = 13, 1.2  # unbalances from 0 on, the largest in capacities S
RESIDUAL = 1e-3  # of the capacity: what has not settled when the run ends
ANGLES = 1e-3  # rad: the same
SOURCE = "Goncharov 2017 (5)"

# n, rho, sector [degrees] (none for one weight), s, as printed
TABLE = {
    "balls": (
        (1, 3 / 4, None, 0.105), (2, 3 / 7, 194, 0.060), (3, 0.364, 209, 0.051),
        (4, 0.315, 219, 0.044), (5, 0.278, 226, 0.037), (6, 0.248, 231, 0.031),
        (7, 0.224, 235, 0.027), (8, 0.204, 238, 0.023),
    ),
    "rollers": (
        (1, 2 / 3, None, 0.148), (2, 2 / 5, 167, 0.143), (3, 1 / 3, 180, 0.148),
        (4, 0.286, 189, 0.145), (5, 0.251, 195, 0.140), (6, 0.223, 201, 0.133),
        (7, 0.201, 205, 0.126), (8, 0.183, 208, 0.119),
    ),
}  # fmt: skip
DIGIT = 1.0001e-3  # of s: a whole last digit, for the print cuts one off, and rounding
RATIO = 5.001e-4
SECTOR = 1.0  # degrees
FASTEST = {"balls": 3, "rollers": 5}


def check_capacity(scene: Scene, points: int = POINTS) -> Iterator[Row]:
    """Residual unbalance, as the vibration shows it, from no unbalance to more than the capacity.

    Raises:
        SceneError: the scene is not a planar isotropic rotor at constant speed with one set of
            weights of finite size.
    """
    balls = only_finite_weights(scene)
    if balls is None or balls.weight_radius is None or balls.unequal:
        raise SceneError(
            f"{scene.label}: check capacity: needs a planar rotor with equal stiffness and damping "
            "in x and y at constant speed, and one set of equal weights with weight_radius"
        )
    weights, limit = balls.device, balls.capacity
    speed = scene.profile().speed(0.0)
    response = plane_response(scene.assembly().loaded_rotor, speed)
    rows = Rows(scene.name, "capacity")
    for part in np.linspace(0.0, UP_TO, points):
        unbalance = float(part) * limit
        angles = [f"{balls.label}.weight[{k}].angle" for k in range(1, balls.count + 1)]
        result = cosimulate(
            scene.replace({"rotor.unbalance": unbalance, "rotor.unbalance_angle": 0.0}),
            record=["rotor.x", "rotor.y", *angles],
            separate=not scene.has_events,
        )
        shown = _amplitude(result, speed) * speed**2 / abs(response)
        expected = theory.residual_unbalance(weights, balls.weight_radius, unbalance)
        yield rows.number(
            f"unbalance {part:.3g} S: residual [kg m]", expected, shown, RESIDUAL, SOURCE, limit
        )
        if unbalance > limit:
            turn = packed_turn(response, limit / unbalance)
            packed = np.array(theory.packed_angles(weights, balls.weight_radius, turn))
            ended = np.array([result[name][-1] for name in angles])
            yield rows.number(
                f"unbalance {part:.3g} S: packed angles [rad]",
                packed,
                packed + np.array(_nearest(ended, packed)),
                ANGLES,
                f"{SOURCE}, turned by {turn:.4f} rad by the rotor's damping",
                1.0,
            )


def packed_turn(response: complex, share: float) -> float:
    """Angle by which a packed group stands off the point opposite to the unbalance [rad].

    The group rests where the acceleration a = -Y (U - S e^{i delta}) of the plane has no part
    along the track, Im(Y (U e^{-i delta} - S)) = 0; the rotor's damping is the phase of Y.

    Args:
        response: Y, `settling.plane_response`, with Re Y < 0.
        share: S/U, less than 1.
    """
    phase = cmath.phase(-response)
    return phase - math.asin(share * math.sin(phase))


def _amplitude(result: Result, speed: float) -> float:
    """Of the whirl at the rotor's speed over the last revolution [m]."""
    turn = math.tau / speed * (1.0 + 1e-9)  # rounding must not lose its first point
    # at rest a step may be longer
    begin = min(int(np.searchsorted(result.time, result.time[-1] - turn)), len(result.time) - 2)
    whirl = result["rotor.x"] + 1j * result["rotor.y"]
    return float(abs(np.mean((whirl * np.exp(-1j * speed * result.time))[begin:-1])))


def _nearest(ended: np.ndarray, packed: np.ndarray) -> list[float]:
    """For each packed place, how far on the circle its nearest weight stands [rad]."""
    apart = (ended[None, :] - packed[:, None] + math.pi) % math.tau - math.pi
    return [float(row[np.argmin(np.abs(row))]) for row in apart]


def check_sizes(scene: Scene) -> Iterator[Row]:
    """Table 1: radius, sector and capacity of the best n weights; which number settles fastest."""
    rows = Rows(scene.name, "goncharov_table")
    source = "Goncharov 2017, Table 1"
    for kind, lines in TABLE.items():
        for count, ratio, sector, printed in lines:
            best = theory.best_ratio(kind, count)
            label = f"{count} {kind}: "
            yield rows.number(f"{label}rho", ratio, best, RATIO, source, 1.0)
            if sector is not None:
                filled = math.degrees(theory.filled_sector(best, count))
                yield rows.number(f"{label}sector [degrees]", sector, filled, SECTOR, source, 1.0)
            value = theory.capacity_shape(kind, best, count)
            note = ""
            if round(value, 3) != printed:
                note = ", cut off in print" if value > printed else ", rounded twice in print"
            yield rows.number(f"{label}s", printed, value, DIGIT, source + note, 1.0)
        fastest = theory.fastest_count(kind)
        yield rows.statement(
            f"{kind}: number that settles fastest",
            str(FASTEST[kind]),
            str(fastest),
            fastest == FASTEST[kind],
            "Goncharov 2017, Fig. 7",
        )
