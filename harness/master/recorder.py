"""Recording: what is asked for at every communication point."""

from __future__ import annotations

from array import array
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError
from ..scene import Scene
from .fmu import Fmu
from .names import by_unit, stations

Signal = NDArray[np.float64]


def recorded(scene: Scene) -> list[str]:
    """Signals the scene asks for; by default the rotor's motion and what each balancer does."""
    if scene.run.record is not None:
        return list(scene.run.record)
    prefixes = stations(len(scene.rotor.stations))
    names = [f"rotor.{prefix}{axis}" for prefix in prefixes for axis in "xy"]
    return names + [f"{b.label}.{variable}" for b in scene.balancer for variable in b.records]


class Recorder:
    """Rows of recorded signals, filled as the run goes.

    Args:
        units: by name.
        names: `unit.variable`.

    Attributes:
        signal_units: what each signal is measured in.

    Raises:
        SceneError: a name is not `unit.variable` of this scene.
    """

    def __init__(self, units: Mapping[str, Fmu], names: Sequence[str]) -> None:
        names = list(dict.fromkeys(names))
        for name in names:
            unit, _, variable = name.partition(".")
            if unit not in units or variable not in units[unit].variables:
                known = ", ".join(units[unit].variables) if unit in units else ", ".join(units)
                raise SceneError(
                    f"run.record: {name!r} is not recorded by any unit; known: {known}"
                )
        wanted = by_unit(names)
        self._row, end = np.zeros(1 + len(names)), 1  # time, then every unit's signals
        self._bytes = self._row.data.cast("B")
        self.groups = []
        for unit, variables in wanted.items():
            begin, end = end, end + len(variables)
            self.groups.append((units[unit], units[unit].group(variables, self._row[begin:end])))
        self.signal_units = {
            f"{unit}.{v}": units[unit].measured_in[v]
            for unit, variables in wanted.items()
            for v in variables
        }
        self.names = list(self.signal_units)
        self.rows = array("d")

    def take(self, time: float) -> None:
        """Record the present values."""
        self._row[0] = time
        for unit, group in self.groups:
            unit.fetch(group)
        self.rows.frombytes(self._bytes)

    def columns(self) -> tuple[Signal, dict[str, Signal]]:
        """Times [s], and every signal by name."""
        table = np.array(self.rows).reshape(-1, 1 + len(self.names))
        return table[:, 0].copy(), {n: table[:, i].copy() for i, n in enumerate(self.names, 1)}
