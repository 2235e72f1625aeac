"""The runs that a page needs: the scene as it is, and switched on from rest, with and without."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass
from typing import Any

from ..errors import SimulationError, UserError
from ..result.result import Result
from ..result.run import cosimulate
from ..scene import Scene
from ..scene.balancer import WeightBalancer

SLOW_RUN_UP = 60.0  # revolutions at full speed in which a rotor without a drive is run up
SETTLING = 200.0  # revolutions at full speed that follow


@dataclass(frozen=True)
class SwitchedOn:
    """A run from standstill, or why there is none.

    Attributes:
        scene: as it was run up, weights at rest.
        run: with its balancers.
        bare: without them; None where there are none, or it failed.
        reason: why there is no run.
        assumed: how it is run up where the scene does not say.
    """

    scene: Scene
    run: Result | None
    bare: Result | None
    reason: str = ""
    assumed: str = ""


def own_run(scene: Scene) -> Result:
    """The scene as it is."""
    return _quietly(scene)


def switched_on(scene: Scene, seconds: float | None = None) -> SwitchedOn:
    """The scene's own drive where the speed rises from rest, else a run-up at a steady rate.

    Args:
        seconds: of the run-up [s]; default: of `SLOW_RUN_UP` revolutions at full speed.
    """
    started, assumed = from_rest(scene, seconds)
    try:
        run = _quietly(started)
        bare = _quietly(started.without_balancers()) if started.balancer else None
    except (UserError, SimulationError) as error:
        return SwitchedOn(started, None, None, str(error), assumed)
    return SwitchedOn(started, run, bare, "", assumed)


def from_rest(scene: Scene, seconds: float | None = None) -> tuple[Scene, str]:
    """The scene with a run-up from standstill, and what was assumed for it; weights at rest."""
    profile, assumed = scene.profile(), ""
    changes: dict[str, Any] = {}
    rises = bool(scene.operation.motor) or (profile.changes and profile.speed(0.0) < profile.end)
    if not rises or seconds is not None:
        turn = math.tau / profile.end
        length = SLOW_RUN_UP * turn if seconds is None else seconds
        if seconds is None:
            assumed = f"a run-up of {length:.3g} s at a steady rate is assumed (--run-up)"
        stop = length + SETTLING * turn
        changes = {
            "operation.speed": None,
            "operation.run_up": None,
            "operation.motor": None,
            "operation.profile": [[0.0, 0.0], [length, profile.end], [stop, profile.end]],
            "run.revolutions": None,
        }
    first = 0.0 if changes else scene.operation.start_speed
    still = {
        f"{one.label}.speeds": [-first] * one.count
        for one in scene.balancer
        if isinstance(one, WeightBalancer)
    }
    return scene.replace({**changes, **still}), assumed


def _quietly(scene: Scene) -> Result:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return cosimulate(scene.replace({"run.record": None}))  # what a verdict needs
