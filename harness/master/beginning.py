"""The beginning of a run, to which the next one with the same start values goes back."""

from __future__ import annotations

from copy import copy

from .saved_states import SavedStates
from .system import System


class Beginning:
    """Where a run begins: states of units, and signals, to begin it again."""

    def __init__(self, system: System) -> None:
        self._system, self._units = system, list(system.units.values())
        self._saved = SavedStates(self._units, [])
        self.free = self._saved.free

    def keep(self) -> None:
        """Save states and signals of all units as the beginning of a run."""
        self._states = self._saved.save()
        self._signals = (*self._system.forces, *self._system.accelerations)
        self._kept = [copy(signal) for signal in self._signals]

    def again(self) -> None:
        """Bring all back to where the run began."""
        for unit, state in zip(self._units, self._states, strict=True):
            unit.restore(state)
            unit.time = 0.0
        for signal, kept in zip(self._signals, self._kept, strict=True):
            signal.now, signal.largest = kept.now, kept.largest
        if self._system.shaft:
            self._system.shaft.again()
        self._system.drop_past()
