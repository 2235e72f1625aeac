"""The rotor alone: its modes and critical speeds as a table, its pictures by their kinds."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Literal, get_args

from ...models.arrays import Array
from ...models.linear.modes import Campbell, Modes, critical_speeds, speeds_of_interest
from ..errors import UserError
from ..output.outcome import Outcome
from ..output.table import Sheet
from ..scene import Scene
from ..scene.quantities import LARGEST
from ..units import in_both, si_number
from . import study

if TYPE_CHECKING:
    from ..output.picture import Picture
    from ..output.plot import Drawing

Kind = Literal["modes", "campbell", "response", "polar", "run-up"]


@dataclass(frozen=True, eq=False, repr=False)
class RotorAnalysis(Outcome):
    """Modes of the rotor without balancers at the operating speed, and what is drawn of it.

    Attributes:
        scene: whose rotor it is.
        low, high: speeds of the pictures [rad/s].
        modes: natural frequencies, damping, whirl and shapes.
        critical, critical_loaded: critical speeds, undamped, of the rotor alone and with its
            balancers' masses fixed to it [rad/s].
    """

    drawn_by: ClassVar[str] = "..rotor.analysis:draw"

    scene: Scene
    low: float
    high: float
    modes: Modes
    critical: Array
    critical_loaded: Array

    def campbell(self) -> Campbell:
        """Modes over the range of speeds.

        >>> found = ab.load("drum").rotor(5.0, 200.0)
        >>> found.campbell().whirl.shape  # speeds, modes
        (400, 4)
        """
        return study.campbell_of(self.scene, self.low, self.high)[0]

    def response(self) -> study.UnbalanceResponse:
        """Steady vibration by unbalance over the range, by equations and by the unit.

        >>> found = ab.load("drum").rotor(5.0, 200.0)
        >>> found.response().amplitude.shape  # speeds, stations, axes
        (400, 2, 2)
        """
        return study.response_of(self.scene, self.low, self.high)

    def run_up(self) -> study.RunUpMotion:
        """Displacement while the speed rises through the range, with and without balancers.

        >>> found = ab.load("drum").rotor(5.0, 200.0)
        >>> found.run_up().seconds > 0.0
        True
        """
        return study.run_up_of(self.scene, self.low, self.high)

    def table(self) -> Sheet:
        """Natural frequency, damping and whirl of every mode."""
        found = self.modes
        columns = (found.natural_frequencies, found.damping_ratios, found.directions)
        rows = [
            (number, float(frequency), float(frequency) / math.tau, float(damping), whirl)
            for number, (frequency, damping, whirl) in enumerate(zip(*columns, strict=True), 1)
        ]
        heads = ("mode", "frequency [rad/s]", "[Hz]", "damping ratio [1]", "whirl")
        title = f"{self.scene.heading}: rotor alone at {in_both(found.speed, 'rad/s')}"
        return Sheet(heads, rows, "rrrrl", title)

    def as_json(self) -> dict[str, Any]:
        """Modes and critical speeds, SI units."""
        columns = {
            "frequency": self.modes.natural_frequencies,
            "damping_ratio": self.modes.damping_ratios,
            "growth_rate": self.modes.eigenvalues.real,
            "whirl": self.modes.whirl,
            "direction": self.modes.directions,
        }
        rows = zip(*columns.values(), strict=True)
        return {
            "scene": self.scene.name,
            "speed": self.modes.speed,
            "critical_speeds": self.critical.tolist(),
            "critical_speeds_loaded": self.critical_loaded.tolist(),
            "modes": [dict(zip(columns, row, strict=True)) for row in rows],
        }


def analyse(scene: Scene, low: float | str | None, high: float | str | None) -> RotorAnalysis:
    """See `Scene.rotor`."""
    assembly = scene.assembly()
    ends = speeds_of_interest(assembly.rotor, scene.profile().end)
    given = (end if one is None else one for one, end in zip((low, high), ends, strict=True))
    first, last = (si_number(one, "rad/s", "range:") for one in given)
    if not 0.0 < first < last <= LARGEST:
        raise UserError(
            f"--range {first:g} {last:g}: must be two speeds [rad/s], 0 < LOW < HIGH <= {LARGEST:g}"
        )
    critical = [critical_speeds(rotor) for rotor in (assembly.rotor, assembly.loaded_rotor)]
    return RotorAnalysis(scene, first, last, study.modes_at(scene), *critical)


def draw(
    found: RotorAnalysis, path: Path | None, kind: Kind = "campbell"
) -> Path | Drawing | Picture:
    """A picture of a kind: modes, campbell, response, polar, or run-up.

    Raises:
        UserError: the kind is unknown, or the rotor has nothing of it to show.
    """
    from ..master.pictures.in_space import mode_shapes
    from . import plot

    if kind == "campbell":
        curves = study.campbell_of(found.scene, found.low, found.high)
        return plot.plot_campbell(*curves, found.scene.heading, path)
    if kind == "response":
        return plot.plot_response(found.response(), path)
    if kind == "run-up":
        return plot.plot_run_up(found.run_up(), path)
    if kind not in ("modes", "polar"):
        raise UserError(f"kind {kind!r}: must be one of {', '.join(get_args(Kind))}")
    in_space = kind == "modes"
    picture = mode_shapes(found.scene) if in_space else plot.polar_response(found.response())
    return picture if path is None else picture.save(path)
