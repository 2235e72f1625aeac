"""Least squares between measured amplitudes and those of runs in C, and how well it is known."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.stats import t as student

from ...models.harmonic_balance import NoResponse
from ..errors import UserError
from ..scene import Scene
from .measured import MeasuredAmplitudes
from .model import HarmonicModel, Model
from .parameters import Parameter

STEP = 1e-3  # of a parameter's start: far above the error of a run, far below what bends a curve
MOST_STEPS = 60
ENOUGH = 1e-5  # change of a parameter or of the sum of squares at which the fit has ended
CONFIDENCE = 0.95
ALIKE = math.sqrt(10.0)  # a variance inflation of 10 is commonly taken for too much
BLIND = 1e-6  # of the strongest parameter's effect: none at all

Array = NDArray[np.float64]
Difference = Callable[[Array], Array]  # of simulated amplitudes (..., n)


@dataclass(frozen=True, eq=False)
class Fit:
    """What was found.

    Attributes:
        parameters, values: (p,) what was free, and what it is.
        uncertainty: (p,) half the interval of 95 % confidence; infinite where the data do not tell,
            NaN where a value ended at its limit.
        correlation: (p, p) of the values.
        inflation: (p,) of the interval, over that with all other values known.
        simulated: (n,) amplitudes with these values, as `MeasuredAmplitudes.values` [m].
        rms: of the difference, before and after.
        guessed: rms that harmonic balance has with its own values, from which the runs went on;
            NaN: the scene is not for it.
        ended: why the search has.
    """

    parameters: tuple[Parameter, ...]
    values: Array
    uncertainty: Array
    correlation: Array
    inflation: Array
    simulated: Array
    rms: tuple[float, float]
    guessed: float
    ended: str

    def warnings(self) -> list[str]:
        """What the data cannot tell."""
        labels = [parameter.label for parameter in self.parameters]
        said = [
            f"{label}: the measured amplitudes do not depend on it"
            if math.isinf(uncertainty)
            else f"{label}: ended at its limit, {value:.6g}"
            for label, value, uncertainty in zip(labels, self.values, self.uncertainty, strict=True)
            if not math.isfinite(uncertainty)
        ]
        others = np.abs(self.correlation - np.eye(len(labels))).argmax(axis=1)
        return said + [
            f"{labels[i]}: known {self.inflation[i]:.2g} times worse than with the others known; "
            f"most like it is {labels[j]}, correlation {self.correlation[i, j]:+.3f}"
            for i, j in enumerate(others.tolist())
            if ALIKE < self.inflation[i] < math.inf
        ]


def difference(measured: Array, logarithms: bool) -> Difference:
    """What is squared and summed: ln(simulated / measured), or (simulated - measured) over the rms
    of all that was measured."""
    if logarithms:
        return lambda simulated: np.log(simulated / measured)
    size = math.sqrt(np.mean(measured**2))
    return lambda simulated: (simulated - measured) / size


def rms(values: Array) -> float:
    """Root of the mean square."""
    return math.sqrt(np.mean(values**2))


def fit(
    scene: Scene,
    measured: MeasuredAmplitudes,
    parameters: Sequence[Parameter],
    *,
    logarithms: bool = True,
    progress: Callable[[float], None] | None = None,
) -> Fit:
    """Find the parameters by least squares (SciPy's trust region), Jacobian by differences.

    A rotor alone is fitted by harmonic balance first, in a hundredth of the time of runs; these
    go on from there, and have the last word.

    Args:
        progress: called with the finished fraction, at most.

    Raises:
        UserError: there are no more measured values than parameters; or as `Model`.
        SimulationError: a run has failed.
    """
    values = measured.values
    if len(values) <= len(parameters):
        raise UserError(
            f"{measured.path}: {len(values)} measured values for {len(parameters)} free "
            "parameters: there must be more"
        )
    model, differ = Model(scene, parameters, measured), difference(values, logarithms)
    scale = np.array([parameter.start for parameter in parameters])
    first, guessed = np.ones(len(parameters)), math.nan
    with suppress(NoResponse):
        first, guessed = _first_guess(HarmonicModel(scene, parameters, measured), model, differ)
    solution = _search(model, differ, first, progress)
    uncertainty, correlation, inflation = _known(solution.jac, solution.fun)
    uncertainty = np.where(solution.active_mask == 0, uncertainty, math.nan)
    before = rms(differ(model.amplitudes(scale[None])[0]))
    return Fit(
        tuple(parameters),
        solution.x * scale,
        uncertainty * np.abs(scale),
        correlation,
        inflation,
        model.amplitudes(solution.x[None] * scale)[0],
        (before, rms(solution.fun)),
        guessed,
        solution.message,
    )


def _first_guess(harmonic: HarmonicModel, model: Model, differ: Difference) -> tuple[Array, float]:
    """Parameters over their starts (p,) by harmonic balance, and its rms.

    Once more with what it misses of the runs there (one set of them): these then have little to do.

    Raises:
        NoResponse: it has no answer.
        SimulationError: a run has failed.
    """
    scale = np.array([parameter.start for parameter in model.parameters])
    guess = _search(harmonic, differ, np.ones(len(scale)))
    runs, own = (differ(one.amplitudes(guess.x[None] * scale)[0]) for one in (model, harmonic))
    closer = _search(harmonic, lambda amplitudes: differ(amplitudes) + runs - own, guess.x)
    return closer.x, rms(guess.fun)


def _search(
    model: Model,
    differ: Difference,
    first: Array,
    progress: Callable[[float], None] | None = None,
) -> Any:
    """SciPy's result of a search from `first` (p,), of parameters over their starts."""
    parameters, steps = model.parameters, 0
    scale = np.array([parameter.start for parameter in parameters])
    bounds = np.sort([np.array(parameter.limits) / parameter.start for parameter in parameters]).T

    def differences(sizes: Array) -> Array:
        return differ(model.amplitudes(sizes[None] * scale)[0])

    def jacobian(sizes: Array) -> Array:
        nonlocal steps
        steps += 1
        if progress:
            progress(min(1.0, steps / MOST_STEPS))
        ahead = np.where(sizes + STEP <= bounds[1], STEP, -STEP)
        sets = np.vstack([sizes, sizes + np.diag(ahead)])
        nearby = differ(model.amplitudes(sets * scale))
        slopes = ((nearby[1:] - nearby[0]) / ahead[:, None]).T
        # rounding must not drive what has no effect
        return np.where(_seen(slopes), slopes, 0.0)

    return least_squares(
        differences,
        first,
        jacobian,
        bounds=bounds,
        x_scale="jac",
        xtol=ENOUGH,
        ftol=ENOUGH,
        max_nfev=MOST_STEPS,
    )


def predicted_rms(
    scene: Scene, measured: MeasuredAmplitudes, found: Fit, logarithms: bool = True
) -> float:
    """Rms of the difference from other measurements, with the values that were found.

    Raises:
        SimulationError: a run has failed.
    """
    simulated = Model(scene, found.parameters, measured).amplitudes(found.values[None])[0]
    return rms(difference(measured.values, logarithms)(simulated))


def _seen(jacobian: Array) -> NDArray[np.bool_]:
    """Parameters (p,) that have an effect."""
    sizes = np.linalg.norm(jacobian, axis=0)
    return sizes > BLIND * sizes.max()


def _known(jacobian: Array, left: Array) -> tuple[Array, Array, Array]:
    """Half intervals (p,), correlation (p, p), inflation (p,): linear theory about the minimum.

    What is left is taken as scatter, independent and alike: what the model itself lacks widens the
    intervals, but moves the values besides.
    """
    seen, count = _seen(jacobian), jacobian.shape[1]
    uncertainty, inflation = np.full((2, count), math.inf)
    correlation = np.eye(count)
    if seen.any():
        sizes = np.linalg.norm(jacobian[:, seen], axis=0)
        _, strengths, directions = np.linalg.svd(jacobian[:, seen] / sizes, full_matrices=False)
        strengths = np.maximum(strengths, np.finfo(float).eps * strengths[0])
        inverse = (directions.T / strengths**2) @ directions
        inflation[seen] = np.sqrt(inverse.diagonal())
        freedom = len(left) - len(sizes)
        factor = student.ppf(0.5 * (1.0 + CONFIDENCE), freedom)
        uncertainty[seen] = factor * rms(left) * math.sqrt(len(left) / freedom) / sizes
        uncertainty *= inflation
        correlation[np.ix_(seen, seen)] = inverse / np.outer(inflation[seen], inflation[seen])
    return uncertainty, correlation, inflation
