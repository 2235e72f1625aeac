"""Where the weights balance, in closed form, and what the rotor sees of them.

All weights but two in every plane stand at given angles; these two carry what is left,
e^{i a} + e^{i b} = z, which has a solution where |z| <= 2.  The rotor sees of the N weights of a
balancer sum e^{2 i theta} alone (Filimonikhin 2011 (11)), and e^{2 i a} + e^{2 i b} =
(|z|^2 - 2) z/conj z: no angle is solved for.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from flint import arb

from .arrays import Unproved, balls
from .rotors import RotorBalls
from .slopes import Exact, Number, ball


@dataclass(frozen=True, eq=False)
class WeightBalls:
    """The weights of one balancer.

    Attributes:
        plane: index of its plane.
        count: number of weights.
        mass, track_radius, drag, kappa: of each, as in `Weights`.
        angles: (count,) near which they stand in the rotor [rad].
    """

    plane: int
    count: int
    mass: Number
    track_radius: Number
    drag: Number
    kappa: Number
    angles: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class Seen:
    """What the rotor sees of one balancer: rates v (r,) of its moment, v' = -d v - drive a.

    Attributes:
        plane: index of its plane.
        rate: d [1/s].
        basis: (2, r) directions of the moment.
        drive: (r, 2) by the acceleration of the plane [kg].
        free: number of turns of the weights that leave the moment as it is.
    """

    plane: int
    rate: Number
    basis: Exact
    drive: Exact
    free: int


def seen(rotor: RotorBalls, weights: Sequence[WeightBalls]) -> list[Seen]:
    """The balancers in the balanced position.

    Raises:
        Unproved: no balanced position is proved to exist.
    """
    if not weights:
        return []
    pairs = _pairs(rotor, weights)
    loads = list(rotor.unbalances)
    squares = [balls([0, 0]) for _ in weights]
    paired = list(itertools.chain.from_iterable(pairs.values()))
    for b, device in enumerate(weights):
        for k, angle in enumerate(device.angles):
            if (b, k) not in paired:
                squares[b] = squares[b] + _unit(2 * arb(angle))
                moment = device.mass * device.track_radius
                loads.append((rotor.places[device.plane], _unit(arb(angle)) * moment))
    in_line: dict[int, Exact] = {}
    for (plane, pair), load in zip(pairs.items(), rotor.at_planes(list(pairs), loads), strict=True):
        first, device = pair[0][0], weights[pair[0][0]]
        x, y = -load / (device.mass * device.track_radius)
        size = x * x + y * y
        if ball(size).is_zero() and len(device.angles) == 2:
            t = arb(device.angles[0])
            squares[first] = squares[first] + 2 * _unit(2 * t)
            in_line[first] = balls([[-t.sin()], [t.cos()]])
            continue
        if not size < 4 or not size > 0:
            raise Unproved(
                f"plane {plane + 1}: two weights are not proved to carry what the others leave of "
                f"the unbalance: {float(ball(size).abs_upper().sqrt()):.6g} times the moment of "
                "one, must be more than 0 and less than 2"
            )
        along = np.array([x * x - y * y, 2 * x * y], object)
        squares[first] = squares[first] + along * ((size - 2) / size)
    return [_of(weights[b], squares[b], in_line.get(b)) for b in range(len(weights))]


def _unit(angle: arb) -> Exact:
    return balls([angle.cos(), angle.sin()])


def _pairs(
    rotor: RotorBalls, weights: Sequence[WeightBalls]
) -> dict[int, tuple[tuple[int, int], tuple[int, int]]]:
    """For every plane the two weights (balancer, number) that stand least in line."""
    best: dict[int, tuple[float, tuple[tuple[int, int], tuple[int, int]]]] = {}
    for b, device in enumerate(weights):
        for j, k in itertools.combinations(range(device.count), 2):
            across = abs(math.sin(device.angles[j] - device.angles[k]))
            if device.plane not in best or across > best[device.plane][0]:
                best[device.plane] = across, ((b, j), (b, k))
    for device in weights:
        if device.plane not in best:
            raise Unproved(
                f"plane {device.plane + 1} carries a single weight: it balances an unbalance of "
                "exactly its own moment alone, which no rounded number is"
            )
    most = rotor.planes.shape[1]
    return {plane: best[plane][1] for plane in list(best)[:most]}


def _of(device: WeightBalls, square: Exact, line: Exact | None) -> Seen:
    share, count = device.mass / device.kappa, device.count
    rate = device.drag / (device.kappa * device.mass)
    if line is not None:
        return Seen(device.plane, rate, line, line.T * (count * share), count - 1)
    x, y = square
    across = balls([[(count - x) / 2, -y / 2], [-y / 2, (count + x) / 2]])
    if not x * x + y * y < count * count:
        raise Unproved(f"plane {device.plane + 1}: its weights are not proved to be out of line")
    return Seen(device.plane, rate, balls(np.eye(2)), across * share, count - 2)
