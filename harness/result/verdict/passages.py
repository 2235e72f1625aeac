"""Changes of speed between plateaus, and the largest vibration in each."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ....models.arrays import Array, Complex
from ...master.names import displacements
from ...scene import Scene
from ..sag import complex_motion, from_sag, sag_of
from .ran import run_again
from .stretches import Stretch
from .verdict import Passage


def passages(
    scene: Scene, stretches: Sequence[Stretch], time: Array, size: Array
) -> tuple[Passage, ...]:
    """Stretches in which the speed changes, with their largest vibration.

    The rotor without balancers runs along the same profile for comparison, but not before a motor.

    Args:
        size: largest distance of a station from the sag (T,) at `time` (T,) [s, m].
    """
    changing = [one for one in stretches if not one.steady]
    alone = None
    if changing and scene.balancer and not scene.operation.motor:
        alone = without_balancers(scene)
    found = []
    for one in changing:
        bare = None if alone is None else _largest(*alone, one)
        largest = _largest(time, size, one)
        found.append(Passage(one.begin, one.end, one.start, one.speed, largest, bare))
    return tuple(found)


def without_balancers(scene: Scene) -> tuple[Array, Array] | None:
    """Times and largest distances of the rotor without balancers; None where it cannot run."""
    found = run_bare(scene.without_balancers())
    return None if found is None else (found[0], np.abs(found[1]).max(axis=0))


def run_bare(bare: Scene) -> tuple[Array, Complex, int] | None:
    """Times (T,) [s], displacements x + i y from the sag (n, T) [m] and passes of a run of a rotor
    without balancers; None where it cannot run."""
    count = len(bare.rotor.points)
    run = run_again(bare, displacements(count))
    if run is None:
        return None
    moved = from_sag(run.signals, sag_of(bare, run.time))
    return run.time, complex_motion(moved, count), run.passes


def _largest(time: Array, size: Array, stretch: Stretch) -> float:
    inside = (time >= stretch.begin) & (time <= stretch.end)
    return float(size[inside].max(initial=0.0))
