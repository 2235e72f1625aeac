"""Problems that the models see, once the tables of a scene are right by themselves."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ...models.supports import SHAFT

if TYPE_CHECKING:
    from ...models.rotor import LinearRotor
    from .scene import Scene

SINGULAR = 4.0 * np.finfo(float).eps  # of a mass matrix with ones on its diagonal


def model_problems(scene: Scene, rotor: LinearRotor) -> Iterator[str]:
    """A line for every problem."""
    if _is_singular(rotor):
        yield (
            "rotor: to 16 digits its mass matrix is singular: something moves without inertia "
            "beside the rest; check mass (kg), inertia (kg m^2), and lengths (m)"
        )
        return
    yield from _under_a_motor(scene, rotor)
    if scene.operation.gravity and scene.rotor.is_free:
        yield (
            f"operation.gravity: nothing carries {scene.rotor.on!r}: give it feet, or leave "
            "gravity out"
        )
    yield from _outside_tables(scene, rotor)
    if scene.operation.gravity and rotor.inner:
        yield (
            "operation.gravity: does not support rubber (a loss factor of supports or shaft): its "
            "inner displacement has no weight; leave one of the two out"
        )
    changes = scene.operation.motor is not None or scene.profile().changes
    if changes and any(support.name == SHAFT for support in rotor.supports):
        yield (
            "operation: rotor.shaft_loss_factor is for a constant speed alone: give speed, or "
            "internal_damping instead"
        )
    held = {"xy"[axis] for axis, _ in rotor.locked}
    for axis, pull in zip(
        "xy", (scene.operation.field.real, scene.operation.field.imag), strict=True
    ):
        if pull and axis in held:
            yield (
                f"operation.gravity: has a part along {axis}, in which a body cannot move (free): "
                "leave it out, or turn it by gravity_angle"
            )
    if scene.coupling.units == "python":
        for key in needs_native_units(scene):
            yield (
                f'{key}: not with coupling.units = "python": only native units have it; leave one '
                "of the two out"
            )
    yield from _never_turned(scene)
    count = len(scene.rotor.unbalance_names)
    for k, change in enumerate(scene.operation.unbalance_changes, start=1):
        if change.number > count:
            yield (
                f"operation.unbalance_changes[{k}].number = {change.number}: must be at most "
                f"{count}, the number of the rotor's unbalances"
            )
    if scene.balancing:
        yield from scene.balancing.problems(scene.rotor)
    yield from _liquid_windows(scene, rotor)


def _is_singular(rotor: LinearRotor) -> bool:
    """Whether rounding of the mass matrix is as large as the inertia of a motion."""
    sizes = np.sqrt(np.abs(rotor.mass.diagonal()))
    if not sizes.all():
        return True
    scaled = rotor.mass / sizes / sizes[:, None]
    return bool(np.linalg.eigvalsh(scaled)[0] <= SINGULAR)


def _outside_tables(scene: Scene, rotor: LinearRotor) -> Iterator[str]:
    """Speeds of the run that the tables of bearings do not hold."""
    if not rotor.varies:
        return
    (low, high), speeds = rotor.table_speeds, scene.profile().speeds
    if scene.operation.motor:
        speeds = scene.operation.start_speed, scene.operation.motor.top_speed
    if low >= high:
        yield "rotor.bearings: the tables have no speed in common"
    elif not rotor.holds(min(speeds), max(speeds)):
        least, most = (f"{end(speeds):.6g}" for end in (min, max))
        yield (
            f"operation: turns at {least if least == most else f'{least} to {most}'} rad/s: must "
            f"be within {low:.6g} to {high:.6g} rad/s, the speeds of the bearings' tables; change "
            "the operation, or give the tables rows for these speeds"
        )


def needs_native_units(scene: Scene) -> Iterator[str]:
    """Keys of what native units compute and Python units do not."""
    for key in ("motor", "unbalance_changes"):
        if getattr(scene.operation, key):
            yield f"operation.{key}"
    for key in ("friction", "cubic_stiffness", "stops"):
        if getattr(scene.rotor, key):
            yield f"rotor.{key}"
    if any(bearing.stiffness is None for bearing in scene.rotor.bearings):
        yield "rotor.bearings (a table or journal)"
    for i, balancer in enumerate(scene.balancer, start=1):
        for key in ("weight_radius", "rolling_resistance"):
            if getattr(balancer, key, 0):
                yield f"balancer[{i}].{key}"
        if getattr(balancer, "offset", 0):
            yield f"balancer[{i}].track_offset"
        if getattr(balancer, "race", ()):
            yield f"balancer[{i}].race"


def _under_a_motor(scene: Scene, rotor: LinearRotor) -> Iterator[str]:
    """What a motor of limited power cannot drive, and which scheme does not know it."""
    motor = scene.operation.motor
    if motor is None:
        return
    for i, balancer in enumerate(scene.balancer, start=1):
        if balancer.kind == "ring":
            yield (
                f"operation.motor: does not support a ring of liquid (balancer[{i}]): the liquid "
                "lags behind a rotor that changes its speed, by a law that is not known here; give "
                "operation.run_up"
            )
    u = rotor.unbalance
    least = float((u.conj() @ np.linalg.solve(rotor.mass, u)).real)
    if not motor.inertia > least:
        yield (
            f"operation.motor.inertia = {motor.inertia:g} kg m^2: must be above {least:.6g}, "
            "the unbalance's own: squared static moment over mass"
        )
    if scene.coupling.scheme == "compensated":
        yield (
            'coupling.scheme = "compensated": does not support operation.motor: must be "auto", '
            '"iterated", "gauss-seidel" or "jacobi"'
        )


def _never_turned(scene: Scene) -> Iterator[str]:
    """A length of the run that the profile does not reach, as it ends at rest."""
    profile, length = scene.profile(), scene.run.revolutions
    if scene.run.duration is not None:
        return
    if not scene.runs_its_profile and not math.isfinite(profile.time_of(math.tau * length)):
        turned = profile.angle(profile.seconds) / math.tau
        yield (
            f"run.revolutions = {length:g}: operation.profile ends at rest after {turned:.6g} "
            "revolutions; must be less, or left out: the run ends with the profile"
        )


def _liquid_windows(scene: Scene, rotor: LinearRotor) -> Iterator[str]:
    """Checks of a liquid balancer's window on scenes that have none in closed form."""
    one_liquid = [b.kind for b in scene.balancer] == ["liquid"]
    if one_liquid and rotor.isotropic and scene.rotor.kind == "planar":
        return
    for i, check in enumerate(scene.checks, start=1):
        if check.kind == "liquid_window":
            yield (
                f'check[{i}].kind = "liquid_window": needs a planar rotor with equal stiffness '
                "and damping in x and y, and one balancer of kind liquid"
            )
