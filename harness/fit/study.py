"""Least squares between measured amplitudes and those of runs in C, and how well it is known."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ...models.arrays import Array
from ...models.harmonic_balance import NoResponse
from ..errors import UserError
from ..output.outcome import Outcome
from ..output.table import Sheet
from ..scene import Scene
from .measured import MeasuredAmplitudes, read_measured
from .model import HarmonicModel, Model
from .parameters import Parameter
from .search import first_guess, known, rms, search

if TYPE_CHECKING:
    from ..output.workers import Progress

ALIKE = math.sqrt(10.0)  # a variance inflation of 10 is commonly taken for too much


@dataclass(frozen=True, eq=False, repr=False)
class Fit(Outcome):
    """What was found.

    Attributes:
        start: the scene that was fitted.
        measured: amplitudes.
        parameters, values: (p,) what was free, and what it is.
        uncertainty: (p,) half the interval of 95 % confidence; infinite where the data do not tell,
            NaN where a value ended at its limit.
        correlation: (p, p) of the values.
        inflation: (p,) of the interval, over that with all other values known.
        simulated: (n,) amplitudes with these values, as `MeasuredAmplitudes.values` [m].
        rms: of ln(simulated / measured), before and after.
        guessed: rms that harmonic balance has with its own values, the least of all starts;
            NaN: the scene is not for it.
        starts: from how many harmonic balance found values.
        ended: why the search has.
    """

    drawn_by: ClassVar[str] = "..fit.plot:plot_fit"
    document_by: ClassVar[str] = "..fit.report:document"

    start: Scene
    measured: MeasuredAmplitudes
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

    @property
    def scene(self) -> Scene:
        """The scene with the values that were found."""
        pairs = zip(self.parameters, self.values.tolist(), strict=True)
        return self.start.replace({k: v for one, x in pairs for k, v in one.changes(x).items()})

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
        simulated = Model(self.start, self.parameters, others).amplitudes(self.values[None])[0]
        return rms(np.log(simulated / others.values))

    def table(self) -> Sheet:
        """A line a parameter, in SI units."""
        starts = [parameter.start for parameter in self.parameters]
        labels = [parameter.label for parameter in self.parameters]
        columns = (labels, starts, self.values.tolist(), self.uncertainty.tolist())
        rows = list(zip(*columns, strict=True))
        return Sheet(("parameter", "start", "fitted", "± (95 %)"), rows, "lrrr", self.start.heading)

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
    values = measured.values
    if len(values) <= len(parameters):
        raise UserError(
            f"{measured.path}: {len(values)} measured values for {len(parameters)} free "
            "parameters: there must be more"
        )
    model, logarithms = Model(scene, parameters, measured), np.log(values)
    scale = np.array([parameter.start for parameter in parameters])
    guess = None
    try:
        by_harmonic = HarmonicModel(scene, parameters, measured)
        guess = first_guess(by_harmonic, model, logarithms, starts, progress if harmonic else None)
    except NoResponse as error:
        if harmonic or starts > 1:
            raise UserError(f"{scene.name}: no fit by harmonic balance: {error}") from None
    if guess and harmonic:
        solution = guess.closer
    else:
        first = guess.closer.x if guess else np.ones(len(parameters))
        solution = search(model, logarithms, first, progress)
    uncertainty, correlation, inflation = known(solution.jac, solution.fun)
    uncertainty = np.where(solution.active_mask == 0, uncertainty, math.nan)
    before, simulated = model.amplitudes(np.array([scale, solution.x * scale]))
    return Fit(
        scene,
        measured,
        tuple(parameters),
        solution.x * scale,
        uncertainty * np.abs(scale),
        correlation,
        inflation,
        simulated,
        (rms(np.log(before / values)), rms(np.log(simulated / values))),
        guess.rms if guess else math.nan,
        guess.starts if guess else 0,
        solution.message,
    )
