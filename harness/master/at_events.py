"""Signals that jump at an event, compared where two runs are on different sides of it.

Points of a record are often events: steps end there.  A run whose event falls a little later, by
less than any error that is stated, still shows the value before the jump.  That difference is no
error.  The value is then compared with those that the other run has close by: it errs by its
distance from all that the other takes on between the points before and after, and from what it
comes to from either side.

Places and angles do not jump, and are compared as they are.  An event that one of the runs misses,
or has later by more than the distance of two points, makes the counts of events differ on these
points too.  All signals are then compared as they are.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .recorder import Signal

CONTINUOUS = "m", "rad", "kg m", ""  # what signals that no event lets jump are measured in


@dataclass(frozen=True)
class Counted:
    """Signals of a run, and how many events lie before each of its points."""

    signals: Mapping[str, Signal]
    events: Signal

    def at(self, places: slice | NDArray[np.intp]) -> Counted:
        """The same at some of the points."""
        return Counted({n: each[places] for n, each in self.signals.items()}, self.events[places])


def on_the_same_side(
    run: Counted, fine: Counted, parts: int, units: Mapping[str, str]
) -> dict[str, Signal]:
    """Signals of a run as they are compared with those of one that has more points.

    Args:
        run: at some points, (T,) each.
        fine: with every `parts`-th point at one of the run, ((T - 1) parts + 1,) each.
        units: by signal, what it is measured in.
    """
    size = len(fine.events)
    here = np.arange(len(run.events)) * parts
    before, after = np.maximum(here - 1, 0), np.minimum(here + 1, size - 1)
    apart = run.events != fine.events[here]
    apart &= (fine.events[before] <= run.events) & (run.events <= fine.events[after])
    found = {}
    for name, values in run.signals.items():
        found[name] = values
        if apart.any() and units[name] not in CONTINUOUS:
            own = fine.signals[name]
            near = [own[at] for at in (before, here, after)]
            near += [_continued(Counted({name: own}, fine.events), here, way) for way in (-1, 1)]
            nearest = np.clip(values, np.min(near, axis=0), np.max(near, axis=0))
            found[name] = np.where(apart, own[here] + (values - nearest), values)
    return found


def _continued(fine: Counted, here: NDArray[np.intp], way: int) -> Signal:
    """What a signal comes to at some points from one side: three points of a parabola continued.

    Where an event lies between them, the value at the next.
    """
    [own] = fine.signals.values()
    places = [np.clip(here + k * way, 0, len(own) - 1) for k in (1, 2, 3)]
    first, second, third = (own[at] for at in places)
    smooth = (fine.events[places[0]] == fine.events[places[2]]) & (places[1] != places[2])
    return np.where(smooth, 3.0 * (first - second) + third, first)
