"""What runs of one motion are compared by, when a tolerance is kept."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from ..scene import Scene
from .expectation import Expectation, expectation
from .limits import BEYOND_LONGEST_STEP, FEWEST_CHOSEN
from .names import displacements, kin
from .plan import MOTOR
from .recorder import Recorder, Signal
from .scales import least_motion
from .schedule import step_size

# of the motion: where two runs differ by more, their difference need not follow the order
ASYMPTOTIC = 0.03


class Compared(NamedTuple):
    """Of the runs of one motion.

    Attributes:
        expected: of their errors.
        signals: that together are the motion.
        least: of a finished run, by signal the value that its largest is taken to be at least.
        longest_step: beyond which a step holds its signals, as at rest [s].
    """

    expected: Expectation
    signals: list[str]
    least: Callable[[Recorder], dict[str, float]]
    longest_step: float


def compared_motion(scene: Scene, meets_events: bool) -> Compared:
    """Of a scene's runs.

    Args:
        meets_events: whether steps end where a stop is touched, or weights or supports stick.
    """

    def least(recorder: Recorder) -> dict[str, float]:
        by_unit = least_motion(scene)
        return {name: by_unit.get(unit, 0.0) for name, unit in recorder.signal_units.items()}

    longest = BEYOND_LONGEST_STEP * step_size(scene, FEWEST_CHOSEN)
    return Compared(expectation(scene, meets_events), motion_signals(scene), least, longest)


def motion_signals(scene: Scene) -> list[str]:
    """Signals that together are the motion of a scene."""
    names = displacements(len(scene.rotor.points))
    names += [f"{MOTOR}.speed"] if scene.operation.motor else []
    return names + [f"{b.label}.{v}" for b in scene.balancer for v in b.records if v != "clearance"]


NEVER_HELD = math.inf  # longest step of runs that never rest


def largest_difference(
    one: Mapping[str, Signal],
    other: Mapping[str, Signal],
    least: Mapping[str, float],
    at: slice = slice(None),
) -> float:
    """Largest difference of signals at some common times, each over the largest value of its kind.

    The kind of x is x and y of its station; of a part of a vector in the rotor, the vector; of any
    other signal, the signal.  An angle is divided by 1 rad.

    Args:
        least: by signal, the smallest that the largest value is taken to be.
    """
    # the rotor's angle is exact, and a clearance what is left of a gap
    compared = [n for n in other if n != "rotor.angle" and not n.endswith(".clearance")]
    sizes = {n: max(least[n], float(np.abs(other[n]).max())) for n in compared}
    worst = 0.0
    for name in compared:
        gap = float(np.abs(other[name] - one[name])[at].max(initial=0.0))
        scale = 1.0 if is_angle(name) else max(sizes[each] for each in kin(name, compared))
        worst = max(worst, gap / scale if scale else gap)
    return worst


def is_angle(name: str) -> bool:
    """Whether a signal is an angle of a weight, whose error is stated in rad."""
    return name.endswith("angle")
