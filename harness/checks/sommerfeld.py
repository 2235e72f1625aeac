"""The Sommerfeld effect: a motor too weak for a resonance stays before it, a stronger passes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...models.sommerfeld import Resonance
from ..errors import SceneError
from ..result.result import Result
from ..result.run import cosimulate
from ..scene import Scene
from .row import Row, Rows

SOURCE = "Sommerfeld 1902: L(w) w = power of damping"
SPEED, BENDING = 1e-4, 1e-3  # as near as a run comes that creeps to where it is caught
WITHIN = 0.01  # how far below and above the limit the motors are, as a share of it
LATE = 0.2  # of a run, over which it is judged


def check_sommerfeld(scene: Scene) -> Iterator[Row]:
    """Rotor alone and with its balancers, each with a motor a little below the limit and above it.

    Raises:
        SceneError: the scene has no motor with `stall_torque`, or no closed form.
    """
    rows = Rows(scene.name, "sommerfeld")
    for name, variant, resonance in variants_of(scene):
        limit, peak = resonance.limit()
        weak, strong = ((1.0 + sign * WITHIN) * limit for sign in (-1.0, 1.0))
        result, whirl = run_with(variant, weak)
        speed, expected = float(result["motor.speed"][-1]), resonance.caught_at(weak)
        torque = f"{name}, {1.0 - WITHIN:g} of the limit torque"
        yield rows.number(f"{torque}: speed [rad/s]", expected, speed, SPEED, SOURCE)
        bending = float(resonance.amplitude(expected))
        yield rows.number(f"{torque}: bending [m]", bending, whirl, BENDING, SOURCE)
        result, _ = run_with(variant, strong)
        speed = float(result["motor.speed"][-1])
        yield rows.statement(
            f"{name}, {1.0 + WITHIN:g} of the limit torque, {limit:.6g} N m",
            f"passes {peak:.5g} rad/s",
            f"{'passes' if speed > 1.1 * peak else 'stays'}, {speed:.5g} rad/s",
            speed > 1.1 * peak,
            SOURCE,
        )


def variants_of(scene: Scene) -> list[tuple[str, Scene, Resonance]]:
    """The rotor alone, and with its balancers where it has any, with the closed form of each.

    Raises:
        SceneError: as `check_sommerfeld`.
    """
    motor = scene.operation.motor
    if motor is None or motor.stall_torque is None:
        raise SceneError(
            f"{scene.label}: check sommerfeld: needs operation.motor with stall_torque"
        )
    cases = [("alone", scene.without_balancers())]
    if scene.balancer:
        cases.append(("with " + ", ".join(b.label for b in scene.balancer), scene))
    try:
        found = [(n, s, Resonance.of(s.assembly(), motor.top_speed)) for n, s in cases]
        for *_, resonance in found:
            resonance.limit()  # refuses one that there is none of
    except ValueError as error:
        raise SceneError(f"{scene.label}: check sommerfeld: {error}") from None
    return found


def run_with(scene: Scene, stall_torque: float) -> tuple[Result, float]:
    """The scene's run with another motor, and the bending over its last part [m]."""
    names = ["motor.speed", "rotor.x", "rotor.y"]
    changed = scene.replace({"operation.motor.stall_torque": stall_torque})
    result = cosimulate(changed, record=names)
    late = result.time >= (1.0 - LATE) * result.time[-1]
    return result, float(np.hypot(result["rotor.x"], result["rotor.y"])[late].mean())
