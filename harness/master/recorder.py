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
        watched: others that are only compared, not asked for.

    Attributes:
        names: those asked for, by unit.
        signal_units: what each signal is measured in.

    Raises:
        SceneError: a name is not `unit.variable` of this scene.
    """

    def __init__(
        self, units: Mapping[str, Fmu], names: Sequence[str], watched: Sequence[str] = ()
    ) -> None:
        every = list(dict.fromkeys([*names, *watched]))
        for name in every:
            unit, _, variable = name.partition(".")
            if unit not in units or variable not in units[unit].variables:
                known = ", ".join(units[unit].variables) if unit in units else ", ".join(units)
                raise SceneError(
                    f"run.record: {name!r} is not recorded by any unit; known: {known}"
                )
        wanted = by_unit(every)
        self.groups = [(units[unit], units[unit].group(v)) for unit, v in wanted.items()]
        self.signal_units = {
            f"{unit}.{v}": units[unit].measured_in[v]
            for unit, variables in wanted.items()
            for v in variables
        }
        self.names = [name for name in self.signal_units if name in names]
        self.rows = array("d")

    def take(self, time: float) -> None:
        """Record the present values."""
        self.rows.append(time)
        for unit, group in self.groups:
            unit.fetch(group)
            self.rows.frombytes(group.bytes)

    def columns(self) -> tuple[Signal, dict[str, Signal]]:
        """Times [s], and every signal by name, those watched as well."""
        table = np.array(self.rows).reshape(-1, 1 + len(self.signal_units))
        return table[:, 0].copy(), {
            n: table[:, i].copy() for i, n in enumerate(self.signal_units, 1)
        }
