"""Measured vibration: a CSV file whose heads say what was set and what was measured."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from difflib import get_close_matches
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...models.arrays import Array, Complex
from ..errors import UserError
from ..master.names import station_residuals, turning_parts
from ..measurements import Known, Measurements, read_measurements
from ..result.alike import refuse_unvaried
from ..scene import Scene
from ..vibration import columns, read_vibration
from .parameters import value_at

AMPLITUDE, LARGEST, SPEED = "amplitude", "residual", "speed"


@dataclass(frozen=True, eq=False)
class MeasuredAmplitudes:
    """Vibration that was measured, each while the machine ran at one constant speed.

    Attributes:
        path: of the file.
        settings: (n,) values by path of the scene, the speed as `speed` [rad/s].
        amplitudes: (n,) by what is measured [m], NaN where it was not: `amplitude`, the mean over
            the supports of the largest sqrt(x^2 + y^2); `residual`, the largest of all stations;
            or of one, such as `rotor.station[2].residual`.
        vibrations: (n,) complex amplitudes of a displacement at the rotor's frequency by its
            signal, such as `rotor.x` [m], run-out subtracted, NaN where it was not measured.
        phased: signals whose phase was measured.
        without_runout: signals of which a run-out was subtracted.
    """

    path: Path
    settings: dict[str, Array]
    amplitudes: dict[str, Array]
    vibrations: dict[str, Complex] = field(default_factory=dict)
    phased: frozenset[str] = frozenset()
    without_runout: frozenset[str] = frozenset()

    @property
    def sizes(self) -> dict[str, Array]:
        """(n,) by name all amplitudes, also those of vibrations with a phase [m]."""
        return {**self.amplitudes, **{name: np.abs(v) for name, v in self.vibrations.items()}}

    @property
    def values(self) -> Array:
        """All amplitudes that were measured, column after column [m]."""
        every = np.concatenate(list(self.sizes.values()))
        return every[~np.isnan(every)]

    @property
    def logarithms(self) -> Array:
        """Of `values`, then the phases that were measured, column after column [rad]."""
        return self.joined({name: np.log(c) for name, c in self.sizes.items()}, self.vibrations)

    @property
    def is_phase(self) -> NDArray[np.bool_]:
        """Which of `logarithms` are phases."""
        return np.arange(len(self.logarithms)) >= len(self.values)

    @property
    def count(self) -> int:
        """Rows of the table."""
        return len(next(iter(self.sizes.values())))

    def joined(self, logarithms: dict[str, Array], vibrations: dict[str, Complex]) -> Array:
        """(..., values) of what was measured, of columns (..., n) by name."""
        there = {name: ~np.isnan(column) for name, column in self.sizes.items()}
        sizes = [logarithms[name][..., there[name]] for name in self.sizes]
        phases = [
            np.angle(vibrations[name])[..., there[name]]
            for name in self.vibrations
            if name in self.phased
        ]
        return np.concatenate([*sizes, *phases], axis=-1)

    def rows(self) -> tuple[NDArray[np.int_], NDArray[np.int_]]:
        """Of every one of `logarithms` the number of its column and its row in the table."""
        columns = [~np.isnan(column) for column in self.sizes.values()]
        columns += [~np.isnan(self.vibrations[n].real) for n in self.vibrations if n in self.phased]
        numbers = [np.full(there.sum(), k) for k, there in enumerate(columns)]
        return np.concatenate(numbers), np.concatenate([np.flatnonzero(c) for c in columns])


def read_measured(path: Path, scene: Scene) -> MeasuredAmplitudes:
    """Read a file, in any form that `read_measurements` takes.

    Heads are speed [rpm], amplitude [mm], rotor.x.amplitude [um pp], rotor.x.phase_lag [deg], a
    path of the scene; without a unit in SI units, but for phases.

    Raises:
        UserError: the file cannot be read, or a head or a cell is wrong.
    """
    sized = [AMPLITUDE, LARGEST, *station_residuals(len(scene.rotor.points))]
    signals = list(
        dict.fromkeys(signal for signal, _ in turning_parts(len(scene.rotor.points)).values())
    )
    known = [Known(name, ("m",), needs_unit=False, is_size=True) for name in sized]
    known += [column for signal in signals for column in columns(f"{signal}.", ("m",))]
    speed = Known(SPEED, ("rad/s",), needs_unit=False)
    names = [speed.name, *sized, *(f"{signal}.amplitude" for signal in signals)]
    table = read_measurements(path, [speed, *known], lambda name: _setting(scene, name, names))
    settings: dict[str, Array] = {}
    amplitudes: dict[str, Array] = {}
    seen = {one.name for one in known}
    for column in table.columns:
        if column.known.name in sized:
            amplitudes[column.known.name] = table.numbers(column)
        elif column.known.name not in seen:
            settings[column.known.name] = table.numbers(column)
    measured = MeasuredAmplitudes(path, settings, amplitudes, *_vibrations(table, signals))
    _refuse_wrong(measured, names[1:], [row.place for row in table.rows])
    _refuse_settings(measured, scene, [row.place for row in table.rows])
    return measured


def _vibrations(
    table: Measurements, signals: list[str]
) -> tuple[dict[str, Complex], frozenset[str], frozenset[str]]:
    """By signal complex amplitudes [m]; those with a phase, those with a run-out subtracted."""
    found, phased, without_runout = {}, set(), set()
    for signal in signals:
        vibration = read_vibration(table, f"{signal}.")
        if vibration is not None:
            found[signal] = vibration.values * vibration.factor
            if vibration.has_phase:
                phased.add(signal)
            if vibration.has_runout:
                without_runout.add(signal)
    return found, frozenset(phased), frozenset(without_runout)


def _setting(scene: Scene, name: str, known: list[str]) -> Known:
    """The column of a head that is a path of the scene.

    Raises:
        UserError: it is none.
    """
    try:
        refuse_unvaried(scene, name)
        value_at(scene, name)
    except UserError as error:
        near = get_close_matches(name, known, 1) or [f"speed [{name}]"] * (name in ("rpm", "Hz"))
        meant = f"; did you mean {near[0]}?" if near else ""
        raise UserError(f"{name}: neither measured nor set{meant} ({error})") from None
    return Known(name, (scene.unit_of(name),), needs_unit=False)


def _refuse_settings(measured: MeasuredAmplitudes, scene: Scene, places: list[str]) -> None:
    """Refuse a value that the scene does not allow; each is looked at once."""
    for name, column in measured.settings.items():
        for value, row in zip(*np.unique(column, return_index=True), strict=True):
            if name == SPEED and value > 0.0:
                continue  # there may be many
            try:
                scene.replace({name: float(value)})
            except UserError as error:
                raise UserError(f"{places[row]}: {error}") from None


def _refuse_wrong(measured: MeasuredAmplitudes, known: list[str], places: list[str]) -> None:
    path = measured.path
    if not measured.sizes:
        raise UserError(f"{path}: nothing measured: a column must be one of: {', '.join(known)}")
    for name, column in measured.settings.items():
        if not np.isfinite(column).all():
            raise UserError(f"{path}: {name}: every row must have a number")
    for name, column in measured.sizes.items():
        for row in np.flatnonzero(column <= 0.0)[:1]:
            raise UserError(
                f"{places[row]}: {name}: must be above 0, or empty where it was not measured"
            )
    if all(math.isnan(value) for column in measured.sizes.values() for value in column.tolist()):
        raise UserError(f"{path}: no amplitude is given")
