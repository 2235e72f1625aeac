"""Variables of the motor of limited power."""

from __future__ import annotations

from dataclasses import dataclass

from ..unit import Sizes, Unit, count
from ..variables import (
    Variable,
    observed,
    output,
    parameter,
    positive,
    signal_inputs,
    signal_outputs,
)


@dataclass(frozen=True)
class MotorSizes(Sizes):
    """Sizes of a motor.

    Attributes:
        points: of its characteristic.
    """

    points: int = count(2)


def variables(sizes: MotorSizes) -> list[Variable]:
    """Inertia and characteristic, the torque on the shaft, how the rotor turns.

    Raises:
        ValueError: a characteristic of fewer than two points.
    """
    if sizes.points < 2:
        raise ValueError(f"points = {sizes.points}: must be 2 or more")
    last = sizes.points - 1
    points = [f"point[{k}]" for k in range(1, sizes.points + 1)]
    line = tuple(f"{point}.{what}" for what in ("speed", "torque") for point in points)
    drive = ("speed0", *line)
    torque = ("torque", "der(torque)")
    return [
        positive("inertia", 0.1, "kg.m2", "Inertia of all that turns, unbalance included"),
        *(
            variable
            for k, point in enumerate(points)
            for variable in (
                parameter(f"{point}.speed", 300.0 * k / last, "rad/s",
                          "Speed at the point, above the one before"),
                parameter(f"{point}.torque", 10.0 * (last - k) / last, "N.m",
                          "Torque of the motor at the point's speed"),
            )
        ),
        parameter("angle0", 0.0, "rad", "Angle of the rotor at the start"),
        parameter("speed0", 0.0, "rad/s", "Speed of the rotor at the start"),
        *signal_inputs(["torque"], "torque", "Sum of all other torques on the shaft"),
        *signal_outputs(
            ["acceleration"], "angular acceleration", "Angular acceleration of the rotor",
            [torque[:1]], [torque],
            begins=("inertia", *drive),
        ),
        output("speed", "rad/s", "Speed of the rotor", begins=("speed0",)),
        observed("angle", "rad", "Angle turned by the rotor", ("angle0",)),
        observed("drive_torque", "N.m", "Torque of the motor at the present speed", drive),
        observed("power", "W", "Power of the motor", drive),
    ]  # fmt: skip


MOTOR = Unit(
    name="Motor",
    summary="Motor of limited power: the torque on its shaft in, speed and acceleration out.",
    sizes=MotorSizes,
    variables=variables,
    native=True,
)
