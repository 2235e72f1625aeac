"""Angles between groups of weights at which their torques balance, and the lag there."""

from __future__ import annotations

import numpy as np

from ..arrays import Array, Complex

_NEWTON_STEPS = 12
_BALANCED = 1e-9  # of the torque: what Newton's method leaves
_LARGEST_TURN = 0.5  # rad by which it turns a group at once


def balance_two(at: Complex, moments: Array, pull: Array) -> tuple[Array, Array]:
    """Lag over w^4 of two groups, and the second's angle from the first, in closed form.

    Torques over pulls are equal where a + p cos d + q sin d = 0, d the angle between the groups.
    Of two such angles that with the larger lag.

    Args:
        at: g (2, 2, r, j).
        moments, pull: (2, r, 1) of the groups.
    """
    turning = at * (moments[:, None] * moments)
    first, second, there, back = (
        turning[0, 0].imag,
        turning[1, 1].imag,
        turning[0, 1],
        turning[1, 0],
    )
    v, u = pull
    p, q = v * back.imag - u * there.imag, -v * back.real - u * there.real
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = 1.0 / np.sqrt(p * p + q * q)
        p, q = p * scale, q * scale
        a = (u * first - v * second) * scale
        apart = np.sqrt((1.0 - a) * (1.0 + a))
        # torque of the first: Re(i there e^{i d}) = -there.imag cos d - there.real sin d
        apart = np.copysign(apart, there.imag * q - there.real * p)
        cosine, sine = p * a - q * apart, q * a + p * apart
        lag = (first + there.imag * cosine + there.real * sine) / -v
        if not pull.all():
            one = u * v == 0.0
            lag = np.where(one, -np.where(u > 0.0, second / u, first / v), lag)
            sine = np.where(one, np.nan, sine)
    return lag, np.arctan2(sine, cosine)


def balance(torque: Complex, pull: Array, phases: Array) -> tuple[Array, Array]:
    """Newton's method for the lag and the angles between groups; the first present one stays."""
    rows, count = phases.shape
    present = pull > 0.0
    first = present.argmax(axis=1)
    every = np.arange(rows)
    angles = phases.copy()
    turned = torque * np.exp(1j * (angles[:, None, :] - angles[:, :, None]))
    lag = turned.real.sum(axis=(1, 2)) / pull.sum(axis=1)
    size = np.abs(torque).sum(axis=(1, 2)) / count
    for _ in range(_NEWTON_STEPS):
        turned = torque * np.exp(1j * (angles[:, None, :] - angles[:, :, None]))
        left = np.where(present, turned.real.sum(axis=2) - pull * lag[:, None], 0.0)
        if not (np.abs(left).max(axis=1) > _BALANCED * size).any():
            break
        slope = -turned.imag
        slope[:, range(count), range(count)] += turned.imag.sum(axis=2)
        slope = np.where(present[:, :, None] & present[:, None, :], slope, np.eye(count))
        slope[every, :, first] = -pull
        try:
            step = np.linalg.solve(slope, left[..., None])[..., 0]
        except np.linalg.LinAlgError:
            break
        lag = lag - step[every, first]
        step[every, first] = 0.0
        largest = np.abs(step).max(axis=1, keepdims=True)
        angles = angles - step * np.minimum(1.0, _LARGEST_TURN / np.maximum(largest, 1e-300))
    settled = np.abs(left).max(axis=1) <= 1e2 * _BALANCED * size
    return np.where(settled, lag, np.nan), angles
