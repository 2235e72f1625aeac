"""What supports, feet and handles feel: the part of a motion that turns with the rotor."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ...models.arrays import Complex
from ...models.bodies import Places
from ...models.forces import forces, hand_weight
from ...models.linear.synchronous import synchronous
from ...models.rotor import LinearRotor
from ..errors import UserError
from ..master.names import along_axes
from ..output.table import Sheet
from ..scene import Scene

if TYPE_CHECKING:
    from .result import Result

LAST = 10  # revolutions at the end of a run that are looked at
LAST_OF_FREE = 100  # of a machine that nothing holds: it tilts slowly, undamped
COUPLE = 1e-9  # of the sum of sizes: a static unbalance that is rounding
ZONES = "ABCD"
HEADS = (
    "place", "force [N]", "transmissibility [1]", "velocity rms [m/s]", "zone",
    "acceleration rms [m/s^2]", "weighted [m/s^2]",
)  # fmt: skip


def support_sheet(scene: Scene, rotor: LinearRotor, motion: Complex, speed: float) -> Sheet:
    """A row for every support, foot and handle.

    The force is the largest of its orbit, 0-peak, without the weight; the transmissibility is that
    over U w^2, of the static unbalance U: a couple has none.  The velocity is that of a body at its
    foot along the axis where it is larger: housings and feet have zones, a shaft has none.  The
    acceleration at a handle is the sum of both axes, and weighted for hands.

    Args:
        motion: (2, n) complex amplitudes of x and y at this speed [rad/s], 0-peak [m].
    """
    static, parts = abs(complex(rotor.unbalance.sum())), float(np.abs(rotor.unbalance).sum())
    pull = static * speed**2 if static > COUPLE * parts else 0.0
    places = _places(scene, rotor)
    feet = {
        f"{body.name}.foot[{k}]": places.row(body.name, foot.position)
        for body in scene.rotor.bodies
        for k, foot in enumerate(body.feet, start=1)
    }
    rows: list[tuple[object, ...]] = []
    for one in forces(rotor, motion, speed):
        share: float | str = one.amplitude / pull if pull else ""
        rate: float | str = ""
        if one.name in feet:
            rate = speed * float(np.abs(motion @ feet[one.name]).max()) / math.sqrt(2.0)
        rows.append((one.name, one.amplitude, share, rate, _zone(scene, rate), "", ""))
    for body in scene.rotor.bodies:
        for handle in body.handles:
            moved = motion @ places.row(body.name, handle.position)
            felt = speed**2 * float(np.linalg.norm(moved)) / math.sqrt(2.0)
            weighted = felt * hand_weight(speed / math.tau)
            rows.append((f"{body.name}.{handle.name}", "", "", "", "", felt, weighted))
    limits = scene.rotor.zone_limits
    said = "" if limits is None else "; zones by the limits of the scene, which is no certificate"
    return Sheet(HEADS, rows, "lrrrlrr", f"{scene.heading}: forces at {speed:.6g} rad/s{said}")


def of_run(result: Result) -> Sheet:
    """`support_sheet` of the last revolutions of a run.

    Raises:
        UserError: the result does not know its scene, or the speed changes at its end.
    """
    scene = result.scene
    if scene is None:
        raise UserError("forces: the result does not know its scene")
    profile, end = scene.profile(), float(result.time[-1])
    speed = profile.speed(end)
    last = LAST_OF_FREE if scene.rotor.is_free else LAST
    span = last * math.tau / speed if speed else math.inf
    if scene.operation.motor or not speed or profile.speed(max(0.0, end - span)) != speed:
        raise UserError(
            f"forces: are those of a constant speed over the last {last} revolutions: run longer "
            "at the end, or at a constant speed"
        )
    late = result.time >= end - span
    angle = scene.run.initial.angle + profile.angles_at(result.time[late])
    rotor = scene.assembly().at(end).resting_rotor  # of supports and places alone
    x, y = along_axes(rotor.stations)
    samples = np.array([result[name][late] for name in (*x, *y)])
    motion = synchronous(angle, samples, scene.rotor.is_free).reshape(2, rotor.stations)
    return support_sheet(scene, rotor, motion, speed)


def _places(scene: Scene, rotor: LinearRotor) -> Places:
    table = scene.rotor
    own = len(table.points) - len(table.support_positions) * len(table.bodies)
    bodies = [body.build() for body in table.bodies]
    return Places(table.support_positions, rotor.planes[:, :own], table.planes, bodies)


def _zone(scene: Scene, rate: float | str) -> str:
    limits = scene.rotor.zone_limits
    if limits is None or isinstance(rate, str):
        return ""
    return ZONES[sum(rate > limit for limit in limits)]
