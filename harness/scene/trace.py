"""A measured speed as a profile: lines through few of its readings, and how far they are off."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...models.arrays import Array
from ..errors import SceneError, UserError, outer_level
from ..input_files import named_from
from ..units import RPM

if TYPE_CHECKING:
    from ..measurements import Measurements

NEAR = 2e-3  # of the highest speed: how far lines may pass a reading
ROUNDING = 1e-12  # of the highest speed: a reading so near to a line lies on it
MOST_LINES = 200  # every corner ends a step; from there on lines may pass by more


class TraceNote(UserWarning):
    """How far the lines that stand for a measured speed are off."""


def with_corners(document: dict[str, Any], folder: Path) -> dict[str, Any]:
    """A scene's document, the CSV file that its profile names replaced by corners.

    Raises:
        SceneError: the file cannot be read, or is no speed against time.
    """
    operation = document.get("operation")
    name = operation.get("profile") if isinstance(operation, dict) else None
    if not isinstance(operation, dict) or not isinstance(name, str):
        return document
    try:
        corners = corners_of(named_from(folder, name))
    except UserError as error:
        raise SceneError(f"operation.profile: {error}") from None
    return {**document, "operation": {**operation, "profile": corners}}


def corners_of(path: Path) -> list[list[float]]:
    """Corners [s, rad/s] of lines through the readings of a file, the first of them at 0 s.

    Warns:
        TraceNote: with the number of lines, and the largest distance of a reading from them.

    Raises:
        UserError: the file cannot be read, or is no speed against time.
    """
    from ..measurements import Known, read_measurements  # few scenes have one

    known = Known("time", ("s",)), Known("speed", ("rad/s",))
    found = read_measurements(path, known)
    columns = [found.column(one.name) for one in known]
    if None in columns:
        raise UserError(f"{path}: needs the columns `time [s]` and `speed [rpm]`")
    time, speed = (found.all_numbers(column) for column in columns if column)
    _refuse_wrong(found, time, speed)
    start = float(time[0])
    time, near = time - start, NEAR * float(speed.max())
    while len(at := _corners(time, speed, near)) > MOST_LINES + 1:
        near *= 2.0
    off = float(np.abs(np.interp(time, time[at], speed[at]) - speed).max())
    begins = f"; times count from the first reading, at {start:.6g} s" if start else ""
    lines = f"{len(at) - 1} line{'s' if len(at) > 2 else ''}"
    fit = f"lie on {lines}"
    if off > ROUNDING * speed.max():
        fit = (
            f"are approximated by {lines}, which deviate{'' if len(at) > 2 else 's'} by "
            f"{off / RPM:.3g} rpm at most, {off / speed.max():.2g} of the highest speed"
        )
    warnings.warn(
        f"{path.name}: {len(time)} readings {fit}{begins}",
        TraceNote,
        outer_level(),
    )
    return np.column_stack([time[at], speed[at]]).tolist()


def _refuse_wrong(found: Measurements, time: Array, speed: Array) -> None:
    """Raise UserError, with the line, for what is no speed [rad/s] against ascending time [s]."""
    places = [row.place for row in found.rows]
    if len(time) < 2:
        raise UserError(f"{found.path}: one reading: must have two at least")
    if (back := np.flatnonzero(np.diff(time) <= 0.0)).size:
        k = int(back[0])
        raise UserError(
            f"{places[k + 1]}: time = {time[k + 1]:.6g} s, after {time[k]:.6g} s: times must ascend"
        )
    if (below := np.flatnonzero(speed < 0.0)).size:
        raise UserError(
            f"{places[below[0]]}: speed = {speed[below[0]] / RPM:.6g} rpm: must be 0 or more"
        )
    if not speed.max() > 0.0:
        raise UserError(f"{found.path}: every speed is 0: must be above 0 somewhere")


def _corners(time: Array, speed: Array, near: float) -> list[int]:
    """Readings through which lines pass all others within `near` (Douglas and Peucker 1973)."""
    kept, open_parts = {0, len(time) - 1}, [(0, len(time) - 1)]
    while open_parts:
        first, last = open_parts.pop()
        inner = slice(first, last + 1)
        line = np.interp(time[inner], time[[first, last]], speed[[first, last]])
        farthest = first + int(np.argmax(off := np.abs(speed[inner] - line)))
        if off.max() > near:
            kept.add(farthest)
            open_parts += [(first, farthest), (farthest, last)]
    return sorted(kept)
