"""States of the coupled units, kept for a step that is taken back."""

from __future__ import annotations

from collections.abc import Sequence
from ctypes import c_void_p

from .fmu import Fmu


class SavedStates:
    """States of units, held within a `with` block; their memory serves the next such block.

    Args:
        spare: where it goes at the end of the block.
    """

    __slots__ = ("_spare", "_states", "_units")

    def __init__(self, units: Sequence[Fmu], spare: list[SavedStates]) -> None:
        self._units, self._spare = units, spare
        self._states: list[c_void_p] = []

    def __enter__(self) -> list[c_void_p]:
        return self.save()

    def __exit__(self, *_exception: object) -> None:
        self._spare.append(self)

    def save(self) -> list[c_void_p]:
        """The states as they are now."""
        try:
            if self._states:
                for unit, state in zip(self._units, self._states, strict=True):
                    unit.save(state)
            else:
                for unit in self._units:
                    self._states.append(unit.save())
        except BaseException:
            self.free()
            raise
        return self._states

    def free(self) -> None:
        """Free the states."""
        for unit, state in zip(self._units, self._states, strict=False):  # saving may have failed
            unit.free(state)
        self._states = []
