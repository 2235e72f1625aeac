"""Search for the values of parameters by least squares, and how well these are known."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.special import stdtrit

from ...models.arrays import Array
from ...models.harmonic_balance import NoResponse
from .model import HarmonicModel, Model
from .parameters import Parameter

if TYPE_CHECKING:
    from ..output.workers import Progress

STEP = 1e-3  # of a parameter's start: far above the error of a run, far below what bends a curve
SEED, SPREAD = 1, 0.5  # of the starts that are drawn; deviation of their logarithms
ENOUGH = 1e-5  # change of a parameter or of the sum of squares at which the fit has ended
CONFIDENCE = 0.95
BLIND = 1e-6  # of the strongest parameter's effect: none at all


def rms(values: Array) -> float:
    """Root of the mean square."""
    return math.sqrt(np.mean(values**2))


def difference(simulated: Array, measured: Array, is_phase: NDArray[np.bool_]) -> Array:
    """Of logarithms and phases (..., n); phases differ by half a turn at most."""
    found = simulated - measured
    turns = np.where(is_phase, np.round(found / math.tau), 0.0)
    return found - math.tau * turns


class Guess(NamedTuple):
    """What harmonic balance finds."""

    closer: Any  # SciPy's result, of parameters over their starts
    rms: float  # of harmonic balance
    starts: int  # from which it found values


def first_guess(
    harmonic: HarmonicModel,
    model: Model,
    logarithms: Array,
    is_phase: NDArray[np.bool_],
    starts: int,
    progress: Progress | None,
) -> Guess:
    """By harmonic balance, the best of several starts.

    Once more with what it misses of the runs there (one set of them): these then have little to do.

    Args:
        logarithms: of the measured amplitudes, and phases.

    Raises:
        NoResponse: it has no answer, from whatever start.
        SimulationError: a run has failed.
    """
    scale = np.array([parameter.start for parameter in model.parameters])
    found, reason = [], NoResponse()
    for number, first in enumerate(_drawn(model.parameters, starts)):
        try:
            found.append(search(harmonic, logarithms, is_phase, first))
        except NoResponse as error:
            reason = error
        if progress:
            progress((number + 1) / (starts + 1))
    if not found:
        raise reason
    best = min(found, key=lambda one: one.cost)
    runs = model.logarithms(best.x[None] * scale)[0]
    own = best.fun[: len(runs)]  # priors follow
    missed = difference(runs - own, logarithms, is_phase)
    closer = search(harmonic, logarithms - missed, is_phase, best.x)
    return Guess(closer, rms(own), len(found))


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


class Searched(Protocol):
    """What has parameters, and what would be measured with them: logarithms, or signals."""

    most_steps: int
    parameters: Sequence[Parameter]

    def logarithms(self, sets: Array) -> Array:
        """(s, values) with parameters (s, p)."""


def search(
    model: Searched,
    logarithms: Array,
    is_phase: NDArray[np.bool_],
    first: Array,
    progress: Progress | None = None,
) -> Any:
    """SciPy's result of a search from `first` (p,), of parameters over their starts.

    What is least are the squares of ln(simulated / measured), of complex amplitudes where phases
    were measured: an error of 1 % and one of 0.01 rad count alike.  Priors are rows after these.
    """
    parameters, steps = model.parameters, 0
    scale = np.array([parameter.start for parameter in parameters])
    bounds, pulls = _bounds(parameters), np.diag([parameter.pull for parameter in parameters])
    pulls = pulls[pulls.any(axis=1)]

    def differences(sizes: Array) -> Array:
        simulated = model.logarithms(sizes[None] * scale)[0]
        own = difference(simulated, logarithms, is_phase)
        return np.concatenate([own, pulls @ (sizes - 1.0)])

    def jacobian(sizes: Array) -> Array:
        nonlocal steps
        steps += 1
        if progress:
            progress(min(1.0, steps / model.most_steps))
        ahead = np.where(sizes + STEP <= bounds[1], STEP, -STEP)
        sets = np.vstack([sizes, sizes + np.diag(ahead)])
        nearby = model.logarithms(sets * scale)
        slopes = (difference(nearby[1:], nearby[0], is_phase) / ahead[:, None]).T
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


def _seen(jacobian: Array) -> NDArray[np.bool_]:
    """Parameters (p,) that have an effect."""
    sizes = np.linalg.norm(jacobian, axis=0)
    return sizes > BLIND * sizes.max()


def known(jacobian: Array, left: Array) -> tuple[Array, Array, Array]:
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
        factor = stdtrit(freedom, 0.5 * (1.0 + CONFIDENCE))  # Student's
        uncertainty[seen] = factor * rms(left) * math.sqrt(len(left) / freedom) / sizes
        uncertainty *= inflation
        correlation[np.ix_(seen, seen)] = inverse / np.outer(inflation[seen], inflation[seen])
    return uncertainty, correlation, inflation
