"""Base class of the Python units: FMI 2.0 co-simulation over pythonfmu, without its traps.

A unit adds its equations in four methods, in this order: `parameters`, `begin`, `step`, `outputs`
(and `observe` for what is computed only when read).  Everything else is here and in `Values`.
"""

from __future__ import annotations

import json
import math
from typing import Any

from .host import keep
from .values import BEGINNING, COMPUTED, FRESH, OBSERVED, Values

POINT_OF_STEP, POINT_OF_TIME = 1e-6, 1e-10  # a host's own sums of times are off by their rounding


class Slave(Values):
    """A co-simulation slave.

    A step replaces the list `memory` and never changes it in place, so that saving a state needs
    no copy and a failed step is undone by keeping the old list.
    """

    stop = math.inf  # [s]

    def step(self, step: float) -> None:
        """Replace `memory` and the computed outputs by those at the end of the step [s]."""
        raise NotImplementedError

    # -- life cycle -------------------------------------------------------------------------------

    def setup_experiment(
        self, start_time: float, stop_time: float | None, tolerance: float | None
    ) -> None:
        """Remember start and stop time; a stop time of NaN or None is none."""
        self.time = start_time
        is_defined = stop_time is not None and not math.isnan(stop_time)
        self.stop = stop_time if is_defined and stop_time is not None else math.inf

    def exit_initialization_mode(self) -> None:
        """Check every parameter and start the equations; raises what is wrong, logged."""
        try:
            self._refresh(FRESH)
        except Exception as error:
            raise self._fatal("initialisation failed", error) from None
        self._running = True

    def do_step(self, current_time: float, step_size: float) -> bool:
        """One communication step; False (fmi2Discard) with the reason logged when it fails.

        After a failure the state is that of before the step.
        """
        before = self.memory
        try:
            if self._stale == BEGINNING:
                self._refresh(COMPUTED)
                before = self.memory
            self._running = True
            if not 0.0 < step_size < math.inf:
                raise ValueError(f"communication step size = {step_size!r} s: must be above 0 s")
            self._demand_place(current_time, step_size)
            self._demand_allowed_inputs()
            self.step(step_size)
            self._demand_finite(self.layout.computed)
        except Exception as error:
            self.memory = before
            self._stale = max(self._stale, COMPUTED)
            self._report(f"step of {step_size:.6g} s failed", error)
            return False
        except BaseException:
            keep(self, self.log_queue, type(self))
            raise
        self.time = current_time + step_size
        self._stale = OBSERVED
        return True

    # -- state ------------------------------------------------------------------------------------

    def _get_fmu_state(self) -> dict[str, Any]:
        return {
            "unit": self._signature(),
            "time": self.time,
            "running": self._running,
            "stale": self._stale,
            "real": self.real[:],
            "boolean": self.boolean[:],
            "memory": self.memory,
        }

    def _set_fmu_state(self, state: dict[str, Any]) -> None:
        try:
            if state["unit"] != self._signature():
                raise ValueError(
                    f"the state belongs to {state['unit']!r}, not to {self._signature()!r}"
                )
            group = self.layout.parameters
            other = (
                self._stale == BEGINNING
                or self.real[group] != state["real"][group]
                or self.boolean != state["boolean"]
            )
            self.time = state["time"]
            self._running = state["running"]
            self._stale = state["stale"]
            self.real = state["real"][:]
            self.boolean = state["boolean"][:]
            self.memory = state["memory"]
            if other and self._stale < BEGINNING:
                self.parameters()
        except Exception as error:
            raise self._fatal("restoring a state failed", error) from None

    @staticmethod
    def _fmu_state_to_bytes(state: dict[str, Any]) -> bytes:
        return json.dumps(state).encode("ascii")

    @staticmethod
    def _fmu_state_from_bytes(state: bytes) -> dict[str, Any]:
        # an exception here could not be made safe, for lack of the instance: `set` refuses instead
        try:
            found = json.loads(state.decode("ascii"))
        except ValueError as error:
            return {"unit": f"unreadable bytes ({error})"}
        return found if isinstance(found, dict) and "unit" in found else {"unit": "other data"}

    # -- inside -----------------------------------------------------------------------------------

    def _signature(self) -> str:
        """Whose state it is: within an FMU the module is named after the sources' content."""
        return f"{type(self).__module__} {self.layout.signature}"

    def _demand_place(self, time: float, step: float) -> None:
        """A step begins where the unit is, and ends at the stop time at the latest."""
        rounding = POINT_OF_STEP * step + POINT_OF_TIME * abs(self.time)
        if not abs(time - self.time) <= rounding:
            raise ValueError(
                f"communication point = {time!r} s: must be where the unit is, {self.time!r} s"
            )
        if time + step > self.stop + rounding:
            raise ValueError(
                f"end of the step = {time + step!r} s: must not be beyond the stop time, "
                f"{self.stop!r} s"
            )
