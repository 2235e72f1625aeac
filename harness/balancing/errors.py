"""How far errors of readings without phases move the corrections: of first order."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...models.arrays import Array, Complex
from ...models.papers.siebert import FromAmplitudes

READING_ERROR = 0.02  # of an amplitude, which a reading can be off
LARGE = 0.25  # of a correction, moved by such readings


def moved_by_errors(
    circles: FromAmplitudes, mounted: Complex, corrections: Complex, error: float
) -> Array:
    """Root mean square (p,) of what readings that err independently move the corrections by.

    A correction w makes the sum of squares of a + K w least; errors of the readings |a + K U| move
    a and K of their sensor, by the inverse of the Jacobian, and these move w.

    Args:
        mounted: (r, p) in every run, the first of them the initial one.
        corrections: w (p,) by least squares.
        error: of a reading, relative to it.
    """
    changes = np.asarray(mounted, complex) - mounted[0]
    sensors: Sequence[tuple[float, Complex]] = list(
        zip(circles.responses.tolist(), circles.coefficients, strict=True)
    )
    shares = np.abs(np.linalg.pinv(circles.coefficients)) ** 2  # (p, s)
    squares = [
        (np.abs(_left_of_sensor(a, k, changes, corrections, error)) ** 2).sum() for a, k in sensors
    ]
    return np.asarray(np.sqrt(shares @ np.array(squares)))


def _left_of_sensor(
    initial: float, k: Complex, changes: Complex, corrections: Complex, error: float
) -> Complex:
    """By every reading's error (r,), what a + K w becomes where it was 0."""
    readings = initial + changes @ k
    towards = readings.conj() / np.maximum(np.abs(readings), 1e-300)
    turned = towards[:, None] * changes
    jacobian = np.column_stack([towards.real, turned.real, -turned.imag])
    moves = np.linalg.pinv(jacobian) * (error * np.abs(readings))  # of a, Re K, Im K by reading
    planes = len(k)
    of_k = moves[1 : 1 + planes] + 1j * moves[1 + planes :]
    return np.asarray(moves[0] + corrections @ of_k)
