"""What many runs are asked for, and how it is read from their signals."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...fmus.variables import Layout
from ..errors import UserError
from ..master.merged import merged_runs, names_of_states
from ..master.names import displacements, of_angles, of_moments, station_residuals, turning_parts
from ..scene import Scene

LAG_TURNS = 10  # revolutions at the end over which lags of weights are averaged
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


class Times(NamedTuple):
    """When runs are read.

    Attributes:
        turns: number of equal parts into which a run is divided; at a constant speed, each part is
            about one revolution.
        points: besides the start, spread evenly over a run.
        revolutions: of a run.
    """

    turns: int
    points: int
    revolutions: float


@dataclass(frozen=True, eq=False)
class Reading:
    """How results are read from the outputs of the runs of a scene.

    Attributes:
        scene: that is run.
        results: names of those that are asked for.
        residuals: names of the amplitudes of all stations in the last revolution.
        averages, lags: by name, outputs whose mean, or whose mean rate, a result is.
        parts: by name, a displacement and which part of it at the rotor's frequency.
        asked: outputs at the points; x and y of all stations come first.
        ending: outputs at the end of a run alone.
        states: of weights that can merge, where that is asked for.
    """

    scene: Scene
    results: tuple[str, ...]
    residuals: Sequence[str]
    averages: Mapping[str, str]
    lags: Mapping[str, str]
    parts: Mapping[str, tuple[str, int]]
    asked: Sequence[str]
    ending: Sequence[str]
    states: Sequence[str]

    @classmethod
    def of(cls, scene: Scene, layout: Layout, results: Sequence[str]) -> Reading:
        """Of results of a scene with its composite's variables.

        Raises:
            UserError: a result does not exist.
        """
        count = len(scene.rotor.points)
        outputs = [v.name for v in layout.reals if v.causality == "output"]
        averages, lags = (of_angles(outputs, what) for what in ("mean_angle", "mean_lag"))
        averages |= of_moments(outputs)
        is_steady = not (scene.profile().changes or scene.operation.motor)
        parts = turning_parts(count) if is_steady else {}
        residuals, means = station_residuals(count), averages | lags
        others = [*RESULTS, *residuals, *parts, *means]
        refuse_unknown(results, [*others, *outputs])
        asked = [*displacements(count), *dict.fromkeys(means[n] for n in results if n in means)]
        states = names_of_states(scene) if "merged" in results else []
        wanted = [name for name in results if name not in others]
        ending = list(dict.fromkeys(["coupling.error", *wanted, *states]))
        return cls(scene, tuple(results), residuals, averages, lags, parts, asked, ending, states)

    def results_of(
        self, signals: NDArray, at_end: NDArray, ends: NDArray, times: Times, heavy: bool
    ) -> dict[str, NDArray]:
        """By name what came of some runs, (runs,) each; NaN where one has failed.

        Args:
            signals: (runs, points + 1, asked).
            at_end: (runs, ending).
            ends: (runs,) of each run [s].
            heavy: whether gravity acts: a sag is no vibration.
        """
        turns, steps = times.turns, signals.shape[1] - 1
        motion = signals[:, :, : 2 * len(self.residuals)]
        found = _reduced(motion, turns, ends, self.residuals, heavy)
        found |= dict(zip(["error", *self.ending[1:]], at_end.T, strict=True))
        late = signals[:, -(steps // turns) :]
        for name in set(self.averages).intersection(self.results):
            found[name] = late[:, :, self.asked.index(self.averages[name])].mean(axis=1)
        for name in set(self.lags).intersection(self.results):
            turned = signals[:, :, self.asked.index(self.lags[name])]
            first = -steps // turns * min(LAG_TURNS, turns) - 1
            seconds = ends * (-first - 1) / steps
            found[name] = (turned[:, first] - turned[:, -1]) / seconds
        for name in set(self.parts).intersection(self.results):
            signal, which = self.parts[name]
            moved = late[:, :, self.asked.index(signal)]
            found[name] = _turning(moved, times.points, times.revolutions)[which]
        if "merged" in self.results:
            together = merged_runs(self.scene, {name: found[name] for name in self.states})
            failed = np.isnan(found["residual"])
            found["merged"] = np.where(failed, math.nan, together if self.states else 0.0)
        return {name: found[name].copy() for name in self.results}


def refuse_unknown(names: Iterable[str], known: Sequence[str]) -> None:
    """Raise UserError for a name that is not known, with those that are near."""
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
