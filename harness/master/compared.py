"""What runs of one motion are compared by, when a tolerance is kept."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

from ...models.constants import BEYOND_LONGEST_STEP, FEWEST_CHOSEN
from ..scene import Scene
from .expectation import Expectation, expectation
from .names import stations
from .plan import MOTOR
from .recorder import Recorder
from .scales import least_motion
from .schedule import step_size


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
        meets_events: whether steps end where weights collide or stick, or supports stick.
    """

    def least(recorder: Recorder) -> dict[str, float]:
        by_unit = least_motion(scene)
        return {name: by_unit.get(unit, 0.0) for name, unit in recorder.signal_units.items()}

    longest = BEYOND_LONGEST_STEP * step_size(scene, FEWEST_CHOSEN)
    return Compared(expectation(scene, meets_events), motion_signals(scene), least, longest)


def motion_signals(scene: Scene) -> list[str]:
    """Signals that together are the motion of a scene."""
    prefixes = stations(len(scene.rotor.points))
    names = [f"rotor.{prefix}{axis}" for prefix in prefixes for axis in "xy"]
    names += [f"{MOTOR}.speed"] if scene.operation.motor else []
    return names + [f"{b.label}.{v}" for b in scene.balancer for v in b.records if v != "clearance"]


NEVER_HELD = math.inf  # longest step of runs that never rest
