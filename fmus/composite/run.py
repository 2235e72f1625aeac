"""One run of a composition by the library itself, in as many calls as the caller likes."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from ctypes import POINTER, Structure, byref, c_char_p, c_double, c_int, c_size_t, c_uint
from functools import cache

import numpy as np
from numpy.typing import NDArray

from .batch import present
from .composition import Composition

_D, _U = POINTER(c_double), POINTER(c_uint)


class _Steps(Structure):
    _fields_ = (
        ("share", c_double),
        ("points", _D),
        ("count", c_size_t),
        ("grain", c_double),
        ("references", _U),
        ("values", _D),
        ("changed", c_size_t),
    )


class Stretch(Structure):
    """Communication steps up to a time.

    Args:
        begin: where the run is [s].
        end: that must be met [s].
        step: given steps [s]; 0: they are chosen by the tolerance, or prescribed,
        longest: and at most that long [s].
        count: of given steps.

    Attributes:
        done: steps taken so far.
        events: memory for the number of events before each row; none by default.
    """

    _fields_ = (
        ("begin", c_double),
        ("end", c_double),
        ("step", c_double),
        ("longest", c_double),
        ("count", c_size_t),
        ("done", c_size_t),
        ("events", _D),
    )


class RunFacts(Structure):
    """What a run has done since its start; run.h says what each is."""

    _fields_ = (
        ("time", c_double),
        ("steps", c_double),
        ("passes", c_double),
        ("order", c_double),
        ("collocated", c_double),
        ("stiff", c_double),
        ("reason", c_char_p),
        ("warnings", c_char_p),
    )


_R = POINTER(RunFacts)


class RunFailed(Exception):
    """A run cannot go on; the text says why."""


@cache
def _functions() -> ctypes.CDLL:
    library, _ = present()
    for name, result, arguments in (
        ("new", _R, (c_char_p,)),
        ("free", None, (_R,)),
        ("start", c_int, (_R, POINTER(_Steps))),
        ("on", c_size_t, (_R, POINTER(Stretch), _U, c_size_t, c_size_t, _D)),
        ("read", c_int, (_R, _U, c_size_t, _D)),
    ):
        function = getattr(library, f"autobalancer_run_{name}")
        function.restype, function.argtypes = result, arguments
    return library


class Run:
    """A run that is started any number of times; a thread has its own.

    Args:
        composition: what is run, from the start values it has.

    Raises:
        NotCompiled: the library is not of the present sources, and there is no compiler.
    """

    def __init__(self, composition: Composition) -> None:
        self._library, (_, stamp) = _functions(), present()
        self._points = np.zeros(0)  # the library reads them while it runs
        self._run = self._library.autobalancer_run_new(composition.token(stamp).encode())
        if not self._run:
            raise MemoryError

    def start(
        self,
        points: Sequence[float] | NDArray[np.float64] = (),
        step_share: float = 0.0,
        grain: float = 0.0,
        changed: Mapping[int, float] | None = None,
    ) -> None:
        """From the start values, with rows at `points` if they are given.

        Args:
            points: ascending [s].
            step_share: of what a step may err; 0: all of it.
            grain: gaps and bounces of impacts that are too small to be followed, over the usual
                ones; 0: these.
            changed: start values other than those of the composition, by value reference.

        Raises:
            RunFailed: a parameter is wrong, or there is no start.
        """
        self._points = np.array(points, float)
        data = self._points.ctypes.data_as(_D) if len(points) else None
        references = np.array(list(changed or ()), np.uintc)
        values = np.array([*(changed or {}).values()], float)
        otherwise = references.ctypes.data_as(_U), values.ctypes.data_as(_D), len(values)
        steps = _Steps(step_share, data, len(self._points), grain, *otherwise)
        if self._library.autobalancer_run_start(self._run, byref(steps)):
            raise RunFailed(self.reason)

    def on(
        self,
        stretch: Stretch,
        outputs: NDArray[np.uintc],
        rows: NDArray[np.float64],
        events: NDArray[np.float64] | None = None,
    ) -> NDArray[np.float64]:
        """Go on; the interpreter's lock is released meanwhile.

        Args:
            stretch: is gone on with where the call before has left it.
            outputs: (asked,) value references.
            rows: (most, 1 + asked) memory for the time and the outputs behind every step.
            events: (most,) memory for how many events lie before each row, or None.

        Returns:
            Rows that were filled: fewer than `most` where the stretch is over, or the run cannot go
            on, and `reason` says why.
        """
        stretch.events = None if events is None else events.ctypes.data_as(_D)
        done = self._library.autobalancer_run_on(
            self._run,
            byref(stretch),
            outputs.ctypes.data_as(_U),
            len(outputs),
            len(rows),
            rows.ctypes.data_as(_D),
        )
        return rows[:done]

    def read(self, references: NDArray[np.uintc], values: NDArray[np.float64]) -> None:
        """Present values of variables, into contiguous memory.

        Raises:
            RunFailed: they are not finite, or cannot be computed.
        """
        addresses = references.ctypes.data_as(_U), len(references), values.ctypes.data_as(_D)
        if self._library.autobalancer_run_read(self._run, *addresses):
            raise RunFailed(self.reason)

    @property
    def facts(self) -> RunFacts:
        """What the run has done since its start."""
        return self._run.contents

    @property
    def reason(self) -> str:
        """Why the run cannot go on; empty where it can."""
        return self._run.contents.reason.decode()

    @property
    def warnings(self) -> list[str]:
        """What the units have warned of since the start."""
        return self._run.contents.warnings.decode().splitlines()

    def close(self) -> None:
        """Free the run."""
        if self._run:
            self._library.autobalancer_run_free(self._run)
            self._run = None
