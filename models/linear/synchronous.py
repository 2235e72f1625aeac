"""The synchronous part of a vibration: what a balancing machine's instrument reads."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Complex


@dataclass(frozen=True, eq=False)
class Synchronous:
    """Part of s vibrations that turns with the rotor.

    Attributes:
        amplitude: (s,) complex A, 0-peak: displacement = Re(A e^{i angle}) [m].
        uncertainty: (s,) standard uncertainty of its real and of its imaginary part [m].
    """

    amplitude: Complex
    uncertainty: Array


def synchronous(angle: Array, samples: Array) -> Synchronous:
    """Least-squares fit of Re(A e^{i angle}) + c to samples (s, m) taken at rotor angles (m,).

    Over whole revolutions other harmonics and the offset c are orthogonal to it.  The uncertainty
    comes from what the fit leaves, shared over the samples by their covariance.
    """
    matrix = np.column_stack([np.cos(angle), -np.sin(angle), np.ones_like(angle)])
    coefficients = np.linalg.lstsq(matrix, samples.T, rcond=None)[0]
    residual = samples.T - matrix @ coefficients
    variance = (residual**2).sum(axis=0) / max(1, len(angle) - matrix.shape[1])
    covariance = np.linalg.inv(matrix.T @ matrix).diagonal()[:2].max()
    return Synchronous(coefficients[0] + 1j * coefficients[1], np.sqrt(variance * covariance))
