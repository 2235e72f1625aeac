"""One scene run many times with other values, in C, on all cores."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import UserError
from ..master.one_file import composition
from ..master.plan import plan
from ..master.schedule import end_time
from ..output.memory import free_memory, refuse_beyond
from ..scene import Scene
from .alike import table_of, values_of
from .many_results import DEFAULTS, Reading, Times, refuse_unknown

POINTS_PER_REV = 20  # at which the amplitude is looked at, where a tolerance chooses the steps
MOST_RUNS = 32  # of a call: some MB of outputs
_COPIES = 2  # outputs, and what is made of them


def cosimulate_many(
    scene: Scene,
    table: Any,
    *,
    results: Sequence[str] = DEFAULTS,
    threads: int | None = None,
) -> Any:
    """Run a scene once for every row of a table.

    Args:
        scene: what every run has in common.
        table: values by paths as in `Scene.replace`, such as `balls.drag`, `rotor.stiffness[x]` or
            `speed`, or by the variables of the scene's composite FMU (`rotor.stiffness_x`): a
            mapping of arrays, or a pandas frame.
        results: of `RESULTS`; of one station `rotor.station[1].residual`, or `rotor.residual` of a
            rotor's only one [m]; at constant speed `rotor.x.in_phase` and `.quadrature_lead`, also
            of `y` and of a station: x = in_phase cos theta - quadrature_lead sin theta in the last
            revolution [m], with the rotor's angle theta; `balls.weight[1].mean_angle` of the last
            revolution [rad], and `.mean_lag` behind the rotor in the last ten [rad/s];
            `balls.mean_moment_xi` and `_eta` of the last revolution [kg m]; or outputs of the FMU,
            which are taken at the end of a run.
        threads: default: one a core.

    Returns:
        By name an array with a value a run, NaN where a run has failed, and `failure`: why it has,
        else empty.  If the table is a frame, a copy of it with these columns added.

    Raises:
        UserError: a variable or a result does not exist, the columns differ in length, or the
            memory does not suffice.
    """
    from ...fmus.composite.batch import BatchRuns  # compiles where it has to

    made = composition(scene)
    columns = {str(name): np.asarray(table[name], float) for name in table}
    inputs = [v.name for v in made.layout.variables if v.causality != "output"]
    reading = Reading.of(scene, made.layout, results)
    shapes = {column.shape for column in columns.values()}
    if len(shapes) != 1 or len(shape := shapes.pop()) != 1 or not shape[0]:
        raise UserError("table: every column must have as many numbers as the others, at least 1")
    if not columns.keys() <= set(inputs):
        columns = _variables(scene, columns)
    refuse_unknown(columns, inputs)
    values = np.array(list(columns.values())).T
    ends = _ends(scene, columns, len(values))
    heavy = bool(scene.operation.gravity) or any("gravity" in name for name in columns)
    times = Times(*_turns_and_points(scene, float(ends[0])), scene.revolutions)
    threads = threads or os.cpu_count() or 1
    size = min(MOST_RUNS, math.ceil(len(values) / threads))  # of a chunk
    needed = 8.0 * _COPIES * size * threads * (times.points + 1) * len(reading.asked)
    what = f"run.revolutions = {scene.revolutions:g}: what many runs are read from needs"
    refuse_beyond(free_memory(), needed, what, "use fewer")
    runs = BatchRuns(made, list(columns), reading.asked, times.points, last=reading.ending)

    def chunk(first: int) -> dict[str, NDArray]:
        part = slice(first, first + size)
        signals, at_end, reasons = runs.with_last(values[part], ends[part])
        found = reading.results_of(signals, at_end, ends[part], times, heavy)
        return {**found, "failure": np.array(reasons, object)}

    with ThreadPoolExecutor(threads) as executor:
        parts = list(executor.map(chunk, range(0, len(values), size)))
    found = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    return found if isinstance(table, Mapping) else table.assign(**found)


def _ends(scene: Scene, columns: Mapping[str, NDArray], count: int) -> NDArray[np.float64]:
    """Ends of the runs (runs,) [s]: of another speed, of as many revolutions."""
    paced = "coupling.top_speed" if scene.operation.motor else "speed"
    if paced in columns and not scene.profile().changes and scene.run.duration is None:
        with np.errstate(divide="ignore"):  # the run refuses it
            return np.asarray(math.tau * scene.run.revolutions / np.abs(columns[paced]))
    return np.full(count, end_time(scene))


def _turns_and_points(scene: Scene, end: float) -> tuple[int, int]:
    """Revolutions of a run that ends there [s], and points at which it is read."""
    profile, turns = scene.profile(), max(2, round(scene.revolutions))
    points = turns * (scene.coupling.steps_per_rev or POINTS_PER_REV)
    if not profile.changes:
        return turns, points
    # parts of equal length, none shorter than the last revolution
    last = end - profile.time_of(max(0.0, profile.angle(end) - math.tau))
    turns = max(2, min(turns, int(end / last)))
    return turns, turns * math.ceil(points / turns)


def _variables(scene: Scene, columns: dict[str, NDArray]) -> dict[str, NDArray]:
    """Columns by the composite's variables, of columns by the scene's paths."""
    found: dict[str, NDArray] = {}
    for path, column in columns.items():
        ends = column[[0, -1]] if column[0] != column[-1] else column[0] * np.array([1.0, 1.5])
        varied = [scene.replace({path: float(value)}) for value in ends]
        pair = [values_of(one, plan(one)) for one in varied]
        names = [name for name in pair[0] if pair[0][name] != pair[1][name]]
        if not names or any([one[name] for one in pair] != ends.tolist() for name in names):
            break  # a variable is made from it
        found |= dict.fromkeys(names, column)
    else:
        return found
    rows = zip(*(column.tolist() for column in columns.values()), strict=True)
    scenes = [scene.replace(dict(zip(columns, row, strict=True))) for row in rows]
    return {name: np.array(values) for name, values in table_of(scenes).items()}
