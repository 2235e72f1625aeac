"""One scene run many times with other values, in C, on all cores."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from difflib import get_close_matches
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import UserError
from ..master.merged import merged_runs, names_of_states
from ..master.names import of_angles, of_moments, station_residuals, stations, turning_parts
from ..master.one_file import composition
from ..master.plan import plan
from ..master.schedule import end_time
from ..output.memory import free_memory, refuse_beyond
from ..scene import Scene
from .alike import table_of, values_of

POINTS_PER_REV = 20  # at which the amplitude is looked at, where a tolerance chooses the steps
MOST_RUNS = 32  # of a call: some MB of outputs
LAG_TURNS = 10  # revolutions at the end over which lags of weights are averaged
_COPIES = 2  # outputs, and what is made of them
SETTLED_AMPLITUDE = 0.05  # of the largest: how far from the last amplitude a settled rotor may be
STEADY = 0.005  # of it: what the amplitude of a settled one may change by in the last revolution

DEFAULTS = ("residual", "largest", "settling_time", "settled", "error")
RESULTS = {
    "residual": "largest amplitude in the last revolution [m]; under gravity about its mean",
    "largest": "largest amplitude of the run [m]",
    "settling_time": "after which the amplitude stays near the last [s]; NaN: not settled",
    "settled": "1 where the last two revolutions are alike",
    "error": "stated error of the run, relative to the motion: the sum of what its steps may err",
    "merged": "1 where identical point weights end at one angle, equal to the last bit: the run "
    "cannot part them again, even where that state is unstable (see `run`)",
}


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
    layout = made.layout
    columns = {str(name): np.asarray(table[name], float) for name in table}
    inputs = [v.name for v in layout.variables if v.causality != "output"]
    outputs = [v.name for v in layout.reals if v.causality == "output"]
    residuals = station_residuals(len(scene.rotor.points))
    averages, lags = (of_angles(outputs, what) for what in ("mean_angle", "mean_lag"))
    averages |= of_moments(outputs)
    means, profile = averages | lags, scene.profile()
    is_steady = not (profile.changes or scene.operation.motor)
    parts_of = turning_parts(len(scene.rotor.points)) if is_steady else {}
    _refuse_unknown(results, [*RESULTS, *residuals, *parts_of, *means, *outputs])
    shapes = {column.shape for column in columns.values()}
    if len(shapes) != 1 or len(shape := shapes.pop()) != 1 or not shape[0]:
        raise UserError("table: every column must have as many numbers as the others, at least 1")
    if not columns.keys() <= set(inputs):
        columns = _variables(scene, columns)
    _refuse_unknown(columns, inputs)
    values = np.array(list(columns.values())).T
    asked = [
        f"rotor.{prefix}{axis}" for prefix in stations(len(scene.rotor.points)) for axis in "xy"
    ]
    asked += dict.fromkeys(means[name] for name in results if name in means)
    states = names_of_states(scene) if "merged" in results else []
    others = {*RESULTS, *residuals, *parts_of, *means}
    wanted = [name for name in results if name not in others]
    ending = list(dict.fromkeys(["coupling.error", *wanted, *states]))
    ends = np.full(len(values), end_time(scene))
    paced = "coupling.top_speed" if scene.operation.motor else "speed"
    if paced in columns and not profile.changes and scene.run.duration is None:
        with np.errstate(divide="ignore"):  # the run refuses it
            ends = math.tau * scene.run.revolutions / np.abs(columns[paced])
    turns = max(2, round(scene.revolutions))
    points = turns * (scene.coupling.steps_per_rev or POINTS_PER_REV)
    if profile.changes:  # parts of equal length, none shorter than the last revolution
        last = ends[0] - profile.time_of(max(0.0, profile.angle(ends[0]) - math.tau))
        turns = max(2, min(turns, int(ends[0] / last)))
        points = turns * math.ceil(points / turns)
    threads = threads or os.cpu_count() or 1
    size = min(MOST_RUNS, math.ceil(len(values) / threads))  # of a chunk
    needed = 8.0 * _COPIES * size * threads * (points + 1) * len(asked)
    what = f"run.revolutions = {scene.revolutions:g}: what many runs are read from needs"
    refuse_beyond(free_memory(), needed, what, "use fewer")
    runs = BatchRuns(made, list(columns), asked, points, last=ending)
    heavy = bool(scene.operation.gravity) or any("gravity" in name for name in columns)

    def chunk(first: int) -> dict[str, NDArray]:
        part = slice(first, first + size)
        signals, at_end, reasons = runs.with_last(values[part], ends[part])
        motion = signals[:, :, : 2 * len(scene.rotor.points)]
        reduced = _reduced(motion, turns, ends[part], residuals, heavy)
        reduced |= dict(zip(["error", *ending[1:]], at_end.T, strict=True))
        late = signals[:, -((signals.shape[1] - 1) // turns) :]
        for name in set(averages).intersection(results):
            reduced[name] = late[:, :, asked.index(means[name])].mean(axis=1)
        for name in set(lags).intersection(results):
            turned = signals[:, :, asked.index(means[name])]
            first = -(turned.shape[1] - 1) // turns * min(LAG_TURNS, turns) - 1
            seconds = ends[part] * (-first - 1) / (turned.shape[1] - 1)
            reduced[name] = (turned[:, first] - turned[:, -1]) / seconds
        for name in set(parts_of).intersection(results):
            signal, which = parts_of[name]
            turning = _turning(late[:, :, asked.index(signal)], points, scene.revolutions)
            reduced[name] = turning[which]
        if "merged" in results:
            together = merged_runs(scene, {name: reduced[name] for name in states})
            failed = np.isnan(reduced["residual"])
            reduced["merged"] = np.where(failed, math.nan, together if states else 0.0)
        return {**{k: reduced[k].copy() for k in results}, "failure": np.array(reasons, object)}

    with ThreadPoolExecutor(threads) as executor:
        parts = list(executor.map(chunk, range(0, len(values), size)))
    found = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    return found if isinstance(table, Mapping) else table.assign(**found)


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


def _refuse_unknown(names: Any, known: Sequence[str]) -> None:
    for name in names:
        if name not in known:
            near = get_close_matches(name, known, 3) or known[:20]
            raise UserError(f"{name!r}: not known; did you mean one of {', '.join(near)}?")


def _turning(motion: NDArray, points: int, revolutions: float) -> NDArray:
    """In-phase and leading quadrature part (2, runs) of the last points (runs, k) of runs."""
    theta = math.tau * revolutions / points * np.arange(points + 1)[-motion.shape[1] :]
    waves = np.column_stack([np.cos(theta), -np.sin(theta), np.ones_like(theta)])
    return np.asarray((motion @ np.linalg.pinv(waves).T).T[:2])


def _reduced(
    motion: NDArray,
    turns: int,
    ends: NDArray,
    residuals: Sequence[str],
    heavy: bool,
) -> dict[str, NDArray]:
    """Results of runs from x, y of all stations (runs, points + 1, 2 n); `heavy`: under gravity."""
    pairs = motion.reshape(*motion.shape[:2], -1, 2)
    if heavy:  # a sag is no vibration
        pairs = pairs - pairs[:, -((pairs.shape[1] - 1) // turns) :].mean(axis=1, keepdims=True)
    squares = pairs[..., 0] ** 2 + pairs[..., 1] ** 2  # roots are taken of what is left of them
    last = np.sqrt(squares[:, -(squares.shape[1] // turns) :].max(axis=1))
    of_all = squares.max(axis=2)
    envelope = np.sqrt(of_all[:, 1:].reshape(len(ends), turns, -1).max(axis=2))
    residual = envelope[:, -1]
    largest = np.maximum(np.sqrt(of_all[:, 0]), envelope.max(axis=1))
    away = np.abs(envelope - residual[:, None]) > SETTLED_AMPLITUDE * largest[:, None]
    last_away = turns - np.argmax(away[:, ::-1], axis=1)
    steady = np.abs(envelope[:, -2] - residual) <= STEADY * largest
    settling = np.where(away.any(axis=1), last_away, 0) / turns * np.where(steady, ends, math.nan)
    return {
        "residual": residual,
        "largest": largest,
        "settling_time": settling,
        "settled": np.where(np.isnan(residual), math.nan, steady),
        **dict(zip(residuals, last.T, strict=True)),
    }
