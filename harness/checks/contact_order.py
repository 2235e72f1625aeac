"""Order of convergence of runs with contact, in the communication step.

How far an event is off depends on where in its step it falls: errors are means over runs whose
weights start a little further on each time.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np

from ..master.run import cosimulate
from ..scene import Scene
from .row import Row, Rows

ORDER, WITHIN = 4.0, 0.3
REFERENCE = 1280  # steps per revolution of the run that the others are compared with
RUNS = 8  # from different starts
START = [1.0, 2.0]  # rad


class Case(NamedTuple):
    """What two balls do, and in which steps per revolution.

    Attributes:
        shift: how far each ball starts further on over all runs [rad]; None: one run.
    """

    name: str
    changes: Mapping[str, Any]
    steps: tuple[int, ...] = (20, 40, 80, 160)
    shift: tuple[float, float] | None = None


# collisions: with finer steps the error of the short steps at a collision shows; 0.094 rad is what
# the balls approach within 0.05 revolutions
CASES = (
    Case("no contact", {}),
    Case(
        "collision, restitution 0.5",
        {"balls.restitution": 0.5, "balls.speeds": [12.0, -12.0]},
        (10, 20, 40),
        (0.094, 0.0),
    ),
    Case(
        "collision, then lasting contact",
        {"balls.speeds": [12.0, -12.0]},
        (10, 20, 40),
        (0.094, 0.0),
    ),
    Case("lasting contact", {"balls.angles": [3.188912398447714, 3.6942729087318718]}),
    Case(
        "contact that opens",
        {
            "balls.angles": [3.4889123984477144, 3.994272908731872],
            "run.initial.vx": -3.0,
            "run.revolutions": 0.8,
        },
        shift=(0.1, 0.1),
    ),
)


def check_contact_order(
    scene: Scene, index: int, reference: int = REFERENCE, runs: int = RUNS
) -> Iterator[Row]:
    """Fitted order of the rotor's and the weights' motion in one of `CASES`.

    Raises:
        SimulationError: a run cannot be completed.
    """
    case = CASES[index]
    rows, scene = Rows(scene.name, "contact_order"), scene.replace(case.changes)
    exact = _motions(scene, case, reference, runs)
    largest = float(np.abs(exact[:, :, :2]).max())
    errors = []
    for steps in case.steps:
        off = np.abs(_motions(scene, case, steps, runs) - exact).max(axis=1)
        errors.append([off[:, :2].max(axis=1).mean() / largest, off[:, 2:].max(axis=1).mean()])
    settings = ", ".join(map(str, case.steps))
    for name, column in zip(("rotor", "weights"), np.array(errors).T, strict=True):
        order = -float(np.polyfit(np.log(case.steps), np.log(column), 1)[0])
        label = ", ".join(f"{error:.1e}" for error in column)
        yield rows.number(
            f"{case.name}: order, {name} (errors {label} at {settings} steps per revolution)",
            ORDER,
            order,
            WITHIN,
            f"the same with {reference} steps per revolution",
            1.0,
        )


def _motions(scene: Scene, case: Case, steps: int, runs: int) -> np.ndarray:
    """(runs, points, 4): position of the rotor [m], angles of the balls [rad].

    The points are those of the coarsest steps.
    """
    fine = scene.replace({"coupling.steps_per_rev": steps})
    every = steps // min(case.steps)
    begin = np.array(case.changes.get("balls.angles", START))
    signals = ["rotor.x", "rotor.y", "balls.weight[1].angle", "balls.weight[2].angle"]
    shifts = [0.0] if case.shift is None else np.outer(np.arange(runs) / runs, case.shift)
    motions = []
    for shift in shifts:
        start = (begin + shift).tolist()
        motion = cosimulate(fine.replace({"balls.angles": start}), record=signals)
        motions.append(np.column_stack([motion[name] for name in signals])[every::every])
    return np.array(motions)
