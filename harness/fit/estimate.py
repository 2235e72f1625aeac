"""What a fit has found of the values that were free, and what the data cannot tell of them."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Generic, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from ...models.arrays import Array
from ...models.readable import brief
from ..errors import UserError
from ..output.outcome import Outcome
from ..output.table import Sheet
from .parameters import Parameter
from .systematic import SIGNIFICANCE

ALIKE = math.sqrt(10.0)  # a variance inflation of 10 is commonly taken for too much


class Described(Protocol):
    """What has values: a scene or a system."""

    @property
    def heading(self) -> str: ...
    def replace(self, changes: Mapping[str, Any], /) -> Any: ...
    def unit_of(self, path: str) -> str: ...


Start = TypeVar("Start", bound=Described)


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Estimate(Outcome, Generic[Start]):
    """Values that were found by least squares.

    Attributes:
        start: what was fitted.
        parameters, values: (p,) what was free, and what it is.
        uncertainty: (p,) half the interval of 95 % confidence; infinite where the data do not tell,
            NaN where a value ended at its limit or the residuals are systematic.
        correlation: (p, p) of the values.
        inflation: (p,) of the interval, over that with all other values known.
        significance: probability that independent scatter looks as systematic as the residuals;
            NaN where there are too few to tell.
        at_limit: (p,) whether a value ended at its limit.
        rms: of the residuals, before and after.
        ended: why the search has.
    """

    measures: ClassVar[str]  # what is measured, in the plural

    start: Start
    parameters: tuple[Parameter, ...]
    values: Array
    uncertainty: Array
    correlation: Array
    inflation: Array
    significance: float
    at_limit: NDArray[np.bool_]
    rms: tuple[float, float]
    ended: str

    @property
    def is_systematic(self) -> bool:
        """Whether residuals of neighbours deviate alike, so that no interval is known."""
        return self.significance < SIGNIFICANCE

    @property
    def labels(self) -> list[str]:
        """A name of every parameter."""
        return [one.label for one in self.parameters]

    def table(self) -> Sheet:
        """A line a parameter, in the units of what was fitted."""
        starts = [one.start for one in self.parameters]
        units = [self.start.unit_of(one.paths[0]) for one in self.parameters]
        columns = (self.labels, units, starts, self.values.tolist(), self.uncertainty.tolist())
        rows = list(zip(*columns, strict=True))
        heads = ("parameter", "unit", "start", "fitted", "± (95 %)")
        return Sheet(heads, rows, "llrrr", self.start.heading)

    def warnings(self) -> list[str]:
        """What the data cannot tell."""
        labels = self.labels
        said = [
            f"{label}: the measured {self.measures} do not depend on it"
            for label, spread in zip(labels, self.uncertainty, strict=True)
            if math.isinf(spread)
        ]
        said += [
            f"{label}: ended at its limit, {value:.6g}"
            for label, value, ended in zip(labels, self.values, self.at_limit, strict=True)
            if ended
        ]
        said += self._of_residuals()
        others = np.abs(self.correlation - np.eye(len(labels))).argmax(axis=1)
        return said + [
            f"{labels[i]}: known {brief(self.inflation[i])} times worse than with the others "
            f"known; most like it is {labels[j]}, correlation {self.correlation[i, j]:+.3f}"
            for i, j in enumerate(others.tolist())
            if ALIKE < self.inflation[i] < math.inf
        ]

    def _fitted(self) -> Any:
        """What was fitted, with the values that were found."""
        pairs = zip(self.parameters, self.values.tolist(), strict=True)
        return self.start.replace({k: v for one, x in pairs for k, v in one.changes(x).items()})

    @abstractmethod
    def _of_residuals(self) -> list[str]:
        """What residuals show, or may hide."""

    def _systematic(self) -> str:
        """How residuals that are systematic are seen."""
        return (
            "deviate alike (independent scatter does so in "
            f"{brief(100.0 * self.significance)} % of files, the limit is "
            f"{100.0 * SIGNIFICANCE:g} %)"
        )


def refuse_few(path: str | Path, count: int, parameters: Sequence[Parameter]) -> None:
    """Refuse measurements that are no more than the free parameters.

    Raises:
        UserError: with both numbers.
    """
    if count <= len(parameters):
        raise UserError(
            f"{path}: {count} measured value{'s' * (count != 1)} for {len(parameters)} free "
            f"parameter{'s' * (len(parameters) != 1)}: there must be more"
        )


def of_values(
    parameters: Sequence[Parameter], solution: Any, significance: float, uncertainty: Array
) -> dict[str, Any]:
    """Fields of an estimate that follow from the search's solution, in shares of the starts.

    Args:
        uncertainty: (p,) half the interval of 95 % confidence, over the starts; given where a value
            did not end at its limit and the residuals are not systematic.
    """
    scale = np.array([one.start for one in parameters])
    at_limit = solution.active_mask != 0
    withheld = at_limit | (significance < SIGNIFICANCE) & np.isfinite(uncertainty)
    return {
        "parameters": tuple(parameters),
        "values": solution.x * scale,
        "uncertainty": np.where(withheld, math.nan, uncertainty * np.abs(scale)),
        "significance": significance,
        "at_limit": at_limit,
        "ended": str(solution.message),
    }


def document_of_values(found: Estimate[Any], measured: Path, count: int) -> dict[str, Any]:
    """For JSON: what was fitted to how many measured values, and what is known of the values."""
    columns = (found.parameters, found.values.tolist(), found.uncertainty.tolist())
    rows = zip(found.labels, found.correlation.tolist(), strict=True)
    return {
        "scene": found.start.heading,
        "measured": str(measured),
        "values": count,
        "rms_before": found.rms[0],
        "rms": found.rms[1],
        "ended": found.ended,
        "parameters": [
            {"path": one.label, "start": one.start, "value": value, "uncertainty": spread}
            for one, value, spread in zip(*columns, strict=True)
        ],
        "correlation": {name: dict(zip(found.labels, row, strict=True)) for name, row in rows},
        "significance": found.significance,
        "warnings": found.warnings(),
    }
