"""Columns of a vibration that has a phase, and the run-out that is subtracted from it.

x = Re(A e^{i theta}) with the rotor's angle theta: A is what is read, as amplitude and phase or as
its two parts.  A phase that leads is counted like theta, one that lags the other way.  Run-out is
what the sensor shows of the surface while the rotor turns slowly; it has the same columns.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..models.arrays import Complex
from .errors import UserError
from .measurements import Column, Known, Measurements

SIZES = ("m", "m/s", "m/s^2")
_OTHER_RUNOUTS = ("run_out", "slow_roll")
_WHICH_WAY = (
    "which way is it counted? must be one of phase_lead_deg (counted like the rotor's angle, as "
    "the masses' angles) and phase_lag_deg (counted the other way)"
)


@dataclass(frozen=True)
class Vibration:
    """Vibration of a sensor, row by row.

    Attributes:
        values: (n,) A, run-out subtracted, in `unit`; NaN where nothing was measured; real and not
            below 0 without phases.
        has_phase: whether the table has phases.
        has_runout: whether a run-out was subtracted.
        unit: of the values, as the table's head has it, such as "mil pp".
        factor: from `unit` to SI, 0-peak.
        symbol: of the SI unit; empty where the unit is not known.
    """

    values: Complex
    has_phase: bool
    has_runout: bool
    unit: str
    factor: float
    symbol: str


def columns(prefix: str = "", units: Sequence[str] = SIZES) -> tuple[Known, ...]:
    """Columns of a vibration and its run-out; `prefix` comes before every name."""
    found: list[Known] = []
    for what, others in (("", ()), ("runout", _OTHER_RUNOUTS)):
        phase = f"{what}_" if what else ""
        size = (f"{prefix}{what or 'amplitude'}", tuple(prefix + other for other in others))
        found.append(Known(size[0], tuple(units), is_size=True, others=size[1]))
        for name, unit in (("phase_lead", ("rad",)), ("phase_lag", ("rad",))):
            more = tuple(f"{prefix}{other}_{name}" for other in others)
            found.append(Known(f"{prefix}{phase}{name}", unit, others=more))
        found.append(Known(f"{prefix}{phase}phase", ("rad",), refused=_WHICH_WAY))
        for name in ("in_phase", "quadrature_lead", "quadrature_lag"):
            more = tuple(f"{prefix}{other}_{name}" for other in others)
            whole = f"{prefix}{phase}{name}"
            found.append(Known(whole, tuple(units), is_size=True, others=more))
    return tuple(found)


def read_vibration(
    table: Measurements, prefix: str = "", sensors: Sequence[str] = ()
) -> Vibration | None:
    """Vibration of a table that has these columns; None where it has none of them.

    Args:
        prefix: of the names.
        sensors: (rows,) whose run-out an empty cell repeats; default: all are one sensor.

    Raises:
        UserError: a column is missing, there are two of one thing, a cell is wrong, or there is a
            run-out but no phase.
    """
    own = _read(table, prefix, "")
    runout = _read(table, prefix, "runout_")
    if own is None:
        if runout is None:
            return None
        raise UserError(f"{table.path}: {prefix}runout: there is no {prefix}amplitude beside it")
    (values, has_phase, size) = own
    if runout is not None:
        swung, runout_has_phase, other = runout
        if not (has_phase and runout_has_phase):
            raise UserError(
                f"{table.path}: {other.head}: a run-out is subtracted as a vector: give its phase "
                "and that of the vibration, as phase_lead or phase_lag [deg]"
            )
        if (size.symbol, size.unit * (not size.symbol)) != (
            other.symbol,
            other.unit * (not other.symbol),
        ):
            raise UserError(
                f"{table.path}: {other.head}: must measure the same as {size.head}, in "
                f"{size.symbol or size.unit}"
            )
        values = values - _filled(table, other, swung, sensors)
    unit, factor = size.unit or size.symbol, size.factor
    return Vibration(values / factor, has_phase, runout is not None, unit, factor, size.symbol)


def _read(
    table: Measurements, prefix: str, kind: str
) -> tuple[Complex, bool, Column] | None:  # in SI
    """Values (rows,), whether they have a phase, and the column that tells their unit."""
    place, names = table.path, ("phase_lead", "phase_lag", "quadrature_lead", "quadrature_lag")
    size = table.column(prefix + (kind[:-1] or "amplitude"))
    part = table.column(f"{prefix}{kind}in_phase")
    lead, lag, q_lead, q_lag = (table.column(f"{prefix}{kind}{name}") for name in names)
    if not any((size, part, lead, lag, q_lead, q_lag)):
        return None
    for one, other in ((lead, lag), (q_lead, q_lag), (size, part)):
        if one and other:
            raise UserError(f"{place}: {one.head} and {other.head}: give one of them")
    phase, quadrature = lead or lag, q_lead or q_lag
    if part or quadrature:
        if part is None or quadrature is None or phase:
            raise UserError(
                f"{place}: give {prefix}{kind}in_phase and {prefix}{kind}quadrature_lead (or "
                "quadrature_lag), without a phase"
            )
        real, imaginary = table.numbers(part), table.numbers(quadrature)
        _refuse_other_unit(table, part, quadrature)
        return real + 1j * imaginary * (-1.0 if q_lag else 1.0), True, _told(part, table)
    if size is None:
        assert phase is not None
        raise UserError(f"{place}: {phase.head}: there is no amplitude beside it")
    amplitude = table.numbers(size)
    for row, value in zip(table.rows, amplitude.tolist(), strict=True):
        if value < 0.0:
            cell = row.cells[size.head]
            raise UserError(f"{row.place}: {size.known.name} = {cell}: must not be below 0")
    if phase is None:
        return amplitude.astype(complex), False, _told(size, table)
    angle = table.numbers(phase) * (1.0 if lead else -1.0)
    for row, value, turn in zip(table.rows, amplitude.tolist(), angle.tolist(), strict=True):
        if value > 0.0 and math.isnan(turn):
            raise UserError(f"{row.place}: {phase.head}: empty, beside an amplitude")
    return amplitude * np.exp(1j * np.nan_to_num(angle)), True, _told(size, table)


def _refuse_other_unit(table: Measurements, one: Column, other: Column) -> None:
    both = [(c.symbol, c.unit if not c.symbol else "") for c in (one, other)]
    if both[0] != both[1]:
        raise UserError(f"{table.path}: {one.head}, {other.head}: must be in one unit")


def _told(column: Column, table: Measurements) -> Column:
    """The column; where its head has no unit, with that of its first cell."""
    return column if column.unit else table.with_unit_of_a_cell(column)


def _filled(
    table: Measurements, column: Column, values: Complex, sensors: Sequence[str]
) -> Complex:
    """Run-outs with the empty ones filled: a sensor has one, if the table states one."""
    filled = values.copy()
    whose = np.array(sensors or [""] * len(values))
    for sensor in dict.fromkeys(whose.tolist()):
        own = whose == sensor
        stated = np.unique(values[own & ~np.isnan(values)])
        empty = own & np.isnan(values)
        if not empty.any():
            continue
        if len(stated) != 1:
            of = f" of {sensor}" if sensor else ""
            raise UserError(
                f"{table.path}: {column.head}: empty in a line{of}: give one run-out{of}, or one "
                "in every line (0 where there is none)"
            )
        filled[empty] = stated[0]
    return filled
