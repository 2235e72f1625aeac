"""Drag of a ball on its track, measured by a decay or bounded by the oil."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from ...models import drag as theory
from ...models.papers.capacity import weight_mass
from ...models.weights import KAPPA
from ..errors import UserError
from ..units import si_number, to_si

STEEL = 7800.0  # kg/m^3
_OIL = re.compile(r"\s*(?:ISO\s*)?VG\s*(\d+)\s*", re.IGNORECASE)
_CELSIUS = re.compile(r"\s*([-+]?\d+(?:\.\d*)?)\s*(?:°|deg)\s*C\s*")
_ZERO_CELSIUS = 273.15  # K
_CLOSE = 0.01  # of a drag: how far the number of swings may change it without being asked for
_MOST_SWINGS = 1000
_HALF = 1e-6  # of a swing: how near to a half one it is
_OIL_RANGE = (-40.0, 200.0)  # degC: where a mineral oil is liquid


@dataclass(frozen=True)
class Drag:
    """Drag of one ball.

    Attributes:
        value: [N s/m], what a scene calls `drag`; from the oil a lower bound.
        mass: of the ball [kg].
        source: how it was found, in words.
        spread: of the drag, half its range over itself: what is not known without the number of
            swings; 0 where it changes nothing that matters.
    """

    value: float
    mass: float
    source: str
    spread: float = 0.0

    @property
    def decay_time(self) -> float:
        """Time in which the ball loses all but 1/e of its speed along the track [s]."""
        return KAPPA["balls"] * self.mass / self.value


def find_drag(
    ball: float | str,
    *,
    decay: tuple[str, str, str] | None = None,
    oil: str | None = None,
    temperature: str = "40degC",
    density: float | str = STEEL,
    swings: float | None = None,
) -> Drag:
    """Drag of a ball: from a measured decay, or a lower bound from the oil.

    Args:
        ball: diameter [m].
        decay: first and last amplitude of a ball that swings in the upright race, or speed of a
            ball that runs around the level race, and the time between them.
        oil: grade, such as "ISO VG 46".
        temperature: of the oil.
        density: of the ball [kg/m^3].
        swings: from the first amplitude to the last, there and back each, where `decay` are
            amplitudes; a half ends on the other side. Without it a decay from a large angle gives a
            range, whose middle is `value`.

    Raises:
        UserError: a value is wrong, or not one of `decay` and `oil` is given.

    >>> round(ab.find_drag("10 mm", decay=("30deg", "10deg", "1.2s")).value, 5)
    0.01041
    """
    diameter, density = si_number(ball, "m", "--ball"), si_number(density, "kg/m^3", "--density")
    if not 0.0 < diameter < 1.0:
        raise UserError("--ball: give the diameter of the ball, below 1 m, such as --ball 10mm")
    if (decay is None) == (oil is None):
        raise UserError("give either --decay, which is measured, or --oil, which gives a bound")
    if not 0.0 < density < math.inf:
        raise UserError(f"--density {density:g}: must be above 0")
    mass = weight_mass("balls", 0.5 * diameter, density)
    swings = None if swings is None else si_number(swings, "", "--swings")
    if swings is not None and (decay is None or not 0.0 < swings <= _MOST_SWINGS):
        raise UserError(
            f"--swings {swings:g}: must be the number of swings of --decay, such as 2 or 2.5, at "
            f"most {_MOST_SWINGS}"
        )
    if decay:
        return _measured(mass, *decay, swings)
    value, source = _bound(diameter, str(oil), temperature)
    return Drag(value, mass, source)


def _measured(mass: float, first: str, last: str, time: str, swings: float | None) -> Drag:
    """Drag from a decay."""
    seconds = si_number(time, "s", "--decay: time")
    unit, start, end = _in_one_unit(first, last)
    if not (0.0 < end < start < math.inf and 0.0 < seconds < math.inf):
        raise UserError(f"--decay {first} {last} {time}: LAST must be below FIRST, all above 0")
    kappa = KAPPA["balls"]
    if unit != "rad":
        if swings is not None:
            raise UserError("--swings: belongs to a ball that swings; --decay gives two speeds")
        found = theory.from_slowing(mass, kappa, start, end, seconds)
        return Drag(found, mass, _said("runs around the level race", found))
    if start >= math.pi:
        raise UserError(f"--decay {first}: a ball that swings stays below 180 deg")
    if swings is not None and abs(2.0 * swings - round(2.0 * swings)) > _HALF:
        raise UserError(f"--swings {swings:g}: must be whole or half, such as 2 or 2.5")
    found = float(theory.from_swing(mass, kappa, start, end, seconds, swings))
    motion = "swings in the upright race"
    if swings is not None or (ratio := theory.swing_range(start, end)) < 1.0 + _CLOSE:
        return Drag(found, mass, _said(motion, found))
    middle, most = found * 0.5 * (1.0 + ratio), found * ratio
    return Drag(
        middle,
        mass,
        f"{_said(motion, middle)}, but only from {found:.3g} (many swings) to {most:.3g} (half a "
        "swing, to the other side) is known: from such an angle the drag depends on how many "
        "swings there were; count them and give --swings, such as --swings 2 (2.5 if it ends on "
        "the other side)",
        (ratio - 1.0) / (ratio + 1.0),
    )


def _said(motion: str, found: float) -> str:
    return f"Measured, by a ball that {motion}: {found:.3g} N s/m"


def _in_one_unit(first: str, last: str) -> tuple[str, float, float]:
    """Unit of a decay, and its two values in it."""
    for unit in ("rad", "rad/s"):
        try:
            return unit, to_si(first, unit), to_si(last, unit)
        except ValueError:
            pass
    raise UserError(
        f"--decay {first} {last}: give two angles of a ball that swings, such as 30deg 10deg, or "
        "two speeds of a ball that runs around, such as 90rpm 30rpm"
    )


def _bound(diameter: float, oil: str, temperature: str) -> tuple[float, str]:
    """Lower bound of the drag from the oil [N s/m]."""
    grade, celsius = _OIL.fullmatch(oil), _CELSIUS.fullmatch(str(temperature))
    if grade is None:
        raise UserError(f'--oil {oil}: must be an ISO grade, such as "ISO VG 46"')
    low, high = _OIL_RANGE
    if celsius is None or not low <= float(celsius[1]) <= high:
        raise UserError(
            f"--temperature {temperature}: must be from {low:g}degC to {high:g}degC, such as 40degC"
        )
    try:
        kinematic = theory.oil_viscosity(float(grade[1]), float(celsius[1]) + _ZERO_CELSIUS)
    except ValueError as error:
        raise UserError(f"--oil {oil}: {error}") from None
    found = theory.stokes(theory.OIL_DENSITY * kinematic, diameter)
    return found, (
        f"Viscosity: {1e6 * kinematic:.3g} mm^2/s, of a mineral oil of viscosity index 95\n"
        f"Lower bound: {found:.3g} N s/m (Stokes: a ball deep in the oil, slower than "
        f"{kinematic / diameter:.2g} m/s; the race, the film and more speed add to it)"
    )
