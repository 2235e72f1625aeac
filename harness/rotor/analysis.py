"""The rotor alone: natural frequencies, Campbell diagram, unbalance response, run-up.

Curves come from the rotor's equations, points and motions from its co-simulated unit.
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass
from itertools import chain
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from ...models.arrays import Array
from ...models.linear.critical import critical_speeds, speeds_of_interest
from ...models.linear.modes import FREE_RATE, Campbell, Modes, campbell, modes
from ...models.linear.synchronous import synchronous
from ...models.papers.influence import influence
from ..errors import UserError
from ..master.names import along_axes, by_unit, displacements
from ..output.outcome import Outcome
from ..output.table import Sheet
from ..result.run import cosimulate
from ..result.sag import complex_motion, from_sag
from ..result.supports import HEADS, support_sheet
from ..scene import Scene
from ..scene.at_rest import about_restraints
from ..scene.plausible import ImplausibleWarning
from ..scene.quantities import LARGEST
from ..stability.revolution import Revolution
from ..units import in_both, si_number

CURVE_POINTS = 400
MEASURED_POINTS = 16
RUN_UP_REVOLUTIONS = 100  # slow enough for resonances to show, short enough to wait for

Kind = Literal["modes", "campbell", "response", "run-up"]


@dataclass(frozen=True, eq=False)
class UnbalanceResponse:
    """Steady vibration by unbalance of the rotor without balancers.

    Attributes:
        speeds, amplitude: (m,) and (m, 2, n) complex, x and y of every station, 0-peak: x =
            Re(A e^{i angle}) by the equations [rad/s, m].
        points, measured: (k,), (k, 2, n), the same by the co-simulated unit.
    """

    speeds: Array
    amplitude: NDArray[np.complexfloating]
    points: Array
    measured: NDArray[np.complexfloating]


@dataclass(frozen=True, eq=False)
class RunUpMotion:
    """Displacement while the speed rises.

    Attributes:
        seconds: duration of the rise.
        run: with the balancers, speeds (m,) [rad/s] and sqrt(x^2 + y^2), under gravity from
            the sag, (m, n) [m].
        alone: the same without them; None where the scene has none.
    """

    seconds: float
    run: tuple[Array, Array]
    alone: tuple[Array, Array] | None


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

    drawn_by: ClassVar[str] = "..rotor.plot:draw"

    scene: Scene
    low: float
    high: float
    modes: Modes
    critical: Array
    critical_loaded: Array

    def campbell(self) -> Campbell:
        """Modes over the range of speeds.

        Raises:
            UserError: a mode is overdamped in part of the range.

        >>> found = ab.load("drum").rotor(5.0, 200.0)
        >>> found.campbell().whirl.shape  # speeds, modes
        (400, 4)
        """
        speeds = np.linspace(self.low, self.high, CURVE_POINTS)
        try:
            return campbell(self.scene.assembly().rotor, speeds.tolist())
        except ValueError as error:
            raise UserError(f"{self.low:g} to {self.high:g} rad/s: {error}") from error

    def response(self) -> UnbalanceResponse:
        """Steady vibration by unbalance over the range, by equations and by the unit.

        Raises:
            UserError: the rotor has no unbalance, or no damping at a critical speed.

        >>> found = ab.load("drum").rotor(5.0, 200.0)
        >>> found.response().amplitude.shape  # speeds, stations, axes
        (400, 2, 2)
        """
        self.scene.refuse_restraints("the response over the speed is that")
        rotor = self.scene.assembly().rotor
        if not np.abs(rotor.unbalance).any():
            raise UserError(f"{self.scene.label}: rotor: has no unbalance to respond to")
        each = np.eye(rotor.stations)
        speeds, points = (
            np.linspace(self.low, self.high, count) for count in (CURVE_POINTS, MEASURED_POINTS)
        )
        try:
            curve = [influence(rotor, float(w), each) @ rotor.unbalance for w in speeds]
        except ValueError as error:
            raise UserError(str(error)) from error
        with Revolution(self.scene.without_balancers()) as units:
            measured = [_steady(units, float(w)) for w in points]
        return UnbalanceResponse(speeds, np.array(curve), points, np.array(measured))

    def run_up(self) -> RunUpMotion:
        """Displacement while the speed rises through the range, with and without balancers.

        >>> found = ab.load("drum").rotor(5.0, 200.0)
        >>> found.run_up().seconds > 0.0
        True
        """
        seconds = 2.0 * (2.0 * math.pi * RUN_UP_REVOLUTIONS) / (self.low + self.high)
        rising = self.scene.replace(
            {
                "operation.run_up": {"from": self.low, "to": self.high, "seconds": seconds},
                "run.revolutions": RUN_UP_REVOLUTIONS,
            }
        )
        moved = _displacement(rising)
        with warnings.catch_warnings():  # the scene itself has had its warnings
            warnings.simplefilter("ignore", ImplausibleWarning)
            alone = _displacement(rising.without_balancers()) if self.scene.balancer else None
        return RunUpMotion(seconds, moved, alone)

    def forces(self) -> Sheet:
        """Forces at supports and feet at the speed of operation, by the unbalance alone.

        >>> ab.load("drum").rotor(5.0, 200.0).forces().columns[:2]
        ('place', 'force [N]')
        """
        rotor, speed = self.scene.assembly().rotor, self.modes.speed
        try:
            motion = influence(rotor, speed, np.eye(rotor.stations)) @ rotor.unbalance
        except ValueError as error:
            raise UserError(str(error)) from error
        return support_sheet(self.scene, rotor, motion, speed)

    def table(self) -> Sheet:
        """Natural frequency, damping and whirl of every mode."""
        found = self.modes
        rates = found.natural_frequencies
        frequencies = np.where(rates > FREE_RATE * rates.max(), rates, 0.0)  # of rigid motions: 0
        columns = (frequencies, found.damping_ratios, found.directions)
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
            "state": self.modes.states,
        }
        rows = zip(*columns.values(), strict=True)
        return {
            "scene": self.scene.name,
            "supports": about_restraints(self.scene),
            "speed": self.modes.speed,
            "forces": [dict(zip(HEADS, row, strict=True)) for row in self.forces().rows],
            "critical_speeds": self.critical.tolist(),
            "critical_speeds_loaded": self.critical_loaded.tolist(),
            "modes": [dict(zip(columns, row, strict=True)) for row in rows],
        }


def analyse(scene: Scene, low: float | str | None, high: float | str | None) -> RotorAnalysis:
    """See `Scene.rotor`."""
    scene.refuse_friction("modes are those")
    assembly, speed = scene.assembly(), scene.profile().end
    ends = speeds_of_interest(assembly.rotor, speed)
    given = (end if one is None else one for one, end in zip((low, high), ends, strict=True))
    first, last = (si_number(one, "rad/s", "range:") for one in given)
    if not 0.0 < first < last <= LARGEST:
        raise UserError(
            f"--range {first:g} {last:g}: must be two speeds [rad/s], 0 < LOW < HIGH <= {LARGEST:g}"
        )
    critical = [critical_speeds(rotor) for rotor in (assembly.rotor, assembly.loaded_rotor)]
    return RotorAnalysis(scene, first, last, modes(assembly.rotor, speed), *critical)


def _steady(units: Revolution, speed: float) -> NDArray[np.complexfloating]:
    """Synchronous amplitude (2, n) of the revolution that repeats itself."""
    count = len(units.scene.rotor.points)
    names = by_unit(chain(*along_axes(count)))["rotor"]
    table = units.record(units.steady(speed), speed, ["angle", *names])
    return synchronous(table[:, 0], table[:, 1:].T).reshape(2, count)


def _displacement(rising: Scene) -> tuple[Array, Array]:
    """Speeds (m,) and sqrt(x^2 + y^2) from the sag (m, n); each run has times of its own."""
    count = len(rising.rotor.points)
    result = cosimulate(rising, record=displacements(count))
    moved = complex_motion(from_sag(result.signals, result.sag()), count)
    return rising.profile().speeds_at(result.time), np.abs(moved).T
