"""A short journal bearing as a table of stiffness and damping over the speed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from ...models.arrays import Array
from ...models.journal import MATRICES, Film, critical_mass, short_bearing
from ..errors import UserError
from ..output.files import write_whole
from ..output.table import Sheet
from ..scene.bearing import GRAVITY, Journal, heads
from ..units import si_number

NEAR_THRESHOLD = 1e-9  # of a speed: where the bisection of a threshold ends
SHOWN = 5  # rows, of a table that is printed


@dataclass(frozen=True, eq=False)
class JournalBearing:
    """A short journal bearing over the speed.

    Attributes:
        journal: what it is made of.
        rows: (r, 9) speed [rad/s], kxx, kxy, kyx, kyy [N/m], cxx, cxy, cyx, cyy [N s/m].
    """

    journal: Journal
    rows: Array

    def save(self, path: str | Path) -> Path:
        """Write the table as CSV with units in the heads, for `table` of a scene's bearing.

        Raises:
            UserError: the file cannot be written.

        >>> film = ab.find_film(
        ...     diameter=0.1, length=0.03, clearance=1e-4, viscosity=0.1, load=525.0,
        ...     speeds=(100.0, 400.0),
        ... )
        >>> film.save("film.csv").read_text().partition(",")[0]
        'speed [rad/s]'
        """
        lines = [
            heads(),
            *(",".join(f"{value:.10g}" for value in row) for row in self.rows.tolist()),
        ]
        with write_whole(path) as file:
            file.write("\n".join(lines) + "\n")
        return Path(path)

    @property
    def threshold(self) -> float | None:
        """Speed from which on a rigid rotor of the load's weight whirls in the oil [rad/s].

        That of the first row where it whirls there already; None where it whirls at no row.
        """
        own = (self.journal.load or math.nan) / GRAVITY
        excess = [own - critical_mass(*_matrices(row))[0] for row in self.rows]
        if excess[0] > 0.0:
            return float(self.rows[0, 0])
        for k, (before, now) in enumerate(pairwise(excess)):
            if before <= 0.0 < now:
                return self._whirls_from(float(self.rows[k, 0]), float(self.rows[k + 1, 0]), own)
        return None

    def _whirls_from(self, low: float, high: float, own: float) -> float:
        """The threshold of a mass [kg] between two speeds, by bisection of the film itself."""
        while high - low > NEAR_THRESHOLD * high:
            middle = 0.5 * (low + high)
            film = self._film(middle)
            if own > critical_mass(film.stiffness, film.damping)[0]:
                high = middle
            else:
                low = middle
        return 0.5 * (low + high)

    def sheet(self) -> Sheet:
        """Some of the rows, with the static place of the journal, for a terminal.

        >>> film = ab.find_film(
        ...     diameter=0.1, length=0.03, clearance=1e-4, viscosity=0.1, load=525.0,
        ...     speeds=(100.0, 400.0),
        ... )
        >>> film.sheet().rows[0][:2]
        ('100', '0.3605')
        """
        shown = np.unique(np.linspace(0, len(self.rows) - 1, SHOWN).round().astype(int))
        columns = (
            "speed [rad/s]",
            "eccentricity",
            "attitude [deg]",
            "stiffness [N/m]",
            "damping [N s/m]",
        )
        found = [self._row(self.rows[k]) for k in shown]
        return Sheet(columns, found, "rrrll", "Film: xx xy yx yy over the speed")

    def _row(self, row: Array) -> Sequence[object]:
        film = self._film(float(row[0]))
        terms = (" ".join(f"{v:.4g}" for v in getattr(film, each).ravel()) for each in MATRICES)
        angle = math.degrees(film.attitude)
        return (f"{row[0]:.6g}", f"{film.eccentricity:.4f}", f"{angle:.2f}", *terms)

    def _film(self, speed: float) -> Film:
        j = self.journal
        return short_bearing(
            j.diameter, j.length, j.clearance, j.viscosity, j.load or math.nan, speed
        )


def find_film(
    *,
    diameter: float | str,
    length: float | str,
    clearance: float | str,
    viscosity: float | str,
    load: float | str,
    speeds: Sequence[float | str],
) -> JournalBearing:
    """Stiffness and damping of a short journal bearing over the speed (Friswell 2010).

    A laminar film of one viscosity, small motion about the static place, load along -y, turning
    from x to y. On lines between the rows values are within 1e-3 of the largest.

    Args:
        diameter, length, clearance: of the journal; at most half of that; of the radii [m].
        viscosity: of the oil at its temperature [Pa s].
        load: static [N].
        speeds: lowest and highest [rad/s].

    Raises:
        UserError: a value is wrong.

    >>> film = ab.find_film(
    ...     diameter="100 mm", length="30 mm", clearance="0.1 mm", viscosity="0.1 Pa s",
    ...     load="525 N", speeds=("1500 rpm", "3000 rpm"),
    ... )
    >>> film.rows[0, 1:3].round()
    array([12807960., 16393593.])
    """
    given = {"diameter": (diameter, "m"), "length": (length, "m"), "clearance": (clearance, "m"),
             "viscosity": (viscosity, "Pa s"), "load": (load, "N")}  # fmt: skip
    values = {key: si_number(value, symbol, f"--{key}") for key, (value, symbol) in given.items()}
    if not isinstance(speeds, Sequence) or len(speeds) != 2:
        raise UserError("--range: must be two speeds, the lowest and the highest")
    low, high = (si_number(each, "rad/s", "--range") for each in speeds)
    try:
        journal = Journal(**values, speeds=(low, high))
        table = journal.table(values["load"])
    except (UserError, ValueError, ArithmeticError) as error:
        raise UserError(f"bearing: {str(error).removeprefix('Journal: ')}") from None
    flat = [table.speeds[:, None], table.stiffness.reshape(-1, 4), table.damping.reshape(-1, 4)]
    return JournalBearing(journal, np.hstack(flat))


def _matrices(row: Array) -> tuple[Array, Array]:
    return row[1:5].reshape(2, 2), row[5:].reshape(2, 2)
