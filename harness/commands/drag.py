"""`autobalancer drag`: the drag of a ball, measured by its decay or bounded by its oil."""

from __future__ import annotations

from typing import Annotated

import typer

from ...models.readable import rounded
from ..errors import UserError
from ..output import options
from ..output.terminal import say


def command(
    ball: Annotated[
        float | None, options.quantity("m", "Diameter of the ball, m or such as 10mm.", "--ball")
    ] = None,
    density: Annotated[
        float, options.quantity("kg/m^3", "Density of the ball, kg/m^3.", "--density")
    ] = 7800.0,
    decay: Annotated[
        tuple[str, str, str] | None,
        typer.Option(
            metavar="FIRST LAST TIME",
            help="Amplitudes of a ball that swings in the upright race, such as 30deg 10deg 1.2s, "
            "or speeds of a ball that runs around the level race, such as 90rpm 30rpm 2s.",
        ),
    ] = None,
    swings: Annotated[
        float | None,
        options.number(
            "Swings of --decay from FIRST to LAST, there and back; halves count.", "--swings"
        ),
    ] = None,
    oil: Annotated[str | None, typer.Option(help='Oil, such as "ISO VG 46".')] = None,
    temperature: Annotated[
        str, typer.Option(help="Temperature of the oil, such as 60degC.")
    ] = "40degC",
) -> None:
    """Find the drag of a ball, from a measured decay or from the oil."""
    if ball is None:
        raise UserError("--ball: give the diameter of the ball, such as --ball 10mm")
    from ..drag.estimate import find_drag

    found = find_drag(
        ball,
        decay=decay,
        oil=oil,
        temperature=temperature,
        density=density,
        swings=swings,
    )
    say(found.source)
    mass, seconds = 1e3 * found.mass, found.decay_time
    say(f"A ball of {mass:.4g} g loses its speed along the track within {rounded(seconds, 3)} s.")
    say(f"In a scene: drag = {found.value:.3g}")
