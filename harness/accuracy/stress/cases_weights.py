"""Stress cases with weights: the coupled units against the monolith, where it is right."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from functools import partial
from typing import Any

import numpy as np

from ....models.constants import DEFAULT_TOLERANCE
from ...result.run import cosimulate
from ...scene import Scene, load_scene
from .case import (
    BOTH_WAYS,
    ROTOR_AND_MOMENT,
    UNEVEN,
    XY,
    Case,
    Outcome,
    against_monolith,
    compare,
    left_to_the_master,
    monolith,
    planar_scene,
    stated_error,
    uneven,
)

MASS, SPEED, RADIUS = 0.025, 3.0, 1.0  # of the two-pendulum scene: kg, rad/s, m
JACOBI_DRIFT = 1e-5  # of the energy integral over 1,000 revolutions at 40 steps each


def cases() -> Iterator[Case]:
    """Drag, mass, number, speed, stiffness, steps, starts, run-up, and rotors that do not move."""
    for factor in (0.0, 1e-6, 1e-3, 1.0, 1e1, 1e2, 1e3, 1e4, 1e6, 1e8):
        # angles that drag all but fixes have no range; x and y tell whether the force is right
        options = {"signals": XY, "rtol": 1e-10} if factor >= 1e2 else {}
        drag = {"weights.drag": factor * MASS * SPEED}
        yield coupled(f"drag {factor:g} m w", drag, **options)
    for ratio in (1e-9, 1e-6, 1e-3, 0.1, 1.0, 10.0):
        parts = {"weights.mass": 0.95 * ratio, "weights.drag": 0.475 * ratio}
        # neighbouring motions part fiftyfold in the fifth revolution, and errors with them
        short = {"run.revolutions": 4} if ratio > 1.0 else {}
        name = f"weights of {ratio:g} of the rotor's mass"
        yield coupled(name, {**parts, "rotor.unbalance": 0.025, **short})
    for count in (1, 64):
        changes = {
            "weights.count": count,
            "weights.mass": 0.05 / count,
            "weights.drag": 0.025 / count,
            "weights.angles": [0.3 + 5.0 * k / count for k in range(count)],
        }
        yield coupled(f"{count} weight{'s' * (count > 1)}", changes)
    yield from _speeds()
    yield from _stiffness()
    for steps in (4, 10, 100, 1000, 10_000):
        expected = f"error below {DEFAULT_TOLERANCE:g} of the range: rows are no steps"
        yield Case(f"{steps} steps per revolution", expected, partial(_with_steps, steps))
    yield from _starts()
    angles = [f"weights.weight[{k}].angle" for k in (1, 2)]
    for what, change in (
        ("1e12 kg", {"rotor.mass": 1e12}),
        ("1e14 N/m", {"rotor.stiffness": 1e14, "rotor.damping": 1e7}),
    ):
        changes = {**change, "weights.speeds": [2.0, -1.0], "rotor.unbalance": 0.0}
        yield coupled(f"balancer on a rotor of {what}", changes, signals=angles)
    run_up = load_scene("run_up").replace({"coupling.tolerance": None})
    name = "run-up through both critical speeds"
    yield Case(name, BOTH_WAYS, partial(against_monolith, run_up))
    yield Case(
        "no damping and no drag with weights over 1,000 revolutions",
        f"energy integral in the rotor frame drifts by less than {JACOBI_DRIFT:g}",
        _energy_integral,
    )


def two_pendulums(changes: Mapping[str, Any]) -> Scene:
    """The two-pendulum scene over five revolutions, its coupling left to the master."""
    return left_to_the_master("two_balls", changes)


def coupled(name: str, changes: Mapping[str, Any], **options: Any) -> Case:
    """The two-pendulum scene against the monolith; `options` of `against_monolith`."""
    return Case(name, BOTH_WAYS, lambda: against_monolith(two_pendulums(changes), **options))


def _speeds() -> Iterator[Case]:
    for power in (-3, -1, 0, 1, 3, 5):
        speed = 10.0**power
        scale = speed / SPEED  # everything turns and swings that much faster
        changes = {
            "operation.speed": speed,
            "rotor.stiffness": [scale**2, 49.0 * scale**2],
            "rotor.damping": [0.5 * scale, scale],
            "weights.drag": 0.0125 * scale,
        }
        yield coupled(f"speed 1e{power} rad/s with weights", changes)
    for factor in (0.1, 10.0, 100.0):
        yield coupled(f"speed {factor:g} times the scene's", {"operation.speed": factor * SPEED})
    # the pendulums all but rest there: their range is what is left of decayed motion
    slow = {"operation.speed": 0.01 * SPEED}
    yield coupled("speed 0.01 times the scene's, x and y", slow, signals=XY)


def _stiffness() -> Iterator[Case]:
    weights = {
        "name": "weights",
        "kind": "pendulums",
        "count": 2,
        "mass": 0.02,
        "track_radius": 0.1,
        "drag": 0.2,
        "angles": [0.3, 1.0],
    }
    signals = ("rotor.x", "weights.moment_xi", "weights.moment_eta")
    for power in UNEVEN:
        rotor = uneven(power, 2.0, 2e-3)
        scene = planar_scene(rotor, weights, speed=15.0)
        name = f"stiffness 1e2 and 1e{power} N/m with weights"
        run = partial(against_monolith, scene, signals, rtol=1e-11)
        yield Case(name, BOTH_WAYS, run)


def _with_steps(steps: int) -> Outcome:
    revolutions = 1 if steps > 1000 else 3
    build = two_pendulums({"coupling.steps_per_rev": steps, "run.revolutions": revolutions})
    error, own, result = compare(build, ROTOR_AND_MOMENT, monolith(), DEFAULT_TOLERANCE)
    text = f"error {error:.1e} in {result.steps} steps; reference {own:.0e}"
    return Outcome(text, error <= DEFAULT_TOLERANCE and not stated_error(result))


def _starts() -> Iterator[Case]:
    far = {"run.initial": {"x": 2.0, "y": -1.2, "vx": 4.0, "vy": 1.6}}
    spinning = {"weights.speeds": [-20.0 * SPEED, 15.0 * SPEED], "run.revolutions": 3}
    yield coupled("rotor released a hundred times as far out as it will run", far)
    yield coupled("weights that spin twenty times as fast as the rotor", spinning)
    yield coupled("zero unbalance, weights anywhere", {"rotor.unbalance": 0.0})
    still = "stays at rest, below 1e-12 m"
    yield Case("zero unbalance, weights evenly spread", still, _in_balance)


def _in_balance() -> Outcome:
    build = two_pendulums(
        {"rotor.unbalance": 0.0, "weights.angles": [0.0, math.pi], "run.revolutions": 50}
    )
    result = cosimulate(build, record=XY)
    moved = max(float(np.max(np.abs(result[name]))) for name in XY)
    return Outcome(f"moves {moved:.1e} m", moved < 1e-12)


def _energy_integral() -> Outcome:
    """Without losses on equal supports the energy seen in the rotor frame is kept.

    h = sum of q' dL/dq' - L for z and phi less w times the angular momentum (Jacobi's integral).
    """
    k, m1, u, w = 1.0, 0.95, 0.0, SPEED
    names = [f"rotor.{n}" for n in ("x", "y", "vx", "vy", "angle")]
    names += [f"weights.weight[{j}].{n}" for j in (1, 2) for n in ("angle", "speed")]
    build = two_pendulums(
        {
            "rotor.stiffness": k,
            "rotor.damping": 0.0,
            "rotor.unbalance": u,
            "weights.drag": 0.0,
            "run.revolutions": 1000,
            "coupling.steps_per_rev": 40,
        }
    )
    run = cosimulate(build, record=names)
    z, v = run["rotor.x"] + 1j * run["rotor.y"], run["rotor.vx"] + 1j * run["rotor.vy"]
    energy = 0.5 * m1 * np.abs(v) ** 2 + 0.5 * k * np.abs(z) ** 2
    momentum = m1 * (z.conj() * v).imag
    for j in (1, 2):
        arm = RADIUS * np.exp(1j * (run[f"weights.weight[{j}].angle"] + run["rotor.angle"]))
        place = z + arm
        velocity = v + 1j * (run[f"weights.weight[{j}].speed"] + w) * arm
        energy = energy + 0.5 * MASS * np.abs(velocity) ** 2
        momentum = momentum + MASS * (place.conj() * velocity).imag
    integral = energy - w * momentum
    size = float(np.max(np.abs(energy)) + w * np.max(np.abs(momentum)))
    drift = float(np.max(np.abs(integral - integral[0]))) / size
    return Outcome(f"drift {drift:.1e} over {run.steps} steps", drift <= JACOBI_DRIFT)
