"""The synchronous part of a vibration: what a balancing machine's instrument reads."""

from __future__ import annotations

import numpy as np

from ..arrays import Array, Complex


def synchronous(angle: Array, samples: Array, drifts: bool = False) -> Complex:
    """Complex A (s,) of the least-squares fit of Re(A e^{i angle}) + c to samples (s, m), 0-peak.

    Over whole revolutions other harmonics and the offset c are orthogonal to it.

    Args:
        angle: (m,) of the rotor at the samples.
        drifts: whether c grows with the angle, as where nothing holds the machine.
    """
    columns = [np.cos(angle), -np.sin(angle), np.ones_like(angle)]
    matrix = np.column_stack([*columns, angle - angle[0]] if drifts else columns)
    coefficients = np.linalg.lstsq(matrix, samples.T, rcond=None)[0]
    found: Complex = coefficients[0] + 1j * coefficients[1]
    return found
