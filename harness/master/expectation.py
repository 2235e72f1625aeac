"""What is expected of the errors of a scene's runs before any of them is known."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..scene import Scene

ORDER = 4  # of the coupling by cubic signals
# forces or accelerations that jump within a step: three runs may show more by chance; motion with
# collisions, met ones too, is no smooth function of the steps' errors
ORDER_OF_JUMPS = 1
# steps end where something sticks or a motor's slope jumps: the error in the time of a nearly
# missed event is the root of the error of the signals
ORDER_OF_EVENTS = 2
# by so much lower is the order by which two runs state their error: by the full order 6 of 328 runs
# of the truth study erred by 3 to 6.6 times what they stated; under a motor by more: it starts in
# a few steps that are too long for their order to show
CAUTION, MOTOR_CAUTION = 1, 2


class Expectation(NamedTuple):
    """How the errors of runs should shrink with the length of their steps.

    Attributes:
        order: the highest with which they shrink.
        steepest_order: as much as an error is trusted to shrink from one run to the next.
        caution: by so much lower is the order by which two runs state their error.
        ends_at_events: whether steps end where something sticks, or a motor's slope jumps.
        can_collide: whether weights can; neighbouring motions may then part.
        fastest: vibration of the rotor without damping [rad/s]: longer steps do not follow it.
    """

    order: int
    steepest_order: float
    caution: int
    ends_at_events: bool
    can_collide: bool
    fastest: float


def expectation(scene: Scene, meets_events: bool) -> Expectation:
    """Of a scene's runs.

    Args:
        meets_events: whether steps end where a stop is touched, or weights or supports stick.
    """
    can_collide = any(balancer.can_meet for balancer in scene.balancer)
    motor = scene.operation.motor
    has_corners = motor is not None and len(motor.table or ()) > 2
    jumps = can_collide or has_corners or (scene.has_events and not meets_events)
    order = ORDER_OF_JUMPS if jumps else ORDER
    return Expectation(
        order=order,
        steepest_order=max(order, ORDER_OF_EVENTS) if has_corners else math.inf,
        caution=MOTOR_CAUTION if motor else CAUTION,
        ends_at_events=scene.has_events or has_corners,
        can_collide=can_collide,
        fastest=_fastest(scene),
    )


def _fastest(scene: Scene) -> float:
    """Of the rotor's vibrations without damping [rad/s]."""
    rotor = scene.assembly().loaded_rotor.at_top
    squares = (np.linalg.solve(rotor.mass, k) for k in (rotor.stiffness_x, rotor.stiffness_y))
    return math.sqrt(max(0.0, *(np.linalg.eigvals(each).real.max() for each in squares)))
