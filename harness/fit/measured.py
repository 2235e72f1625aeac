"""Measured amplitudes: a CSV file whose heads say what was set and what was measured."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path

import numpy as np

from ...models.arrays import Array
from ..errors import UserError
from ..input_files import read_csv
from ..master.alike import refuse_unvaried
from ..master.names import station_residuals
from ..scene import Scene
from ..units import RPM
from .parameters import value_at

AMPLITUDE, LARGEST, SPEED = "amplitude", "residual", "speed"
Factors = dict[str | None, float]

_HEAD = re.compile(r"(?P<name>\S+)(?:\s+\[(?P<unit>.*)\])?")
_LENGTHS: Factors = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, None: 1.0}
_SPEEDS: Factors = {"rad/s": 1.0, "rpm": RPM, "Hz": math.tau, None: 1.0}


@dataclass(frozen=True, eq=False)
class MeasuredAmplitudes:
    """Amplitudes that were measured, each while the machine ran at one constant speed.

    Attributes:
        path: of the file.
        settings: (n,) values by path of the scene, the speed as `speed` [rad/s].
        amplitudes: (n,) by what is measured [m], NaN where it was not: `amplitude`, the mean over
            the supports of the largest sqrt(x^2 + y^2); `residual`, the largest of all stations;
            or of one, such as `rotor.station[2].residual`.
    """

    path: Path
    settings: dict[str, Array]
    amplitudes: dict[str, Array]

    @property
    def values(self) -> Array:
        """All that was measured, column after column [m]."""
        every = np.concatenate(list(self.amplitudes.values()))
        return every[~np.isnan(every)]


def read_measured(path: Path, scene: Scene) -> MeasuredAmplitudes:
    """Read a file, in any form that `read_csv` takes.

    A head is NAME or NAME [UNIT]: speed [rpm], [Hz] or [rad/s]; amplitudes [mm], [um] or [m];
    values of the scene by their path, in the scene's units.

    Raises:
        UserError: the file cannot be read, or a head or a cell is wrong.
    """
    columns, rows = read_csv(path)
    heads = [_HEAD.fullmatch(column) for column in columns]
    if None in heads:
        raise UserError(f"{path}: a column is named NAME or NAME [UNIT], such as speed [rpm]")
    names = [head["name"] for head in heads if head]
    if repeated := {name for name in names if names.count(name) > 1}:
        raise UserError(f"{path}: {', '.join(sorted(repeated))}: given twice")
    known = [AMPLITUDE, LARGEST, *station_residuals(len(scene.rotor.stations))]
    table = np.array(
        [[row.number(c) if row.cells[c] else math.nan for row in rows] for c in columns]
    )
    settings, amplitudes = {}, {}
    for head, column in zip(filter(None, heads), table, strict=True):
        name, unit = head["name"], head["unit"]
        if name in known:
            amplitudes[name] = column * _factor(path, name, unit, _LENGTHS)
        else:
            factors: Factors = _SPEEDS if name == SPEED else {None: 1.0}
            _refuse_unknown(path, scene, name, known)
            settings[name] = column * _factor(path, name, unit, factors)
    _refuse_wrong(path, settings, amplitudes, known)
    return MeasuredAmplitudes(path, settings, amplitudes)


def _factor(path: Path, name: str, unit: str | None, factors: Factors) -> float:
    if unit not in factors:
        allowed = ", ".join(one for one in factors if one) or "none, the scene's own holds"
        raise UserError(f"{path}: {name} [{unit}]: unit must be one of: {allowed}")
    return factors[unit]


def _refuse_unknown(path: Path, scene: Scene, name: str, known: list[str]) -> None:
    """A head that is no setting of the scene either."""
    if name == SPEED:
        return
    try:
        refuse_unvaried(scene, name)
        value_at(scene, name)
    except UserError as error:
        near = get_close_matches(name, [SPEED, *known], 1) or [f"speed [{name}]"] * (
            name in _SPEEDS
        )
        meant = f"; did you mean {near[0]}?" if near else ""
        raise UserError(f"{path}: {name}: neither measured nor set{meant} ({error})") from None


def _refuse_wrong(
    path: Path, settings: dict[str, Array], amplitudes: dict[str, Array], known: list[str]
) -> None:
    if not amplitudes:
        raise UserError(f"{path}: nothing measured: a head must be one of: {', '.join(known)}")
    for name, column in settings.items():
        if not np.isfinite(column).all():
            raise UserError(f"{path}: {name}: every row must have a number")
    for name, column in amplitudes.items():
        if (np.isnan(column) | (np.isfinite(column) & (column > 0.0))).all():
            continue
        raise UserError(f"{path}: {name}: must be above 0, or empty where it was not measured")
    if all(np.isnan(column).all() for column in amplitudes.values()):
        raise UserError(f"{path}: no amplitude is given")
