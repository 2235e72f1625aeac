"""Runs measured in the workshop, from a CSV file: what was mounted and how the sensors answered.

One line per run, speed and sensor:

    run,speed_rpm,sensor,amplitude_um,phase_lag_deg,mass_g[1],angle_deg[1],radius_mm[1],...
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...models.arrays import Array, Complex
from ..errors import UserError
from ..input_files import CsvRow, read_csv

_WEIGHT = re.compile(r"(mass_g|angle_deg|radius_mm)\[(.+)\]")
_AMPLITUDE = re.compile(r"amplitude_(\w+)")
_PHASES = {"phase_lead_deg": 1.0, "phase_lag_deg": -1.0}


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
        responses: (r, s) complex amplitudes; their phases are counted like the masses' angles.
        mounted: (r, p) mass and angle in each plane, at its radius [g].
    """

    runs: tuple[str, ...]
    sensors: tuple[str, ...]
    unit: str
    planes: tuple[str, ...]
    radii: tuple[float, ...] | None
    speeds: Array
    responses: Complex
    mounted: Complex


def read_measured(path: Path) -> MeasuredRuns:
    """Runs from a CSV file.

    Raises:
        UserError: it cannot be read, or something in it is missing, twice or no number; the message
            names the line or the run, and what is needed.
    """
    names, rows = read_csv(path)
    if "run" not in names:
        raise UserError(f"{path}: needs a column `run`; has {', '.join(names)}")
    planes = tuple(dict.fromkeys(m[2] for n in names if (m := _WEIGHT.fullmatch(n))))
    if not planes:
        raise UserError(f"{path}: needs columns `mass_g[1]` and `angle_deg[1]` of every plane")
    runs = tuple(dict.fromkeys(row.cells["run"] for row in rows))
    lines = {name: [row for row in rows if row.cells["run"] == name] for name in runs}
    radii = _radii(path, rows, names, planes)
    mounted = np.array([[_mounted(path, lines[r], p) for p in planes] for r in runs])
    unmoved = [p for p, m in zip(planes, mounted.T, strict=True) if np.ptp(np.abs(m - m[0])) == 0.0]
    if unmoved:
        raise UserError(
            f"{path}: a trial run is missing: in no run does the mass in plane "
            f"{', '.join(unmoved)} differ from that of the reference, {runs[0]!r}"
        )
    unit, by_run = _readings(path, rows, names)
    sensors, speeds, responses = _table(path, runs, by_run)
    return MeasuredRuns(runs, sensors, unit, planes, radii, speeds, responses, mounted)


Readings = dict[str, dict[str, tuple[float, complex]]]  # by run and sensor: speed, amplitude


def _number(row: CsvRow, name: str) -> float:
    value = row.number(name)
    if not math.isfinite(value):
        raise UserError(f"{row.place}: {name} = {value}: must be a finite number")
    return value


def _mounted(path: Path, lines: Sequence[CsvRow], plane: str) -> complex:
    """Mass and angle in a plane during a run; an empty mass is none."""
    trials = set()
    for row in lines:
        mass = _number(row, f"mass_g[{plane}]") if row.cells.get(f"mass_g[{plane}]") else 0.0
        angle = math.radians(_number(row, f"angle_deg[{plane}]")) if mass else 0.0
        trials.add((mass, angle))
    if len(trials) > 1:
        raise UserError(
            f"{path}: run {lines[0].cells['run']!r}: its lines do not agree on the mass in plane "
            f"{plane}"
        )
    ((mass, angle),) = trials
    return mass * complex(math.cos(angle), math.sin(angle))


def _radii(
    path: Path, rows: Sequence[CsvRow], names: Sequence[str], planes: Sequence[str]
) -> tuple[float, ...] | None:
    """One radius a plane: where trial masses were and corrections will be."""
    if not any(name.startswith("radius_mm[") for name in names):
        return None
    radii = []
    for plane in planes:
        name = f"radius_mm[{plane}]"
        values = {_number(row, name) for row in rows if row.cells.get(name)}
        if len(values) != 1 or not min(values) > 0.0:
            raise UserError(f"{path}: {name}: must be one radius above 0 mm in all lines")
        radii.append(values.pop())
    return tuple(radii)


def _readings(path: Path, rows: Sequence[CsvRow], names: Sequence[str]) -> tuple[str, Readings]:
    """Unit of the amplitudes, and what was read."""
    units = [m[1] for name in names if (m := _AMPLITUDE.fullmatch(name))]
    phases = [name for name in names if name in _PHASES]
    if "sensor" not in names or len(units) != 1:
        raise UserError(
            f"{path}: needs the columns `sensor` and one `amplitude_UNIT`, such as amplitude_um"
        )
    if len(phases) != 1:
        raise UserError(
            f"{path}: needs one of the columns phase_lead_deg (counted like the masses' angles) "
            "and phase_lag_deg (counted the other way)"
        )
    by_run: Readings = {}
    for row in rows:
        run, sensor = row.cells["run"], row.cells["sensor"]
        amplitude = _number(row, f"amplitude_{units[0]}")
        phase = _PHASES[phases[0]] * math.radians(_number(row, phases[0]))
        if amplitude < 0.0:
            raise UserError(f"{row.place}: amplitude = {amplitude:g}: must not be below 0")
        rpm = _number(row, "speed_rpm") if "speed_rpm" in names else 0.0
        sensor += f" at {rpm:g} rpm" if rpm else ""
        readings = by_run.setdefault(run, {})
        if sensor in readings:
            raise UserError(f"{row.place}: run {run!r}: {sensor} is read twice")
        value = amplitude * complex(math.cos(phase), math.sin(phase))
        readings[sensor] = (rpm * math.pi / 30.0, value)
    return units[0], by_run


def _table(
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
