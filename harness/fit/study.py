"""Least squares between measured amplitudes and those of runs in C, and how well it is known."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from ...models.arrays import Array
from ...models.harmonic_balance import NoResponse
from ...models.readable import brief
from ..errors import UserError, refuse_count
from ..scene import Scene
from .estimate import Estimate, of_values, refuse_few
from .measured import SPEED, MeasuredAmplitudes, read_measured
from .model import HarmonicModel, Model
from .parameters import Parameter
from .runout import SIGNIFICANCE as RUNOUT_SIGNIFICANCE
from .runout import Runout, find_runout
from .search import Guess, difference, first_guess, known, rms, search
from .systematic import significance

if TYPE_CHECKING:
    from ..output.workers import Progress

ANOTHER_MACHINE = 1.0  # rms of the residuals: amplitudes that miss by a factor of e


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Fit(Estimate[Scene]):
    """What was found, in SI units; intervals are wider than from scatter where a run-out is likely.

    Attributes:
        measured: amplitudes.
        simulated: (n,) amplitudes with these values, as `MeasuredAmplitudes.values` [m].
        residuals: ln(simulated / measured), then differences of phases [rad], as
            `MeasuredAmplitudes.logarithms`.
        runout: constant run-outs that explain the residuals best; None where all are subtracted.
        guessed: rms that harmonic balance has with its own values, the least of all starts;
            NaN: the scene is not for it.
        starts: from how many harmonic balance found values.
    """

    drawn_by: ClassVar[str] = "..fit.plot:plot_fit"
    document_by: ClassVar[str] = "..fit.report:document"
    measures: ClassVar[str] = "amplitudes"

    measured: MeasuredAmplitudes
    simulated: Array
    residuals: Array
    runout: Runout | None
    guessed: float
    starts: int

    @property
    def scene(self) -> Scene:
        """The scene with the values that were found."""
        found: Scene = self._fitted()
        return found

    def predicted_rms(self, measured: str | Path) -> float:
        """Rms of the difference from other measurements, with the values that were found.

        Raises:
            UserError: the file is wrong.
            SimulationError: a run has failed.

        >>> rotor = ab.load("two_balls").without_balancers()
        >>> rows = ["speed [rad/s],amplitude [mm]", "0.5,0.5", "1.5,2.0", "2.5,1.2"]
        >>> text = open("measured.csv", "w").write("\\n".join(rows))
        >>> found = rotor.fit("measured.csv", "rotor.unbalance", harmonic=True)
        >>> found.predicted_rms("measured.csv") < 0.5  # of ln(simulated / measured)
        True
        """
        others = read_measured(Path(measured), self.start)
        simulated = Model(self.start, self.parameters, others).logarithms(self.values[None])[0]
        return rms(difference(simulated, others.logarithms, others.is_phase))

    def _of_residuals(self) -> list[str]:
        """What residuals show, or may hide."""
        if self.rms[1] > ANOTHER_MACHINE:
            factor, other = math.exp(self.rms[1]), ""
            if self.start.balancer:
                other = "; if it was measured without its balancers, use --without-balancers"
            return [
                f"the fitted scene misses the measurements by a factor of {factor:.2g} (rms): it "
                f"is another machine, and its values mean nothing{other}"
            ]
        likely = self.runout is not None and self.runout.is_likely
        if self.is_systematic:
            with_runout = f". {self._with_runout()}" if likely else ""
            return [
                f"residuals of neighbours {self._systematic()}: something is missing in the scene "
                "or was not subtracted, such as a run-out; the values can be off by more than any "
                f"interval from scatter, so none is given{with_runout}"
            ]
        if likely:
            return [f"{self._with_runout()}; the intervals include both: subtract the run-out"]
        return self._of_hidden_runout()

    def _with_runout(self) -> str:
        """How well a run-out explains the residuals, and the values with it."""
        assert self.runout is not None
        sizes = ", ".join(f"{size:.2g} m in {name}" for name, size in self.runout.sizes.items())
        starts = np.array([parameter.start for parameter in self.parameters])
        pairs = zip(self.labels, self.values + self.runout.shift * starts, strict=True)
        values = ", ".join(f"{label} = {value:.6g}" for label, value in pairs)
        return (
            f"A constant run-out ({sizes}) would explain {100.0 * self.runout.explained:.0f} % of "
            "the squares of the residuals (in independent scatter, in "
            f"{brief(100.0 * self.runout.chance)} % of files; the limit is "
            f"{100.0 * RUNOUT_SIGNIFICANCE:g} %), with {values}"
        )

    def _of_hidden_runout(self) -> list[str]:
        """Values that a run-out can change without a trace."""
        if self.runout is None:
            return []
        starts = np.array([abs(parameter.start) for parameter in self.parameters])
        hidden = np.flatnonzero(self.runout.is_hidden(self.uncertainty / starts))
        return [
            f"{self.parameters[k].label}: a run-out of 10 % of the amplitude would move it by up "
            f"to {self.runout.pull[k] * starts[k]:.2g} and not show in the residuals; the interval "
            "assumes that there is none"
            for k in hidden.tolist()
        ]


def fit(
    scene: Scene,
    measured: MeasuredAmplitudes,
    parameters: Sequence[Parameter],
    *,
    harmonic: bool = False,
    starts: int = 1,
    progress: Progress | None = None,
) -> Fit:
    """Find the parameters by least squares (SciPy's trust region), Jacobian by differences.

    A rotor alone is fitted by harmonic balance first, in a hundredth of the time of runs; these
    go on from there, and have the last word.

    Arguments are those of `Scene.fit`, which says what is raised.
    """
    refuse_count(starts, "starts")
    refuse_few(measured.path, len(measured.logarithms), parameters)
    model, logarithms = Model(scene, parameters, measured), measured.logarithms
    is_phase = measured.is_phase
    scale = np.array([parameter.start for parameter in parameters])
    reporting = progress if harmonic else None
    guess, closest, refused = _guess(model, scene, measured, starts, reporting)
    if refused and (harmonic or starts > 1):
        raise UserError(f"{scene.label}: no fit by harmonic balance: {refused}")
    if guess and harmonic:
        solution = guess.closer
    else:
        first = guess.closer.x if guess else np.ones(len(parameters))
        solution = search(model, logarithms, is_phase, first, progress)
    uncertainty, correlation, inflation = known(solution.jac, solution.fun)
    own = slice(len(logarithms))  # priors follow
    chance = significance(solution.fun[own], solution.jac[own], _sequences(measured))
    runout = find_runout(
        solution.fun,
        solution.jac,
        measured,
        closest.turning(solution.x * scale),
    )
    uncertainty = runout.widened(uncertainty) if runout else uncertainty
    before, after = model.logarithms(np.array([scale, solution.x * scale]))
    residuals = difference(after, logarithms, is_phase)
    return Fit(
        start=scene,
        measured=measured,
        correlation=correlation,
        inflation=inflation,
        simulated=np.exp(after[~is_phase]),
        residuals=residuals,
        runout=runout,
        rms=(rms(difference(before, logarithms, is_phase)), rms(residuals)),
        guessed=guess.rms if guess else math.nan,
        starts=guess.starts if guess else 0,
        **of_values(parameters, solution, chance, uncertainty),
    )


def _guess(
    model: Model, scene: Scene, measured: MeasuredAmplitudes, starts: int, progress: Progress | None
) -> tuple[Guess | None, Model, str]:
    """What harmonic balance finds, and the model that is nearest to it; why it has no answer."""
    try:
        harmonic = HarmonicModel(scene, model.parameters, measured)
        found = first_guess(
            harmonic, model, measured.logarithms, measured.is_phase, starts, progress
        )
    except NoResponse as error:
        return None, model, str(error) or "it has no answer"
    return found, harmonic, ""


def _sequences(measured: MeasuredAmplitudes) -> list[NDArray[np.int_]]:
    """Numbers of residuals that are neighbours: of one column under one setting, by their speed."""
    column, row = measured.rows()
    settings = dict(measured.settings)
    speeds = settings.pop(SPEED, np.arange(float(measured.count)))
    kinds = np.array(list(settings.values())).T.reshape(measured.count, len(settings))
    _, kind = np.unique(kinds, axis=0, return_inverse=True)
    key = column * (int(kind.max()) + 1) + kind.ravel()[row]
    by_speed = np.argsort(speeds[row], kind="stable")
    return [by_speed[key[by_speed] == one] for one in np.unique(key)]
