"""Runs measured in the workshop, from a CSV file: what was mounted and how the sensors answered.

One line per run, speed and sensor:

    run,speed [rpm],sensor,amplitude [um],phase_lag [deg],mass[1] [g],angle[1] [deg],radius[1] [mm]
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...models.arrays import Array, Complex
from ..errors import UserError
from ..measurements import Known, Measurements, read_measurements
from ..units import RPM
from ..vibration import Vibration, columns, read_vibration

_GRAM, _MILLIMETRE = 1e-3, 1e-3
_PER_PLANE = (
    Known("mass", ("kg",), per_plane=True),
    Known("angle", ("rad",), per_plane=True),
    Known("radius", ("m",), per_plane=True),
)
ONLY = "sensor"  # its name where a file names none
KNOWN = (Known("run"), Known("sensor"), Known("speed", ("rad/s",)), *columns(), *_PER_PLANE)


@dataclass(frozen=True, eq=False)
class MeasuredRuns:
    """Runs of one machine, the first of them the reference.

    Attributes:
        runs: their names.
        sensors: (s,) each with its speed where there are several: "front at 3000 rpm".
        unit: of the amplitudes.
        planes: names of the correction planes.
        radii: (p,) at which masses are mounted [mm]; None where the file has no radius.
        speeds: (s,) [rad/s].
        responses: (r, s) complex amplitudes, run-out subtracted; their phases are counted like the
            masses' angles. Without phases they are real.
        mounted: (r, p) mass and angle in each plane, at its radius [g].
        has_phase: whether phases were measured.
        has_runout: whether a run-out was subtracted.
    """

    runs: tuple[str, ...]
    sensors: tuple[str, ...]
    unit: str
    planes: tuple[str, ...]
    radii: tuple[float, ...] | None
    speeds: Array
    responses: Complex
    mounted: Complex
    has_phase: bool = True
    has_runout: bool = False


def read_measured(path: Path) -> MeasuredRuns:
    """Runs from a CSV file.

    Raises:
        UserError: it cannot be read, or something in it is missing, twice or no number; the message
            names the line or the run, and what is needed.
    """
    any_unit = [known.name for known in KNOWN if known.is_size]
    table = read_measurements(path, KNOWN, takes_any_unit=any_unit)
    names = [column.known.name for column in table.columns]
    if "run" not in names:
        raise UserError(f"{path}: needs a column `run`; has {', '.join(names)}")
    planes = tuple(p for p in table.planes if table.column("mass", p))
    if lost := [p for p in table.planes if p not in planes]:
        raise UserError(f"{path}: plane {', '.join(lost) or 1}: has no column `mass[PLANE] [g]`")
    if not planes:
        raise UserError(
            f"{path}: needs columns `mass[1] [g]` and `angle[1] [deg]` of every plane, such as "
            "mass[1] [g] or mass_g[1]"
        )
    which = _texts(table, "run")
    runs = tuple(dict.fromkeys(which))
    radii = _radii(table, planes)
    mounted = _mounted(table, planes, which, runs)
    shown = tuple(plane or "1" for plane in planes)
    unmoved = [p for p, m in zip(shown, mounted.T, strict=True) if not np.ptp(np.abs(m - m[0]))]
    if unmoved:
        raise UserError(
            f"{path}: a trial run is missing: in no run does the mass in plane "
            f"{', '.join(unmoved)} differ from that of the reference, {runs[0]!r}"
        )
    vibration, by_run = _readings(table, which)
    sensors, speeds, responses = _by_sensor(path, runs, by_run)
    return MeasuredRuns(
        runs,
        sensors,
        vibration.unit,
        shown,
        radii,
        speeds,
        responses,
        mounted,
        vibration.has_phase,
        vibration.has_runout,
    )


Readings = dict[str, dict[str, tuple[float, complex]]]  # by run and sensor: speed, amplitude


def _texts(table: Measurements, name: str) -> list[str]:
    column = table.column(name)
    assert column is not None
    return table.texts(column)


def _mounted(
    table: Measurements, planes: Sequence[str], which: Sequence[str], runs: Sequence[str]
) -> Complex:
    """(r, p) mass and angle in each plane during each run [g]; an empty mass is none."""
    mounted = np.zeros((len(runs), len(planes)), complex)
    for p, plane in enumerate(planes):
        masses = np.nan_to_num(_column(table, "mass", plane, "g")) / _GRAM
        angles = np.where(masses != 0.0, _column(table, "angle", plane, "deg"), 0.0)
        for row, angle in zip(table.rows, angles.tolist(), strict=True):
            if math.isnan(angle):
                raise UserError(f"{row.place}: angle[{plane or 1}]: empty, beside a mass")
        vectors = masses * np.exp(1j * angles)
        for r, run in enumerate(runs):
            own = {v for v, name in zip(vectors.tolist(), which, strict=True) if name == run}
            if len(own) > 1:
                raise UserError(
                    f"{table.path}: run {run!r}: its lines do not agree on the mass in plane "
                    f"{plane or 1}"
                )
            mounted[r, p] = own.pop()
    return mounted


def _column(table: Measurements, name: str, plane: str, unit: str) -> Array:
    """(rows,) of a column of a plane, in SI."""
    column = table.column(name, plane)
    if column is None:
        brackets = f"[{plane}]" if plane else ""
        raise UserError(f"{table.path}: needs a column `{name}{brackets} [{unit}]`")
    return table.numbers(column)


def _radii(table: Measurements, planes: Sequence[str]) -> tuple[float, ...] | None:
    """One radius a plane [mm]: where trial masses were and corrections will be."""
    if not any(column.known.name == "radius" for column in table.columns):
        return None
    radii = []
    for plane in planes:
        values = _column(table, "radius", plane, "mm") / _MILLIMETRE
        given = np.unique(values[~np.isnan(values)])
        if len(given) != 1 or not given[0] > 0.0:
            raise UserError(
                f"{table.path}: radius[{plane or 1}]: must be one radius above 0 mm in all lines"
            )
        radii.append(float(given[0]))
    return tuple(radii)


def _readings(table: Measurements, which: Sequence[str]) -> tuple[Vibration, Readings]:
    """The vibration of all lines, and by run and sensor."""
    path, is_named = table.path, table.column("sensor") is not None
    names = _texts(table, "sensor") if is_named else [ONLY] * len(table.rows)
    vibration = read_vibration(table, sensors=names)
    if vibration is None:
        raise UserError(f"{path}: needs the column `amplitude [um]`, in any unit")
    speed = table.column("speed")
    speeds = np.zeros(len(names)) if speed is None else table.numbers(speed)
    by_run: Readings = {}
    lines = zip(table.rows, which, names, speeds, vibration.values.tolist(), strict=True)
    for row, run, sensor, rate, value in lines:
        if math.isnan(rate) or math.isnan(abs(value)):
            what = "speed" if math.isnan(rate) else "amplitude"
            raise UserError(f"{row.place}: {what}: must be a number; the cell is empty")
        if speed is not None and rate <= 0.0:
            raise UserError(f"{row.place}: speed = {rate / RPM:g} rpm: must be above 0")
        reading = f"{sensor} at {rate / RPM:g} rpm" if rate else sensor
        readings = by_run.setdefault(run, {})
        if reading in readings:
            several = "" if is_named else "; with several sensors add a column `sensor`"
            raise UserError(f"{row.place}: run {run!r}: {reading} is read twice{several}")
        readings[reading] = (float(rate), value)
    return vibration, by_run


def _by_sensor(
    path: Path, runs: Sequence[str], by_run: Readings
) -> tuple[tuple[str, ...], Array, Complex]:
    """Sensors, their speeds (s,) and complex amplitudes (r, s)."""
    sensors = tuple(by_run[runs[0]])
    for run in runs:
        if odd := sorted(set(by_run[run]) ^ set(sensors)):
            raise UserError(
                f"{path}: runs {runs[0]!r} and {run!r} do not have the same readings: "
                f"{', '.join(odd)} in one alone"
            )
    speeds = np.array([by_run[runs[0]][sensor][0] for sensor in sensors])
    return sensors, speeds, np.array([[by_run[r][s][1] for s in sensors] for r in runs])
