"""What a unit of foreign origin may end a run by, and its freeing, which may hang."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from ...errors import SimulationError, UnitError
from . import crashes

if TYPE_CHECKING:
    from .instance import ForeignUnit

PATIENCE = 5.0  # s in which a unit must come back when it is freed


class UnitFailure(UnitError, SimulationError):
    """A unit of foreign origin failed while it ran: the file is to blame, and the run has ended."""


class EndAsked(SimulationError):
    """A unit asks to end the simulation: nothing has failed, and the run ends there."""


def free_in_time(unit: ForeignUnit, acts: Sequence[Callable[[], Any]]) -> None:
    """Do what ends and frees an instance; what it raises is ignored.

    Raises:
        UnitFailure: it does not come back.
    """
    freeing = threading.Thread(target=_quietly, args=(unit, *acts), daemon=True)
    freeing.start()
    freeing.join(PATIENCE)
    if freeing.is_alive():
        raise UnitFailure(
            f"{unit.name} ({unit.path.name}): hangs when it is freed: not back after {PATIENCE:g} s"
        )


def _quietly(unit: ForeignUnit, *acts: Any) -> None:
    crashes.asked.append((unit, "freeing"))
    for act in acts:
        with suppress(Exception):  # nothing can be done about a unit that fails when it is freed
            act()
    crashes.asked.pop()
