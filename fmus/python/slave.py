"""Base class of the Python units: FMI 2.0 co-simulation over pythonfmu, without its traps.

A unit adds its equations in four methods, in this order: `parameters`, `begin`, `step`, `outputs`
(and `observe` for what is computed only when read).  Everything else is here.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

from ..unit import Sizes, Unit
from ._pythonfmu import Fmi2Slave, Fmi2Status
from .host import keep
from .resources import kept_in

POINT_OF_STEP, POINT_OF_TIME = 1e-6, 1e-10  # a host's own sums of times are off by their rounding
FRESH, OBSERVED, COMPUTED, BEGINNING = range(4)  # how stale the outputs are
_FIXED = "fixed once initialisation has ended"


class Slave(Fmi2Slave):
    """A co-simulation slave whose Reals are one list, indexed by value reference.

    Args:
        instance_name: shown in messages.
        options: build options; default: those in the FMU's resources, or the unit's defaults where
            there are no resources.

    Attributes:
        sizes, layout: what the options say.
        real, boolean: values of all variables.
        memory: state of the equations.  A step replaces the list and never changes it in place, so
            that saving a state needs no copy and a failed step is undone by keeping the old list.
        time: communication point reached [s].

    Raises:
        ValueError, TypeError: the options are not those of the unit.
    """

    unit: ClassVar[Unit]
    sizes: Sizes

    # -- what a unit supplies ---------------------------------------------------------------------

    def parameters(self) -> None:
        """Make the physical model from the parameters; may raise ValueError."""

    def begin(self) -> None:
        """Set `memory` to the initial state."""

    def step(self, step: float) -> None:
        """Replace `memory` and the computed outputs by those at the end of the step [s]."""
        raise NotImplementedError

    def outputs(self) -> None:
        """Compute the outputs from `memory` and the inputs as they are now."""
        raise NotImplementedError

    def observe(self) -> None:
        """Compute the outputs declared as observed."""

    def parameter_values(self) -> dict[str, float]:
        """Values of the Real parameters by name."""
        group = self.layout.parameters
        names = (v.name for v in self.layout.reals[group])
        return dict(zip(names, self.real[group], strict=True))

    def flag(self, name: str) -> bool:
        """A Boolean by name."""
        return self.boolean[self.layout.boolean_index[name]]

    # -- life cycle -------------------------------------------------------------------------------

    def __init__(self, *, options: Mapping[str, Any] | None = None, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        start: Mapping[str, float | bool] = {}
        if options is None:
            options, start = kept_in(self.resources) if self.resources else ({}, {})
        sized = self.unit.sized(options).in_python
        self.sizes = sized.sizes
        self.layout = sized.layout
        first, end = self.layout.inputs.start, self.layout.inputs.stop
        self._native_inputs = [vr for vr in range(first, end) if self.layout.reals[vr].native]
        self.real: list[float] = self.layout.starts[:]
        self.boolean: list[bool] = self.layout.boolean_starts[:]
        for name, value in start.items():
            if name in self.layout.index:
                self.real[self.layout.index[name]] = float(value)
            else:
                self.boolean[self.layout.boolean_index[name]] = bool(value)
        self.memory: list[float] = []
        self.time, self.stop = 0.0, math.inf
        self._running = False
        self._stale = BEGINNING
        self._warned: set[str] = set()

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
            self._report(f"step of {step_size!r} s failed", error)
            return False
        except BaseException:
            keep(self, self.log_queue, type(self))
            raise
        self.time = current_time + step_size
        self._stale = OBSERVED
        return True

    # -- values -----------------------------------------------------------------------------------

    def get_real(self, vrs: Sequence[int]) -> list[float]:
        """Values of the Reals, brought up to date first."""
        try:
            _refuse_unknown(vrs, len(self.real))
            self._refresh(self._level(max(vrs, default=0)))
            return [self.real[vr] for vr in vrs]
        except Exception as error:
            raise self._fatal("reading failed", error) from None

    def set_real(self, vrs: Sequence[int], values: Sequence[float]) -> None:
        """Set parameters and inputs; while running, inputs only."""
        try:
            _refuse_unknown(vrs, len(self.real))
            inputs = self.layout.inputs
            if outputs := [vr for vr in vrs if vr >= inputs.stop]:
                raise ValueError(f"{self._names(outputs)}: outputs cannot be set")
            if parameters := [vr for vr in vrs if vr < inputs.start]:
                if self._running:
                    raise ValueError(f"{self._names(parameters)}: {_FIXED}")
                self._stale = BEGINNING
            self._stale = max(self._stale, COMPUTED)
            for vr, value in zip(vrs, values, strict=True):
                self.real[vr] = value
        except Exception as error:
            raise self._fatal("setting failed", error) from None

    def get_boolean(self, vrs: Sequence[int]) -> list[bool]:
        """Values of the Booleans."""
        try:
            _refuse_unknown(vrs, len(self.boolean))
            return [self.boolean[vr] for vr in vrs]
        except Exception as error:
            raise self._fatal("reading failed", error) from None

    def set_boolean(self, vrs: Sequence[int], values: Sequence[bool]) -> None:
        """Set Booleans, all of which are parameters."""
        try:
            _refuse_unknown(vrs, len(self.boolean))
            if self._running:
                names = [self.layout.booleans[vr].name for vr in vrs]
                raise ValueError(f"{', '.join(names)}: {_FIXED}")
            for vr, value in zip(vrs, values, strict=True):
                self.boolean[vr] = bool(value)
            self._stale = BEGINNING
        except Exception as error:
            raise self._fatal("setting failed", error) from None

    def _wrong_type(self, vrs: Sequence[int], *values: Any) -> Any:
        error = ValueError(f"value references {list(vrs)}: the unit has Reals and Booleans only")
        raise self._fatal("access failed", error)

    get_integer = set_integer = get_string = set_string = _wrong_type

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

    def _names(self, vrs: Sequence[int]) -> str:
        return ", ".join(self.layout.reals[vr].name for vr in vrs)

    def _level(self, last: int) -> int:
        """How stale the outputs may be where Reals up to this value reference are read."""
        if last < self.layout.inputs.stop:
            return BEGINNING
        return OBSERVED if last < self.layout.computed.stop else FRESH

    def _refresh(self, level: int) -> None:
        """Bring the outputs up to date so far that `_stale` is at most `level`."""
        if self._stale <= level:
            return
        if self._stale == BEGINNING:
            self._check_values()
            self.parameters()
            self.begin()
            self._stale = COMPUTED
        if self._stale == COMPUTED and level < COMPUTED:
            self._demand_allowed_inputs()
            self.outputs()
            self._demand_finite(self.layout.computed)
            self._stale = OBSERVED
        if self._stale == OBSERVED and level < OBSERVED:
            self.observe()
            self._stale = FRESH

    def _check_values(self) -> None:
        end = self.layout.inputs.stop
        reals = list(zip(self.layout.reals[:end], self.real[:end], strict=True))
        flags = zip(self.layout.booleans, self.boolean, strict=True)
        problems = [text for variable, value in reals if (text := variable.problem(value))]
        problems += [text for v, value in (*reals, *flags) if (text := v.python_problem(value))]
        if problems:
            raise ValueError("; ".join(problems))

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

    def _demand_allowed_inputs(self) -> None:
        """Inputs are finite, and a Python unit computes them."""
        self._demand_finite(self.layout.inputs)
        for vr in self._native_inputs:
            if text := self.layout.reals[vr].python_problem(self.real[vr]):
                raise ValueError(text)

    def _demand_finite(self, group: slice) -> None:
        total = sum(self.real[group])
        if total - total == 0.0:  # neither infinite nor NaN
            return
        values = zip(self.layout.reals[group], self.real[group], strict=True)
        for variable, value in values:
            if not math.isfinite(value):
                raise ArithmeticError(f"{variable.shown(value)}: must be a finite number")

    def warn_once(self, key: str, text: str, time: float) -> None:
        """Log a warning the first time it applies in this instance."""
        if key not in self._warned:
            self._warned.add(key)
            self.log(f"{self.instance_name} at t = {time!r} s: {text}", Fmi2Status.warning)

    def _report(self, what: str, error: Exception) -> str:
        reason = str(error) or type(error).__name__
        text = f"{self.instance_name} at t = {self.time!r} s: {what}: {reason}"
        self.log(text, Fmi2Status.error)
        return text

    def _fatal(self, what: str, error: Exception) -> Exception:
        """The exception to raise through pythonfmu: logged first, and made safe for the host."""
        keep(self, self.log_queue, type(self))
        return RuntimeError(self._report(what, error))


def _refuse_unknown(vrs: Sequence[int], count: int) -> None:
    """Raise ValueError for value references that do not exist."""
    unknown = [vr for vr in vrs if not 0 <= vr < count]
    if unknown:
        raise ValueError(f"value references {unknown}: unknown, there are 0 to {count - 1}")
