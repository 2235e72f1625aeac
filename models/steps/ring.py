"""Step and force of a ring part filled with liquid in axes that turn with the rotor.

With a the acceleration of the ring's centre in them (`models.ring` has fixed axes)

    (1 + f) Y'' + (d - 2 i (1 - f) w) Y' + ((1 - f) w^2 + i (1 + f) w') Y = -a.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..ring import Ring

_ORDER = 20
_TURN = 0.75  # rad of the rotor in one series
_MOST = 100_000  # series in a step


def advance(
    ring: Ring,
    wave: complex,
    rate: complex,
    signal: Sequence[complex],
    speed: float,
    spin_up: float,
    step: float,
) -> tuple[complex, complex]:
    """Y and Y' at the end of a step, by power series.

    Args:
        signal: (4,) acceleration of the centre at the start of the step, and its derivatives.
        speed, spin_up: w at the start and w', which is constant.

    Raises:
        ArithmeticError: the step is too long.
    """

    def rate_from(here: float) -> float:
        fastest = max(abs(here), abs(speed + spin_up * step))
        return max(fastest, 0.5 * ring.damping(fastest), 1e-300)

    if not rate_from(speed) * step < _TURN * _MOST:
        raise ArithmeticError(
            f"a step of {step:g} s is too long: speed or damping of the liquid times it must be "
            "below 75000; use shorter communication steps"
        )
    done = 0.0
    while done < step:
        here = speed + spin_up * done
        part = min(step - done, _TURN / rate_from(here))
        if ring.viscosity and spin_up and here:
            part = min(part, 0.25 * abs(here) / abs(spin_up))
        part = max(part, step / _MOST)
        if done + part >= step:
            part = step - done
        now = [_derivative(signal, k, done) for k in range(4)]
        wave, rate = _series(ring, wave, rate, now, here, spin_up, part)
        done = step if part == step - done else done + part
    return wave, rate


def _derivative(signal: Sequence[complex], order: int, time: float) -> complex:
    total, power = 0j, 1.0
    for k in range(order, 4):
        total += power * signal[k]
        power *= time / (k - order + 1)
    return total


def _series(
    ring: Ring,
    wave: complex,
    rate: complex,
    signal: Sequence[complex],
    speed: float,
    spin_up: float,
    length: float,
) -> tuple[complex, complex]:
    f, y = ring.hollow, [wave, rate]
    damping = _damping(ring, speed, spin_up)
    squares = [speed * speed, 2.0 * speed * spin_up, spin_up * spin_up]
    factorial = 1.0
    for k in range(_ORDER - 1):
        factorial *= k or 1
        right = signal[k] / factorial if k < 4 else 0j
        right += sum(d * (k - j + 1) * y[k - j + 1] for j, d in enumerate(damping[: k + 1]))
        for j, w in enumerate((speed, spin_up)[: k + 1]):
            right -= 2j * (1.0 - f) * w * (k - j + 1) * y[k - j + 1]
        for j, square in enumerate(squares[: k + 1]):
            right += (1.0 - f) * square * y[k - j]
        right += 1j * (1.0 + f) * spin_up * y[k]
        y.append(-right / ((1.0 + f) * (k + 1) * (k + 2)))
    end = sum((c * length**k for k, c in enumerate(y)), 0j)
    slope = sum((k * c * length ** (k - 1) for k, c in enumerate(y) if k), 0j)
    return end, slope


def _damping(ring: Ring, speed: float, spin_up: float) -> list[float]:
    """Series of d; a rotor that begins to turn has no film at its wall yet."""
    root = [abs(speed) ** 0.5]
    rise = math.copysign(spin_up, speed * spin_up)  # of |speed|
    for k in range(1, _ORDER if spin_up and speed else 1):
        left = (rise if k == 1 else 0.0) - sum(root[j] * root[k - j] for j in range(1, k))
        root.append(0.5 * left / root[0])
    series = [ring.root_damping * r for r in root]
    series[0] += ring.wave_damping
    return series


def reaction(
    ring: Ring,
    wave: complex,
    rate: complex,
    motion: Sequence[complex],
    speed: float,
    spin_up: float,
) -> tuple[complex, complex]:
    """Force beside that of the added mass, and its slope, in the rotor's axes [N, N/s].

    Args:
        motion: acceleration of the ring's centre, and its slope.
    """
    f, d, w = ring.hollow, ring.damping(speed), speed
    slope = 0.5 * (d - ring.wave_damping) * spin_up / w if w else 0.0
    # a wave at rest stands still at any speed: the square of a speed alone may be infinite
    swept, swept_rate = w * (w * wave), w * (w * rate)
    second = motion[0] + (d - 2j * (1.0 - f) * w) * rate
    second += (1.0 - f) * swept + 1j * (1.0 + f) * spin_up * wave
    second /= -(1.0 + f)
    value = (4j * w - d) * rate - 2.0 * swept
    change = (4j * w - d) * second + (4j * spin_up - slope) * rate - 2.0 * swept_rate
    change -= 4.0 * w * spin_up * wave
    factor = -ring.added_mass * f
    return factor * value, factor * change
