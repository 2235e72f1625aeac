"""Least squares between measured amplitudes and those of runs in C, and how well it is known."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

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
SEED, SPREAD = 1, 0.5  # of the starts that are drawn; deviation of their logarithms
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
        guessed: rms that harmonic balance has with its own values, the least of all starts;
            NaN: the scene is not for it.
        starts: from how many harmonic balance found values.
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
    starts: int
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
    harmonic: bool = False,
    starts: int = 1,
    progress: Callable[[float], None] | None = None,
) -> Fit:
    """Find the parameters by least squares (SciPy's trust region), Jacobian by differences.

    A rotor alone is fitted by harmonic balance first, in a hundredth of the time of runs; these
    go on from there, and have the last word.

    Args:
        harmonic: the search ends with harmonic balance; runs say what is left with its values.
        starts: of harmonic balance: the scene's, and others drawn about it.
        progress: called with the finished fraction, at most.

    Raises:
        UserError: there are no more measured values than parameters; harmonic balance is asked for
            and has no answer; or as `Model`.
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
    guess = None
    try:
        by_harmonic = HarmonicModel(scene, parameters, measured)
        guess = _first_guess(by_harmonic, model, differ, starts, progress if harmonic else None)
    except NoResponse as error:
        if harmonic or starts > 1:
            raise UserError(f"{scene.name}: no fit by harmonic balance: {error}") from None
    if guess and harmonic:
        solution = guess.closer
    else:
        first = guess.closer.x if guess else np.ones(len(parameters))
        solution = _search(model, differ, first, progress)
    uncertainty, correlation, inflation = _known(solution.jac, solution.fun)
    uncertainty = np.where(solution.active_mask == 0, uncertainty, math.nan)
    before, simulated = model.amplitudes(np.array([scale, solution.x * scale]))
    return Fit(
        tuple(parameters),
        solution.x * scale,
        uncertainty * np.abs(scale),
        correlation,
        inflation,
        simulated,
        (rms(differ(before)), rms(differ(simulated))),
        guess.rms if guess else math.nan,
        guess.starts if guess else 0,
        solution.message,
    )


class _Guess(NamedTuple):
    closer: Any  # SciPy's result, of parameters over their starts
    rms: float  # of harmonic balance
    starts: int  # from which it found values


def _first_guess(
    harmonic: HarmonicModel,
    model: Model,
    differ: Difference,
    starts: int,
    progress: Callable[[float], None] | None,
) -> _Guess:
    """By harmonic balance, the best of several starts.

    Once more with what it misses of the runs there (one set of them): these then have little to do.

    Raises:
        NoResponse: it has no answer, from whatever start.
        SimulationError: a run has failed.
    """
    scale = np.array([parameter.start for parameter in model.parameters])
    found, reason = [], NoResponse()
    for number, first in enumerate(_drawn(model.parameters, starts)):
        try:
            found.append(_search(harmonic, differ, first))
        except NoResponse as error:
            reason = error
        if progress:
            progress((number + 1) / (starts + 1))
    if not found:
        raise reason
    best = min(found, key=lambda one: one.cost)
    runs = differ(model.amplitudes(best.x[None] * scale)[0])
    own = best.fun[: len(runs)]  # priors follow
    closer = _search(harmonic, lambda amplitudes: differ(amplitudes) + runs - own, best.x)
    return _Guess(closer, rms(own), len(found))


def _drawn(parameters: Sequence[Parameter], starts: int) -> Iterator[Array]:
    """Where to start (p,), over the starts of the parameters: first from these, then about them.

    Directions are drawn from the whole turn.
    """
    random, bounds = np.random.default_rng(SEED), _bounds(parameters)
    turn = np.array([math.pi / abs(one.start) * one.is_angle for one in parameters])
    yield np.ones(len(parameters))
    for _ in range(starts - 1):
        sizes = np.exp(SPREAD * random.standard_normal(len(parameters)))
        angles = 1.0 + turn * random.uniform(-1.0, 1.0, len(parameters))
        yield np.clip(np.where(turn > 0.0, angles, sizes), *bounds)


def _bounds(parameters: Sequence[Parameter]) -> Array:
    """(2, p) over the starts."""
    return np.sort([np.array(parameter.limits) / parameter.start for parameter in parameters]).T


def _search(
    model: Model,
    differ: Difference,
    first: Array,
    progress: Callable[[float], None] | None = None,
) -> Any:
    """SciPy's result of a search from `first` (p,), of parameters over their starts.

    Priors are rows after those of the amplitudes.
    """
    parameters, steps = model.parameters, 0
    scale = np.array([parameter.start for parameter in parameters])
    bounds, pulls = _bounds(parameters), np.diag([parameter.pull for parameter in parameters])
    pulls = pulls[pulls.any(axis=1)]

    def differences(sizes: Array) -> Array:
        amplitudes = model.amplitudes(sizes[None] * scale)[0]
        return np.concatenate([differ(amplitudes), pulls @ (sizes - 1.0)])

    def jacobian(sizes: Array) -> Array:
        nonlocal steps
        steps += 1
        if progress:
            progress(min(1.0, steps / model.most_steps))
        ahead = np.where(sizes + STEP <= bounds[1], STEP, -STEP)
        sets = np.vstack([sizes, sizes + np.diag(ahead)])
        nearby = differ(model.amplitudes(sets * scale))
        slopes = ((nearby[1:] - nearby[0]) / ahead[:, None]).T
        # rounding must not drive what has no effect
        return np.vstack([np.where(_seen(slopes), slopes, 0.0), pulls])

    return least_squares(
        differences,
        first,
        jacobian,
        bounds=bounds,
        x_scale="jac",
        xtol=ENOUGH,
        ftol=ENOUGH,
        max_nfev=model.most_steps,
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
