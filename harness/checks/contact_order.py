"""Order of convergence of runs with contact, in the communication step.

How far an event is off depends on where in its step it falls: errors are means over runs whose
weights start a little further on each time.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..errors import SceneError
from ..master.run import cosimulate
from ..output.workers import Progress
from ..scene import Scene
from ..scene.balancer import WeightBalancer
from ..scene.check import ContactOrderCheck
from .row import Row, Rows


def check_contact_order(
    scene: Scene, check: ContactOrderCheck, progress: Progress
) -> Iterator[Row]:
    """Fitted order of the rotor's and the weights' motion against what harness/weights.md states.

    Raises:
        SceneError: the scene has not exactly one set of weights, or the steps do not divide.
        SimulationError: a run cannot be completed.
    """
    scene = scene.replace(check.set)
    sets = [b for b in scene.balancer if isinstance(b, WeightBalancer)]
    coarsest = min(check.steps)
    about = f"{scene.name}: check contact_order"
    if len(sets) == 1 and len(check.shift) not in (0, sets[0].count):
        raise SceneError(f"{about}: shift: must have one number a weight")
    if len(sets) != 1 or any(n % coarsest for n in (*check.steps, check.reference)):
        raise SceneError(
            f"{about}: needs one set of weights, and steps and reference that are multiples of the "
            f"smallest number of steps, {coarsest}"
        )
    points = scene.run.revolutions * coarsest
    profile = scene.profile()
    whole = abs(points - round(points)) < 1e-9 * points
    if profile.rises or not whole:
        raise SceneError(
            f"{about}: needs a constant speed and whole steps: run.revolutions = "
            f"{scene.run.revolutions:g} times {coarsest} steps is {points:g}"
        )
    rows = Rows(scene.name, "contact_order")
    exact = _motions(scene, sets[0], check, check.reference)
    largest = float(np.abs(exact[:, :, :2]).max())
    progress(0.5)
    errors = []
    for steps in check.steps:
        off = np.abs(_motions(scene, sets[0], check, steps) - exact).max(axis=1)
        errors.append([off[:, :2].max(axis=1).mean() / largest, off[:, 2:].max(axis=1).mean()])
    progress(1.0)
    settings = ", ".join(map(str, check.steps))
    for name, column in zip(("rotor", "weights"), np.array(errors).T, strict=True):
        order = -float(np.polyfit(np.log(check.steps), np.log(column), 1)[0])
        label = ", ".join(f"{error:.1e}" for error in column)
        yield rows.number(
            f"{check.case}: order, {name} (errors {label} at {settings} steps a revolution)",
            check.order,
            order,
            check.within,
            f"the same with {check.reference} steps a revolution",
            1.0,
        )


def _motions(
    scene: Scene, balls: WeightBalancer, check: ContactOrderCheck, steps: int
) -> np.ndarray:
    """(runs, points, 2 + N): position of the rotor [m], angles of the weights [rad].

    The points are those of the coarsest steps.
    """
    fine = scene.replace({"coupling.steps_per_rev": steps})
    every = steps // min(check.steps)
    begin, shift = np.array(balls.angles), np.array(check.shift or [0.0] * balls.count)
    angles = [f"{balls.label}.weight[{k}].angle" for k in range(1, balls.count + 1)]
    signals = ["rotor.x", "rotor.y", *angles]
    runs = []
    for number in range(check.runs):
        start = begin + shift * (number / check.runs)
        motion = cosimulate(fine.replace({f"{balls.label}.angles": start.tolist()}), record=signals)
        runs.append(np.column_stack([motion[name] for name in signals])[every::every])
    return np.array(runs)
