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
from ..master.names import station_residuals
from ..result.alike import refuse_unvaried
from ..scene import Scene
from ..units import si_number
from .parameters import value_at

AMPLITUDE, LARGEST, SPEED = "amplitude", "residual", "speed"
_HEAD = re.compile(r"(?P<name>\S+)(?:\s+\[(?P<unit>.*)\])?")


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

    A head is NAME or NAME [UNIT]: speed [rpm], amplitude [mm], a path of the scene; without a unit
    in SI units.

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
    settings: dict[str, Array] = {}
    amplitudes: dict[str, Array] = {}
    for head, column in zip(filter(None, heads), table, strict=True):
        name, unit = head["name"], head["unit"]
        if name in known:
            symbol, found = "m", amplitudes
        else:
            _refuse_unknown(path, scene, name, known)
            symbol, found = "rad/s" if name == SPEED else scene.unit_of(name), settings
        factor = si_number(f"1 {unit}", symbol, f"{path}: {name}:") if unit else 1.0
        found[name] = factor * column
    _refuse_wrong(path, settings, amplitudes, known)
    return MeasuredAmplitudes(path, settings, amplitudes)


def _refuse_unknown(path: Path, scene: Scene, name: str, known: list[str]) -> None:
    """A head that is no setting of the scene either."""
    if name == SPEED:
        return
    try:
        refuse_unvaried(scene, name)
        value_at(scene, name)
    except UserError as error:
        near = get_close_matches(name, [SPEED, *known], 1) or [f"speed [{name}]"] * (
            name in ("rpm", "Hz")
        )
        meant = f"; did you mean {near[0]}?" if near else ""
        raise UserError(f"{path}: {name}: neither measured nor set{meant} ({error})") from None


def _refuse_wrong(
    path: Path, settings: dict[str, Array], amplitudes: dict[str, Array], known: list[str]
) -> None:
    if not amplitudes:
        raise UserError(f"{path}: nothing measured: a column must be one of: {', '.join(known)}")
    for name, column in settings.items():
        if not np.isfinite(column).all():
            raise UserError(f"{path}: {name}: every row must have a number")
    for name, column in amplitudes.items():
        if (np.isnan(column) | (np.isfinite(column) & (column > 0.0))).all():
            continue
        raise UserError(f"{path}: {name}: must be above 0, or empty where it was not measured")
    if all(np.isnan(column).all() for column in amplitudes.values()):
        raise UserError(f"{path}: no amplitude is given")
