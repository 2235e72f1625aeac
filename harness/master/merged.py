"""Identical point weights that end at one angle and one speed, equal to the last bit.

From there on every operation on them gives the same bits: the run cannot part them again.  Real
weights part where that state is unstable, so the result of such a run states it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..scene import Scene
from ..scene.balancer import WeightBalancer
from .names import weight
from .recorder import present_values
from .schedule import end_time

_GROWS = 1e-6  # e-folds per radian of the rotor: slower growth is the rounding of a balanced one
APART = 1e-9  # relative: drags so far apart let weights part, and change nothing else
SHORT = "identical weights end at one angle, equal to the last bit, though that state is unstable"


class Merged(NamedTuple):
    """Weights of a balancer that a run cannot part although they would.

    Attributes:
        balancer: that holds them.
        weights: number of those that have an equal one.
        growth: rate at which a difference between them grows [1/s].
    """

    balancer: WeightBalancer
    weights: int
    growth: float

    def note(self) -> str:
        """What a reader of the run must know, and what to do."""
        one, drag = self.balancer, self.balancer.drag or 1.0
        return (
            f"{one.label}: {self.weights} of {one.count} {SHORT} (a difference grows by "
            f"{self.growth:.2g} 1/s): the run cannot part them, real weights part: give "
            f"{one.label}.weight_radius (weights of finite size cannot share an angle), or a "
            "[[balancer]] table to each weight with another start angle and a drag that differs "
            f"by {APART:g} of itself, such as {drag:.10g}, {drag * (1.0 + APART):.10g} N s/m"
        )


def names_of_states(scene: Scene) -> list[str]:
    """Outputs that `merged` reads at the end of a run; none where no weights can merge."""
    return scene.once(_names_of_states)


def _names_of_states(scene: Scene) -> list[str]:
    holders = [b for b in scene.balancer if isinstance(b, WeightBalancer)]
    if not any(_can_merge(one) for one in holders):
        return []
    names = [f"{b.label}.{name}" for b in holders for name in _states(b)]
    return names + (["motor.speed"] if scene.operation.motor else [])


def merged(scene: Scene, values: Mapping[str, float]) -> list[Merged]:
    """Weights that have merged at the end of a run where a difference between them grows.

    The rotor is taken to turn steadily.  Where its response is not known (dry friction in the
    supports) nothing is said.

    Args:
        values: of `names_of_states`.
    """
    if not values or not all(map(np.isfinite, values.values())):
        return []
    holders = [b for b in scene.balancer if isinstance(b, WeightBalancer)]
    states = [np.reshape([values[f"{b.label}.{n}"] for n in _states(b)], (2, -1)) for b in holders]
    equal = [_have_equals(s) & _can_merge(b) for b, s in zip(holders, states, strict=True)]
    if not np.concatenate(equal).any():
        return []
    speed = values.get("motor.speed", scene.profile().speed(end_time(scene)))
    from ...models.linear.together import difference_growth  # loads SciPy

    try:
        growth = difference_growth(scene.assembly(), speed, np.concatenate([s[0] for s in states]))
    except ValueError:
        return []
    parts = np.split(growth, np.cumsum([b.count for b in holders])[:-1])
    found = []
    for one, alike, rates in zip(holders, equal, parts, strict=True):
        grows = alike & (rates > _GROWS * abs(speed))
        if grows.any():
            found.append(Merged(one, int(grows.sum()), float(rates[grows].max())))
    return found


def merged_now(scene: Scene, units: Mapping[str, Any]) -> list[str]:
    """Notes on the weights of units as they stand, see `merged`."""
    values = present_values(units, names_of_states(scene))
    return [one.note() for one in merged(scene, values)]


def merged_runs(scene: Scene, ends: Mapping[str, NDArray[np.float64]]) -> NDArray[np.bool_]:
    """In which of many runs weights have merged, stable or not, by their `names_of_states`."""
    found = np.zeros(len(next(iter(ends.values()), ())), bool)
    for one in scene.balancer:
        if isinstance(one, WeightBalancer) and _can_merge(one):
            states = np.array([ends[f"{one.label}.{name}"] for name in _states(one)])
            found |= _have_equals(states.reshape(2, one.count, -1)).any(axis=0)
    return found


def _can_merge(balancer: WeightBalancer) -> bool:
    rates = [one.damping_rate for one in balancer.device.each]
    return not balancer.weight_radius and len(set(rates)) < balancer.count


def _states(balancer: WeightBalancer) -> list[str]:
    numbers = range(1, balancer.count + 1)
    return [weight(k, what) for what in ("angle", "speed") for k in numbers]


def _have_equals(states: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which weights (K, ...) have an equal one, from their angles and speeds (2, K, ...)."""
    return np.asarray((states[:, :, None] == states[:, None, :]).all(axis=0).sum(axis=0) > 1)
