"""Signals of a system measured over time: a CSV file with a column `time [s]` and one a signal."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...models.arrays import Array
from ..errors import UserError
from ..input_files import CsvRow, read_csv
from ..master.foreign.abilities import variable_of
from ..master.foreign.measures import Incompatible, conversion, measured, measures
from ..master.unit_run import UnitRun
from ..scene.messages import did_you_mean
from ..scene.system import System

TIME = "time"
_HEAD = re.compile(r"(?P<name>.*?)\s*(?:\[(?P<unit>[^\[\]]*)\])?")


@dataclass(frozen=True, eq=False)
class MeasuredSignals:
    """Signals over time.

    Attributes:
        path: of the file.
        time: (n,) rising [s].
        signals: (n,) by `unit.variable`, as the FMUs measure them; NaN where not measured.
    """

    path: Path
    time: Array
    signals: dict[str, Array]

    @property
    def values(self) -> Array:
        """All values that were measured, column after column."""
        return self.flat(self.signals)

    def flat(self, columns: dict[str, Array]) -> Array:
        """Columns (n,) by name, column after column, where something was measured."""
        return np.concatenate([columns[name][~np.isnan(own)] for name, own in self.signals.items()])

    def sequences(self) -> list[NDArray[np.int_]]:
        """Numbers of the values of each column, which follow each other in time."""
        counts = [int((~np.isnan(column)).sum()) for column in self.signals.values()]
        ends = np.cumsum(counts)
        return [np.arange(end - count, end) for count, end in zip(counts, ends, strict=True)]


def read_signals(path: Path, system: System) -> MeasuredSignals:
    """Read a file whose heads are `time [s]` and `unit.variable [UNIT]`.

    A unit of measurement is converted to the FMU's; without one the numbers are in the FMU's.

    Raises:
        UserError: the file cannot be read, or a head or a cell is wrong.
    """
    heads, rows = read_csv(path)
    with UnitRun(system) as run:
        columns = {head: _column(path, head, run) for head in heads}
    names = [name for name, _ in columns.values()]
    if names.count(TIME) != 1 or len(names) < 2:
        raise UserError(f"{path}: must have a column {TIME} [s] and one at least UNIT.VARIABLE")
    for name in names:
        if names.count(name) > 1:
            raise UserError(f"{path}: {name}: given twice")
    found = {
        name: factor * np.array([_number(row, head) for row in rows])
        for head, (name, factor) in columns.items()
    }
    time = found.pop(TIME)
    if not (np.isfinite(time).all() and (np.diff(time) > 0.0).all() and time[0] >= 0.0):
        raise UserError(f"{path}: {TIME}: must be numbers from 0 on that rise from row to row")
    if time[-1] > system.run.duration:
        raise UserError(
            f"{path}: {TIME}: ends at {time[-1]:g} s, beyond run.duration = "
            f"{system.run.duration:g} s: set that higher"
        )
    for name, column in found.items():
        if np.isnan(column).all():
            raise UserError(f"{path}: {name}: has no values")
    return MeasuredSignals(path, time, found)


def _column(path: Path, head: str, run: Any) -> tuple[str, float]:
    """Name of a column, and the factor to what the FMU measures it in."""
    name, unit = _name_and_unit(head, run)
    if name == TIME:
        target, defined = "s", None
    else:
        owner, _, variable = name.partition(".")
        if owner not in run.units or not variable:
            near = did_you_mean(owner, [TIME, *run.units])
            raise UserError(
                f"{path}: {head}: must be {TIME} [s] or UNIT.VARIABLE{near}; units: "
                f"{', '.join(run.units)}"
            )
        declared = variable_of(run.units[owner], variable, f"{path}: {head}")
        target = measured(declared)
        defined = measures(run.units[owner].description).get(target)
    try:
        return name, conversion(unit, target, (None, defined))
    except Incompatible as error:
        raise UserError(f"{path}: {head}: the FMU measures it in {target}: {error}") from None


def _name_and_unit(head: str, run: Any) -> tuple[str, str]:
    """Name and unit of measurement of a head; `m.x[1]` is an element where the FMU has it."""
    owner, _, variable = head.partition(".")
    if owner in run.units and variable in run.units[owner].variables:
        return head, ""
    match = _HEAD.fullmatch(head)
    assert match is not None
    return match["name"], match["unit"] or ""


def _number(row: CsvRow, head: str) -> float:
    """A cell; NaN where it is empty."""
    if not row.cells.get(head, ""):
        return math.nan
    value = row.number(head)
    if not math.isfinite(value):
        raise UserError(f"{row.place}: {head} = {value}: must be a finite number")
    return value
