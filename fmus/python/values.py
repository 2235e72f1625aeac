"""Values of a Python unit's variables, brought up to date when they are read."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

from ..unit import Sizes, Unit
from ._pythonfmu import Fmi2Slave, Fmi2Status
from .host import keep
from .resources import kept_in

FRESH, OBSERVED, COMPUTED, BEGINNING = range(4)  # how stale the outputs are
_FIXED = "fixed once initialisation has ended"


class Values(Fmi2Slave):
    """A unit whose Reals are one list, indexed by value reference.

    Args:
        instance_name: shown in messages.
        options: build options; default: those in the FMU's resources, or the unit's defaults where
            there are no resources.

    Attributes:
        sizes, layout: what the options say.
        real, boolean: values of all variables.
        memory: state of the equations.
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
        self.time = 0.0
        self._running = False
        self._stale = BEGINNING
        self._warned: set[str] = set()

    # -- reading and writing ----------------------------------------------------------------------

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

    # -- inside -----------------------------------------------------------------------------------

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
            self.log(f"{self.instance_name} at t = {time:.6g} s: {text}", Fmi2Status.warning)

    def _report(self, what: str, error: Exception) -> str:
        reason = str(error) or type(error).__name__
        text = f"{self.instance_name} at t = {self.time:.6g} s: {what}: {reason}"
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
