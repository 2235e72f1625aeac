"""Goncharov's weights and starts, as his checks need them: which scenes, from where, all runs."""

from __future__ import annotations

import math
import random
from collections.abc import Iterable

from ..design.scenes import refuse_without_slow_root, weights_of
from ..design.settling import Batch, SettlingRun, Start, run_batch
from ..errors import SimulationError
from ..scene import Scene
from ..scene.balancer import WeightBalancer


def weights_with_slow_root(scene: Scene) -> WeightBalancer:
    """`weights_of` a scene for which Goncharov's slow root (1) holds.

    Raises:
        SceneError: as `weights_of`, or it does not hold.
    """
    weights = weights_of(scene)
    refuse_without_slow_root(scene)
    return weights


def only_finite_weights(scene: Scene) -> WeightBalancer | None:
    """The one set of weights of finite size on a planar isotropic rotor at constant speed."""
    profile = scene.profile()
    fits = scene.rotor.kind == "planar" and scene.assembly().rotor.isotropic
    if not fits or profile.changes or len(scene.balancer) != 1:
        return None
    one = scene.balancer[0]
    return one if isinstance(one, WeightBalancer) and one.weight_radius else None


def facing_start(count: int, alpha: float, rng: random.Random) -> Start:
    """Angles of two groups that face each other, from packed to evenly spread: p large [rad].

    Args:
        alpha: half the angle between neighbours that touch.
    """
    middle = rng.uniform(0.0, math.tau)
    room = math.tau / count - 2.0 * alpha
    angles: list[float] = []
    for size, side in ((count - count // 2, 0.0), (count // 2, math.pi)):
        gaps = [2.0 * alpha + rng.uniform(0.0, 0.5 * room) for _ in range(size - 1)]
        place = middle + side - 0.5 * sum(gaps)
        for gap in [0.0, *gaps]:
            place += gap
            angles.append(place)
    return tuple(angles)


def settled_runs(batches: Iterable[Batch]) -> list[SettlingRun]:
    """Every start of these batches.

    Raises:
        SimulationError: one has failed; a check that lost some starts would not be one.
    """
    found = []
    for batch in batches:
        for run in run_batch(batch):
            if run.failure:
                raise SimulationError(f"{batch.scene.label}: {run.failure}")
            found.append(run)
    return found
