"""Stress cases without weights: the rotor and the liquid against closed forms."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from ...result.run import cosimulate
from ...scene import Scene
from .case import (
    BOTH_WAYS,
    LEFT_ALONE,
    UNEVEN,
    XY,
    Case,
    Outcome,
    against_closed_form,
    both_ways,
    closed_form,
    planar_scene,
    refusal,
    uneven,
)

EXACT = 1e-8  # of the range: separate FMUs err as little as rounding, one piece by less than this
MOST_AS_FORCE = 100.0  # added mass per rotor's own that 40 steps per revolution can carry as force
NEARLY_ALL_FORCE = (
    f"separate FMUs, 40 steps per revolution refused: time, gain; at 100 error below {LEFT_ALONE:g}"
)


def cases() -> Iterator[Case]:
    """Stiffness, damping, speed, resonance, endless undamped motion, liquid."""
    for power in UNEVEN:
        scene = planar_scene(uneven(power, 0.2, 1e-3), speed=15.0, revolutions=20)
        yield _closed(f"stiffness 1e2 and 1e{power} N/m in one rotor", scene)
    start = {"x": 1e-3, "vy": 1e-2}
    rotor: dict[str, Any]
    for ratio in (0.0, 1e-6, 1e-3, 0.1, 1.0, 10.0, 1e2, 1e4):
        rotor = {"mass": 2.0, "stiffness": 200.0, "damping": 40.0 * ratio, "unbalance": 1e-3}
        scene = planar_scene(rotor, speed=25.0, revolutions=50, initial=start)
        yield _closed(f"damping ratio {ratio:g}", scene)
    rotor = {"mass": 1.0, "stiffness": [90.0, 110.0], "damping": [1.0, 2.0], "unbalance": 1e-3}
    for power in range(-3, 6):
        scene = planar_scene(rotor, speed=10.0**power, revolutions=10, initial={"y": 1e-3})
        yield _closed(f"speed 1e{power} rad/s, rotor alone", scene)
    name = "exactly at a natural frequency, undamped"
    for stiffness, how in (([100.0, 225.0], ""), (100.0, ", isotropic")):
        rotor = {"mass": 1.0, "stiffness": stiffness, "unbalance": 1e-3}
        yield _closed(name + how, planar_scene(rotor, speed=10.0, revolutions=200))
    rotor = {"mass": 1.0, "stiffness": [100.0, 230.0], "unbalance": 0.0}
    start = {"x": 1e-3, "vy": 2e-2}
    scene = planar_scene(rotor, speed=20.0, revolutions=10_000, initial=start, steps_per_rev=4)
    yield _closed("no damping over 10,000 revolutions, 4 steps per revolution", scene)
    yield from _liquid()
    yield Case("zero unbalance, rotor at rest", "stays at rest exactly", _at_rest)


def _closed(name: str, scene: Scene) -> Case:
    expected = f"error below {EXACT:g} of the range (closed form)"
    return Case(name, expected, partial(against_closed_form, scene, EXACT))


def _liquid() -> Iterator[Case]:
    for as_force in (False, True):
        for excess, gap in ((1e-6, 0.5), (1e-3, 0.1), (1.0, 1e-2), (19.0, 1e-3), (9999.0, 1e-5)):
            way = "as force" if as_force else "as added mass"
            name = f"liquid mu = 1 + {excess:g}, gap {gap:g} of the radius, {way}"
            scene = liquid_scene(excess, gap, as_force)
            if as_force and excess > MOST_AS_FORCE:
                yield Case(name, NEARLY_ALL_FORCE, partial(_nearly_all_force, scene))
            elif as_force:
                yield Case(name, BOTH_WAYS, partial(both_ways, scene, XY, closed_form))
            else:
                yield _closed(name, scene)
    for gain, works in ((0.98, True), (1.02, False)):
        yield Case(
            f"Jacobi with the liquid's inertia as force, loop gain {gain:g}",
            "settles, error below 0.1 of the range" if works else "refused: time, signal, gain",
            partial(_at_the_limit, gain, works),
        )


def _nearly_all_force(scene: Scene) -> Outcome:
    """What is left between force and inertia swings at sqrt(mu) times the natural frequency."""
    usual = scene.replace({"coupling.steps_per_rev": 40})
    refused = refusal(lambda: cosimulate(usual, separate=True), "t = ", "gain 1e+04")
    fine = scene.replace({"coupling.steps_per_rev": 100})
    right = against_closed_form(fine, LEFT_ALONE)
    return Outcome(f"{refused.text}; {right.text}", refused.holds and right.holds)


def liquid_scene(excess: float, gap: float, as_force: bool, **coupling: Any) -> Scene:
    """A rotor of 1 kg whose liquid adds `excess` kg, at a natural frequency of 10 rad/s."""
    radius, density = 0.1, 1000.0
    liquid = {
        "kind": "liquid",
        "chamber_radius": radius,
        "float_radius": radius * (1.0 - gap),
        "height": excess / (density * math.pi * radius**2),
        "density": density,
        "inertia_as_force": as_force,
    }
    total = 1.0 + excess
    rotor = {
        "mass": 1.0,
        "stiffness": 100.0 * total,
        "damping": 2.0 * total,
        "internal_damping": 0.5 * total,
        "unbalance": 1e-6,
    }
    return planar_scene(rotor, liquid, speed=15.0, revolutions=20, **coupling)


def _at_the_limit(gain: float, works: bool) -> Outcome:
    build = liquid_scene(gain, 0.01, True, scheme="jacobi", order=0, steps_per_rev=400)
    if works:
        return against_closed_form(build, 0.1)
    return refusal(lambda: cosimulate(build, separate=True), "t = ", "liquid.F", "gain 1.02")


def _at_rest() -> Outcome:
    rotor = {"mass": 1.0, "stiffness": [100.0, 1e6], "damping": 1.0}
    result = cosimulate(planar_scene(rotor, speed=30.0, revolutions=100), record=XY)
    moved = max(float(np.max(np.abs(result[name]))) for name in result.signals)
    return Outcome(f"moves {moved:g} m", moved == 0.0)
