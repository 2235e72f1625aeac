"""`autobalancer drag`: the drag of a ball, measured by its decay or bounded by its oil."""

from __future__ import annotations

import math
import re
from typing import Annotated

import typer

from ..errors import UserError
from ..output import options
from ..output.terminal import say
from ..units import si_number, to_si

_OIL = re.compile(r"\s*(?:ISO\s*)?VG\s*(\d+)\s*", re.IGNORECASE)
_CELSIUS = re.compile(r"\s*([-+]?\d+(?:\.\d*)?)\s*(?:°|deg)\s*C\s*")
_ZERO = 273.15  # K
_LIQUID = (-40.0, 200.0)  # degC: where a mineral oil is one


def command(
    ball: Annotated[
        float | None, options.quantity("m", "Diameter of the ball, m or such as 10mm.", "--ball")
    ] = None,
    density: Annotated[
        float, options.quantity("kg/m^3", "Of the ball, kg/m^3.", "--density")
    ] = 7800.0,
    decay: Annotated[
        tuple[str, str, str] | None,
        typer.Option(
            metavar="FIRST LAST TIME",
            help="Amplitudes of a ball that swings in the upright race, such as 30deg 10deg 1.2s, "
            "or speeds of a ball that runs around the level race, such as 90rpm 30rpm 2s.",
        ),
    ] = None,
    oil: Annotated[str | None, typer.Option(help='Such as "ISO VG 46".')] = None,
    temperature: Annotated[str, typer.Option(help="Of the oil, such as 60degC.")] = "40degC",
) -> None:
    """Find the drag of a ball, from a measured decay or from the oil."""
    if ball is None or not 0.0 < ball < 1.0:
        raise UserError("--ball: give the diameter of the ball, below 1 m, such as --ball 10mm")
    if (decay is None) == (oil is None):
        raise UserError("give either --decay, which is measured, or --oil, which gives a bound")
    if not 0.0 < density < math.inf:
        raise UserError(f"--density {density:g}: must be above 0")
    from ...models.papers.capacity import weight_mass
    from ...models.weights import KAPPA

    mass = weight_mass("balls", 0.5 * ball, density)
    found = _measured(mass, *decay) if decay else _bound(ball, str(oil), temperature)
    rate = found / (KAPPA["balls"] * mass)
    say(f"A ball of {1e3 * mass:.4g} g loses its speed along the track within {1.0 / rate:.3g} s.")
    say(f"In a scene: drag = {found:.3g}")


def _measured(mass: float, first: str, last: str, time: str) -> float:
    """Drag from a decay [N s/m]."""
    from ...models import drag as theory
    from ...models.weights import KAPPA

    seconds = si_number(time, "s", "--decay: time")
    kind, start, end = _both(first, last)
    if not (0.0 < end < start < math.inf and 0.0 < seconds < math.inf):
        raise UserError(f"--decay {first} {last} {time}: LAST must be below FIRST, all above 0")
    if kind == "rad" and start >= math.pi:
        raise UserError(f"--decay {first}: a ball that swings stays below 180 deg")
    formula = theory.from_swing if kind == "rad" else theory.from_slowing
    found = formula(mass, KAPPA["balls"], start, end, seconds)
    motion = "swings in the upright race" if kind == "rad" else "runs around the level race"
    say(f"Measured, by a ball that {motion}: {found:.3g} N s/m")
    return found


def _both(first: str, last: str) -> tuple[str, float, float]:
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


def _bound(ball: float, oil: str, temperature: str) -> float:
    """Lower bound of the drag from the oil [N s/m]."""
    from ...models import drag as theory

    grade, celsius = _OIL.fullmatch(oil), _CELSIUS.fullmatch(temperature)
    if grade is None:
        raise UserError(f'--oil {oil}: must be an ISO grade, such as "ISO VG 46"')
    if celsius is None or not _LIQUID[0] <= float(celsius[1]) <= _LIQUID[1]:
        low, high = _LIQUID
        raise UserError(
            f"--temperature {temperature}: must be from {low:g}degC to {high:g}degC, such as 40degC"
        )
    try:
        kinematic = theory.oil_viscosity(float(grade[1]), float(celsius[1]) + _ZERO)
    except ValueError as error:
        raise UserError(f"--oil {oil}: {error}") from None
    found = theory.stokes(theory.OIL_DENSITY * kinematic, ball)
    say(f"Viscosity: {1e6 * kinematic:.3g} mm^2/s, of a mineral oil of viscosity index 95")
    say(
        f"Lower bound: {found:.3g} N s/m (Stokes: a ball deep in the oil, slower than "
        f"{kinematic / ball:.2g} m/s; the race, the film and more speed add to it)"
    )
    return found
