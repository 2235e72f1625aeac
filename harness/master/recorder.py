"""Recording: what is asked for at every communication point."""

from __future__ import annotations

from array import array
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError
from ..output.memory import free_memory, refuse_beyond
from ..scene import Scene
from ..scene.messages import did_you_mean
from .names import OF_STOPS, by_unit, displacements

Signal = NDArray[np.float64]
REPORTED = 256  # steps between two reports of progress: some ten a second
_TELLING = 0.01  # of the free memory: so much tells what the whole run needs
_COPIES = 3  # rows, their table, and the signals made of it


def recorded(scene: Scene) -> list[str]:
    """Signals the scene asks for; by default the rotor's motion and what each balancer does."""
    if scene.run.record is not None:
        return list(scene.run.record)
    names = displacements(len(scene.rotor.points))
    numbers = range(1, len(scene.rotor.stops) + 1)
    names += [f"rotor.stop[{k}].{what}" for k in numbers for what in OF_STOPS]
    names += ["motor.speed"] if scene.operation.motor else []
    # what a balancer of another origin has, it need not call as ours do
    own = [balancer for balancer in scene.balancer if not balancer.fmu]
    return names + [f"{b.label}.{variable}" for b in own for variable in b.records]


class Recorder:
    """Rows of recorded signals, filled as the run goes.

    Args:
        units: by name; what reads variables as an `Fmu` does.
        names: `unit.variable`.
        watched: others that are only compared, not asked for.

    Attributes:
        names: those asked for, by unit.
        signal_units: what each signal is measured in.

    Raises:
        SceneError: a name is not `unit.variable` of this scene.
    """

    def __init__(
        self, units: Mapping[str, Any], names: Sequence[str], watched: Sequence[str] = ()
    ) -> None:
        every = list(dict.fromkeys([*names, *watched]))
        wanted = by_unit(every)
        for name in every:
            unit, _, variable = name.partition(".")
            if unit not in units or variable not in units[unit].variables:
                raise SceneError(
                    f"run.record: {name!r} is not recorded by any unit{_known(units, name)}"
                )
        self._row, end = np.zeros(1 + len(every)), 1  # time, then every unit's signals
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
        self.names = [name for name in self.signal_units if name in names]
        self.rows = array("d")
        self._looked_at = 0  # numbers that were recorded when memory was last looked at

    def record(self, time: float) -> None:
        """Record the present values."""
        self._row[0] = time
        for unit, group in self.groups:
            unit.fetch(group)
        self.rows.frombytes(self._bytes)

    def values(self) -> Signal:
        """Present values, in the order of the groups."""
        for unit, group in self.groups:
            unit.fetch(group)
        return self._row[1:].copy()

    def append(self, time: float, values: Signal) -> None:
        """Record values at a time [s], in the order of the groups."""
        self._row[0], self._row[1:] = time, values
        self.rows.frombytes(self._bytes)

    def extend(self, rows: NDArray[np.float64]) -> None:
        """Record rows of times and values, in the order of the groups."""
        if rows.size:  # a view of nothing has no bytes
            self.rows.frombytes(rows.data.cast("B"))

    def refuse_too_much(self, done: float) -> None:
        """Refuse a record that will not fit into memory, judged by the finished fraction of a run.

        Raises:
            UserError: with what it needs.
        """
        if len(self.rows) < 2 * self._looked_at:
            return
        self._looked_at = len(self.rows)
        present, free = _COPIES * self.rows.itemsize * len(self.rows), free_memory()
        if present > _TELLING * free:  # first steps can be far shorter than most
            what = f"run.revolutions, run.record: {len(self.names)} signals of the whole run need"
            refuse_beyond(free, present / done, what, "record less, or run shorter")

    def columns(self) -> tuple[Signal, dict[str, Signal]]:
        """Times [s], and every signal by name, those watched as well."""
        table = np.frombuffer(self.rows).reshape(-1, 1 + len(self.signal_units))
        return table[:, 0].copy(), {
            n: table[:, i].copy() for i, n in enumerate(self.signal_units, 1)
        }


def _known(units: Mapping[str, Any], name: str) -> str:
    """What may stand in place of a name that no unit has: the nearest, and all of its unit."""
    unit, dot, variable = name.partition(".")
    every = [f"{one}.{each}" for one in units for each in units[one].variables]
    alike = [each for each in every if each.partition(".")[2] in (name, variable)]
    near = f' (did you mean "{alike[0]}"?)' if alike else did_you_mean(name, every)
    if dot and unit in units:
        return f"{near}; {unit} has: {', '.join(units[unit].variables)}"
    return f"{near}; a name is UNIT.VARIABLE, of the units {', '.join(units)}"


def present_values(units: Mapping[str, Any], names: Sequence[str]) -> dict[str, float]:
    """Values of signals as they are now, by name; arguments as of `Recorder`."""
    recorder = Recorder(units, names)
    recorder.record(0.0)
    return {name: float(values[0]) for name, values in recorder.columns()[1].items()}


def divided(grid: Signal, parts: int) -> Signal:
    """Points that divide every step between those of a grid."""
    begins, lengths = grid[:-1, np.newaxis], np.diff(grid)[:, np.newaxis]
    return np.append(begins + np.arange(parts) / parts * lengths, grid[-1])
