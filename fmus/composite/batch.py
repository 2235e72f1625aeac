"""Many runs of a composition by the library itself, without an FMU: memory in, memory out."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from ctypes import POINTER, Structure, byref, c_char, c_char_p, c_double, c_int, c_size_t, c_uint
from functools import cache

import numpy as np
from numpy.typing import NDArray

from ..native.build.compile import libraries, stamp
from ..native.build.targets import present_platform
from .composition import Composition

_REASON = 512  # BATCH_REASON of coupling/batch.h
_D, _U = POINTER(c_double), POINTER(c_uint)


class _Batch(Structure):
    _fields_ = (
        ("changed", c_size_t),
        ("references", _U),
        ("asked", c_size_t),
        ("outputs", _U),
        ("asked_last", c_size_t),
        ("last_outputs", _U),
        ("points", c_size_t),
        ("own_steps", c_int),
        ("side_by_side", c_int),
    )


@cache
def present() -> tuple[ctypes.CDLL, str]:
    """The library and the stamp of its sources: a process loads it once.

    Raises:
        NotCompiled: it is not of the present sources, and there is no compiler.
    """
    here = present_platform()
    library = ctypes.CDLL(str(libraries([here])[here]))
    function = library.autobalancer_runs
    function.argtypes = (c_char_p, POINTER(_Batch), c_size_t, _D, _D, _D, _D, POINTER(c_char))
    function.restype = c_size_t
    return library, stamp()


class BatchRuns:
    """Runs of a composition that differ in some variables; any number of threads may call it.

    Args:
        composition: what is run.
        changed: parameters and inputs that every run has values of its own for.
        asked: outputs that are read.
        points: times at which they are read, besides the start, spread evenly over a run.
        own_steps: read them where the composite's own steps end instead, at most so often; time
            comes before the outputs then, and NaN follows after the last step.
        last: outputs that are read at the end alone.
        side_by_side: most machines that go on so; 0: as many as the processor's vectors take.

    Raises:
        KeyError: there is no such variable.
        NotCompiled: the library is not of the present sources, and there is no compiler.
    """

    def __init__(
        self,
        composition: Composition,
        changed: Sequence[str],
        asked: Sequence[str],
        points: int,
        own_steps: bool = False,
        last: Sequence[str] = (),
        side_by_side: int = 0,
    ) -> None:
        self._library, current = present()
        self._token = composition.token(current).encode()
        index = composition.layout.index
        self._names = [
            np.array([index[name] for name in names], np.uintc) for names in (changed, asked, last)
        ]
        named = [part for names in self._names for part in (len(names), names.ctypes.data_as(_U))]
        self._batch = _Batch(*named, points, own_steps, side_by_side)

    def __call__(
        self, values: NDArray[np.float64], ends: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], list[str]]:
        """Run all; the interpreter's lock is released meanwhile.

        Args:
            values: (runs, changed).
            ends: (runs,) of each run [s].

        Returns:
            Outputs (runs, points + 1, asked), NaN from where a run has failed, and why it has; an
            empty text for one that has not.
        """
        records, _, reasons = self.with_last(values, ends)
        return records, reasons

    def with_last(
        self, values: NDArray[np.float64], ends: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], list[str]]:
        """As a call; between outputs and reasons those that are read at the end (runs, last)."""
        values, ends = (np.ascontiguousarray(a, float) for a in (values, ends))
        width = self._batch.asked + self._batch.own_steps
        points = self._batch.points + 1
        try:
            records = np.empty((len(ends), points, width))
        except (MemoryError, ValueError):
            raise MemoryError(
                f"{len(ends)} runs with {points} points of {width} outputs do not fit: make the "
                "runs shorter, or record fewer outputs"
            ) from None
        last = np.empty((len(ends), self._batch.asked_last))
        reasons = ctypes.create_string_buffer(max(1, len(ends)) * _REASON)
        self._library.autobalancer_runs(
            self._token,
            byref(self._batch),
            len(ends),
            *(a.ctypes.data_as(_D) for a in (values, ends, records, last)),
            reasons,
        )
        raw = reasons.raw
        texts = (raw[k * _REASON : (k + 1) * _REASON] for k in range(len(ends)))
        return records, last, [text.split(b"\0", 1)[0].decode() for text in texts]
