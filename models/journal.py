"""The short journal bearing: stiffness and damping of its oil film about the static point.

Ocvirk's bearing with a half film, as in Friswell, Penny, Garvey & Lees 2010.  Axes: x horizontal, y
up, the load along -y, turning from x to y.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .arrays import Array
from .supports import SpeedTable

CLOSE = 0.04  # of a speed: the next row of a table
MATRICES = ("stiffness", "damping")
LONGEST = 0.5  # of the diameter: a longer film leaks along the axis less than is assumed
THICKEST = 0.1  # of the journal's radius: Reynolds' equation holds for a thin film
THINNEST = 0.003  # of the clearance: what is left of it is less than a surface is rough
LIGHT = 1e8  # Sommerfeld number: from there on eccentricity is 1/(pi S) to the last digit


@dataclass(frozen=True, eq=False)
class Film:
    """An oil film about its static point.

    Attributes:
        eccentricity: of the journal over the clearance.
        attitude: angle from the load, in the sense of rotation [rad].
        stiffness, damping: ((xx, xy), (yx, yy)) [N/m, N s/m].
    """

    eccentricity: float
    attitude: float
    stiffness: Array
    damping: Array


def short_bearing(
    diameter: float, length: float, clearance: float, viscosity: float, load: float, speed: float
) -> Film:
    """A laminar, isoviscous film, at most `LONGEST` diameters long.

    Args:
        diameter, length, clearance: of the journal, of the bearing, between them at rest [m].
        viscosity: of the oil [Pa s].
        load: static, above 0 [N].
        speed: of the rotor, above 0 [rad/s].

    Raises:
        ValueError: a value is not positive, the bearing is too long, its film is not thin, or the
            load leaves less of it than `THINNEST`.
    """
    given = {
        "diameter": diameter, "length": length, "clearance": clearance, "viscosity": viscosity,
        "load": load, "speed": speed,
    }  # fmt: skip
    for name, value in given.items():
        if not 0.0 < value < math.inf:
            raise ValueError(f"{name} = {value!r}: must be above 0")
    if length > LONGEST * diameter:
        raise ValueError(
            f"length = {length:g} m: must be at most {LONGEST:g} diameters, "
            f"{LONGEST * diameter:g} m: the formula is that of a short bearing"
        )
    if clearance > THICKEST * diameter / 2.0:
        raise ValueError(
            f"clearance = {clearance:g} m: must be at most {THICKEST:g} of the journal's radius, "
            f"{THICKEST * diameter / 2.0:g} m: the film is thin"
        )
    sommerfeld = diameter * speed * viscosity * length**3 / (8.0 * load * clearance**2)
    e = _eccentricity(sommerfeld)
    if e > 1.0 - THINNEST:
        raise ValueError(
            f"load = {load:g} N: leaves less than {100.0 * THINNEST:g} % of the clearance as oil "
            f"film at {speed:.4g} rad/s, where journal and bearing touch; must be less, or the "
            "lowest speed higher"
        )
    a, b = coefficients(e)
    return Film(
        e,
        math.atan(math.pi * math.sqrt(1.0 - e * e) / (4.0 * e)),
        load / clearance * a,
        load / (clearance * speed) * b,
    )


def film_table(
    diameter: float,
    length: float,
    clearance: float,
    viscosity: float,
    load: float,
    low: float,
    high: float,
) -> SpeedTable:
    """The film over speeds from `low` to `high` [rad/s], in rows a share `CLOSE` apart at most.

    On a line between two rows values are within 1e-3 of their largest.

    Raises:
        ValueError: as of `short_bearing`, or the speeds do not ascend.
    """
    if not 0.0 < low < high < math.inf:
        raise ValueError(f"speeds = {low:g} to {high:g} rad/s: must be above 0 and ascend")
    speeds = np.geomspace(low, high, 2 + math.ceil(math.log(high / low) / CLOSE))
    films = [short_bearing(diameter, length, clearance, viscosity, load, float(w)) for w in speeds]
    stiffness, damping = (np.array([getattr(f, each) for f in films]) for each in MATRICES)
    return SpeedTable(speeds, stiffness, damping)


def coefficients(e: float) -> tuple[Array, Array]:
    """Stiffness over load by clearance, damping over load by clearance and speed, (2, 2) each.

    Args:
        e: eccentricity over the clearance, 0 < e < 1.
    """
    square, pi2 = e * e, math.pi**2
    s = math.sqrt(1.0 - square)
    h = (pi2 * (1.0 - square) + 16.0 * square) ** -1.5
    a = h * np.array(
        [
            [
                4.0 * (pi2 * (2.0 - square) + 16.0 * square),
                math.pi * (pi2 * (1.0 - square) ** 2 - 16.0 * square**2) / (e * s),
            ],
            [
                -math.pi
                * (pi2 * (1.0 - square) * (1.0 + 2.0 * square) + 32.0 * square * (1.0 + square))
                / (e * s),
                4.0
                * (
                    pi2 * (1.0 + 2.0 * square)
                    + 32.0 * square * (1.0 + square) / (1.0 - square)
                ),
            ],
        ]
    )  # fmt: skip
    cross = -8.0 * (pi2 * (1.0 + 2.0 * square) - 16.0 * square)
    b = h * np.array(
        [
            [2.0 * math.pi * s * (pi2 * (1.0 + 2.0 * square) - 16.0 * square) / e, cross],
            [cross, 2.0 * math.pi * (pi2 * (1.0 - square) ** 2 + 48.0 * square) / (e * s)],
        ]
    )
    return a, b


def critical_mass(stiffness: Array, damping: Array) -> tuple[float, float]:
    """Mass on one bearing from which on a rigid rotor whirls, and the whirl speed squared (Lund).

    Both (2, 2), of one bearing of two equal ones.  The mass is infinite, and the square not
    positive, where no mass whirls.
    """
    (k_xx, k_xy), (k_yx, k_yy) = stiffness
    (c_xx, c_xy), (c_yx, c_yy) = damping
    k = (c_xx * k_yy + c_yy * k_xx - c_xy * k_yx - c_yx * k_xy) / (c_xx + c_yy)
    square = ((k - k_xx) * (k - k_yy) - k_xy * k_yx) / (c_xx * c_yy - c_xy * c_yx)
    return (k / square if square > 0.0 else math.inf), square


def _eccentricity(sommerfeld: float) -> float:
    """Smallest root of e^8 - 4 e^6 + (6 - S^2 (16 - pi^2)) e^4 - (4 + pi^2 S^2) e^2 + 1 = 0.

    Four roots meet at 1 as S falls to 0, and cannot be told apart: 1 where none is below it.
    """
    if sommerfeld > LIGHT:
        return 1.0 / (math.pi * sommerfeld)
    s2 = sommerfeld**2
    polynomial = [1.0, -4.0, 6.0 - s2 * (16.0 - math.pi**2), -(4.0 + math.pi**2 * s2), 1.0]
    roots = np.roots(polynomial)
    real = roots[(np.abs(roots.imag) < 1e-9) & (roots.real > 0.0) & (roots.real < 1.0)].real
    return math.sqrt(float(real.min(initial=1.0)))
