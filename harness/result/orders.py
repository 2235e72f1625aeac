"""The synchronous part of a vibration, at the rotor's speed, and its spectra.

A run is looked at through windows of whole revolutions.  Signals are first put on equal steps of
the rotor's angle, so that an order stays one line however the speed changes within a window
(computed order tracking: Fyfe & Munck 1997).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from ...models.arrays import Array
from ..errors import UserError

POINTS = 64  # per revolution
SPECTRA, AMPLITUDES = 120, 1000  # of a run, about
PADDED = 4  # times as long: what lies between two lines of a spectrum is seen
LONGEST, SHORTEST = 8, 2  # revolutions of a window for spectra
SYNCHRONOUS = 4  # revolutions of a window for the synchronous part
HIGHEST = 4.0  # order of a spectrum
WINDOWS = 6  # that a run should have room for, one behind the other


@dataclass(frozen=True, eq=False)
class Spectra:
    """Spectra along a run.

    Attributes:
        angle: (k,) of the rotor, in the middle of each window [rad].
        orders: (m,) frequency over speed.
        amplitude: (k, m), 0-peak.
    """

    angle: Array
    orders: Array
    amplitude: Array


def synchronous(angle: Array, samples: Array) -> tuple[Array, NDArray[np.complex128]]:
    """Amplitudes of order 1, each over a window of four revolutions, by Hann's window.

    Orders half a turn apart and constants do not show in it.

    Args:
        angle: (T,) of the rotor, rising [rad].
        samples: (s, T).

    Returns:
        (k,) angle of the rotor in the middle of each window [rad], and (k, s) complex amplitudes,
        0-peak: signal = Re(A e^{i angle}).

    Raises:
        UserError: the run is shorter than a window.
    """
    grid, windows = _windows(angle, samples, SYNCHRONOUS, AMPLITUDES)
    weight = _hann(grid.shape[1])
    fourier = 2.0 * weight / weight.sum() * np.exp(-1j * (grid[0] - grid[0, 0]))
    return grid.mean(axis=1), np.exp(-1j * grid[:, :1]) * (windows @ fourier).T


def spectra(angle: Array, samples: Array) -> Spectra:
    """Spectra of one signal up to `HIGHEST`, by Hann's window; an order's line has its amplitude.

    Args:
        angle, samples: (T,) of the rotor, rising [rad], and of the signal.

    Raises:
        UserError: the run is shorter than a window.
    """
    revolutions = int(np.clip((angle[-1] - angle[0]) / math.tau / WINDOWS, SHORTEST, LONGEST))
    grid, windows = _windows(angle, samples[None], revolutions, SPECTRA)
    length = grid.shape[1]
    weight = _hann(length)
    flat = windows[0] - windows[0].mean(axis=1, keepdims=True)
    lines = np.abs(np.fft.rfft(flat * weight, PADDED * length, axis=1)) * 2.0 / weight.sum()
    orders = np.arange(lines.shape[1]) / (PADDED * revolutions)
    shown = orders <= HIGHEST
    return Spectra(grid.mean(axis=1), orders[shown], lines[:, shown])


def refuse_few(turned: float, revolutions: int) -> None:
    """Refuse a run that turns less [rad] than a window of so many revolutions.

    Raises:
        UserError: so it does.
    """
    if _steps(turned) + 1 < POINTS * revolutions:
        raise UserError(
            f"{turned / math.tau:.3g} revolutions are too few: {revolutions} or more are needed: "
            "raise run.revolutions"
        )


def _steps(turned: float) -> int:
    return int(turned / (math.tau / POINTS) * (1.0 + 1e-12))


def _hann(length: int) -> Array:
    """Hann's window for spectra: periodic."""
    return np.hanning(length + 1)[:-1]


def _windows(angle: Array, samples: Array, revolutions: int, most: int) -> tuple[Array, Array]:
    """Angles (k, p) of about `most` overlapping windows, and the signals there (s, k, p)."""
    if not (np.diff(angle) > 0.0).all():
        raise UserError("the rotor does not turn forwards all the time: there are no orders")
    refuse_few(angle[-1] - angle[0], revolutions)
    step, length = math.tau / POINTS, POINTS * revolutions
    count = _steps(angle[-1] - angle[0]) + 1
    even = angle[0] + step * np.arange(count)
    values = CubicSpline(angle, samples, axis=1)(np.minimum(even, angle[-1]))
    hop = max(1, (count - length) // most)
    grid = sliding_window_view(even, length)[::hop]
    return grid, sliding_window_view(values, length, axis=1)[:, ::hop]
