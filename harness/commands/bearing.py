"""`autobalancer bearing`: a short journal bearing as a table over the speed."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from ..errors import UserError
from ..output import options
from ..output.terminal import say, show
from ..units import in_both


def command(
    diameter: Annotated[
        float | None,
        options.quantity("m", "Diameter of the journal, m or such as 100mm.", "--diameter"),
    ] = None,
    length: Annotated[
        float | None, options.quantity("m", "Length, at most half the diameter.", "--length")
    ] = None,
    clearance: Annotated[
        float | None, options.quantity("m", "Clearance of the radii.", "--clearance")
    ] = None,
    viscosity: Annotated[
        float | None,
        options.quantity("Pa s", "Of the oil, Pa s or such as '30 mPa s'.", "--viscosity"),
    ] = None,
    load: Annotated[
        float | None, options.quantity("N", "Static load, downwards.", "--load")
    ] = None,
    limits: Annotated[tuple[str, str] | None, options.RANGE] = None,
    output: Annotated[
        Path | None, options.output(options.TABLE, "Write the table as CSV.", "--output", "-o")
    ] = None,
) -> None:
    """Make a table of a short journal bearing over the speed."""
    values = {
        "diameter": diameter, "length": length, "clearance": clearance, "viscosity": viscosity,
        "load": load,
    }  # fmt: skip
    given = {key: value for key, value in values.items() if value is not None}
    missing = [f"--{key}" for key in values if key not in given]
    if missing or limits is None:
        needed = ", ".join([*missing, *(["--range"] if limits is None else [])])
        raise UserError(f"bearing: needs {needed}; see autobalancer bearing --help")
    from ..film.table import find_film

    found = find_film(**given, speeds=limits)
    show(found.sheet())
    threshold = found.threshold
    if threshold is None:
        say("A rigid rotor of this weight reaches no threshold of oil whirl within the table.")
    elif threshold == found.rows[0, 0]:
        say(
            f"A rigid rotor of this weight whirls in the oil at {in_both(threshold, 'rad/s')} "
            "already, where the table begins: a lower --range shows from which speed on."
        )
    else:
        say(
            f"A rigid rotor of this weight whirls in the oil from {in_both(threshold, 'rad/s')} on."
        )
    if output is not None:
        found.save(output)
        say(f'Table: {output}; in a scene: bearings = [{{support = 1, table = "{output.name}"}}]')
