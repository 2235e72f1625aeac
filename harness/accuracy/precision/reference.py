"""What the errors of a precision measurement are measured against, and where there is nothing."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ....models.arrays import Array
from ....models.monolith import ReferenceDisagreement, reference
from ....models.reference.trajectory import Trajectory
from ....models.spacing import touching
from ...errors import SceneError, SimulationError
from ...master.names import weight
from ...master.plan import plan
from ...output.workers import Progress
from ...scene import Scene
from ...scene.balancer import WeightBalancer
from ...scene.begin import motion_at_start

RTOL = 3e-14  # a hair above the smallest SciPy accepts
BOUND = 1e-3  # two methods that differ by more give no reference at all
STILL = 1e-6  # of the largest range in the same unit: a signal that moves less has no range


def refuse_without_reference(scene: Scene) -> None:
    """Where nobody knows the motion to the digits that are compared.

    Raises:
        SceneError: the supports have dry friction or stops.
        SimulationError: weights stick, or a motor drives weights of finite size.
    """
    scene.refuse_friction("the error cannot be measured: the reference is that")
    if scene.rotor.stops:
        raise SceneError(
            f"{scene.label}: rotor.stops: the error cannot be measured: the "
            "reference has no stops; `run` states its error"
        )
    for balancer in scene.balancer:
        if not isinstance(balancer, WeightBalancer):
            continue
        lacks = "rolling_resistance" if balancer.rolling_resistance else ""
        if scene.operation.motor and balancer.weight_radius:
            lacks = "operation.motor with weight_radius"
        if lacks:
            raise SimulationError(
                f"{scene.label}: the error cannot be measured: the reference does not support "
                f"{lacks} of {balancer.label!r}"
            )


def right_motion(
    scene: Scene,
    names: Sequence[str],
    times: Sequence[Array],
    rtol: float = RTOL,
    progress: Progress | None = None,
) -> tuple[Trajectory, float]:
    """The motion at every point that any run has, and its own error.

    Args:
        times: of every run [s].
        rtol: relative tolerance of both methods.
        progress: told the finished fraction.

    Raises:
        SimulationError: the two methods of the reference disagree, or weights touch.
    """
    every = np.unique(np.concatenate([[0.0], *times]))
    states = [n for n in names if n.rpartition(".")[2] in ("x", "y", "vx", "vy", "angle", "speed")]
    try:
        right, own = reference(
            scene.restrained_assembly(),
            scene.operation.drive(),
            every,
            initial=motion_at_start(scene),
            rtol=rtol,
            bound=BOUND,
            progress=progress,
            signals=[n for n in states if not n.startswith(("rotor.angle", "motor."))] or None,
        )
    except ReferenceDisagreement as error:
        raise SimulationError(f"{scene.label}: the error cannot be measured: {error}") from error
    _refuse_contacts(scene, right)
    return right, own


def _refuse_contacts(scene: Scene, right: Trajectory) -> None:
    """Raise SimulationError where weights of the reference, which are points, would touch."""
    for balancer in scene.balancer:
        if not isinstance(balancer, WeightBalancer) or not balancer.weight_radius:
            continue
        names = [weight(k, "angle") for k in range(1, balancer.count + 1)]
        angles = np.array([right.signal(f"{balancer.label}.{name}") for name in names])
        largest = max(one.radius for one in balancer.device.each)
        apart = touching(largest, largest, balancer.track_radius)
        for k in range(1, len(angles)):
            gaps = np.abs((angles[k:] - angles[:-k] + math.pi) % (2.0 * math.pi) - math.pi)
            touches = (gaps < apart).any(axis=0)
            if touches.any():
                raise SimulationError(
                    f"{scene.label}: the error cannot be measured: weights of {balancer.label!r} "
                    f"touch at t = {right.time[touches.argmax()]:g} s, which the reference does "
                    "not support"
                )


def signal_ranges(scene: Scene, right: Trajectory, names: Sequence[str]) -> dict[str, float]:
    """What each signal's error is measured by."""
    units = plan(scene).signal_units(names)
    reach = {name: float(np.ptp(right.signal(name))) for name in names}
    scales = {}
    for name in names:
        alike = [reach[n] for n in names if units[n] == units[name]]
        scales[name] = max(reach[name], STILL * max(alike)) or 1.0
    return scales
