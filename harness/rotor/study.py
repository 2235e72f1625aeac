"""What a rotor person asks first: natural frequencies, unbalance response, a run-up.

Curves come from the rotor's equations, points and motions from its co-simulated unit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...models.arrays import Array
from ...models.linear.modes import Campbell, Modes, campbell, critical_speeds, modes
from ...models.linear.synchronous import synchronous
from ...models.papers.influence import influence
from ..errors import UserError
from ..master.names import stations
from ..master.revolution import Revolution
from ..master.run import cosimulate
from ..scene import Scene

CURVE_POINTS = 400
MEASURED_POINTS = 16
RUN_UP_REVOLUTIONS = 100  # slow enough for resonances to show, short enough to wait for


@dataclass(frozen=True, eq=False)
class UnbalanceResponse:
    """Steady vibration by unbalance of the rotor without balancers.

    Attributes:
        title: of the scene.
        stations: names of the stations.
        speeds, amplitude: (m,) and (m, 2, n) complex, x and y of every station, 0-peak: x =
            Re(A e^{i angle}) by the equations [rad/s, m].
        points, measured: (k,), (k, 2, n), the same by the co-simulated unit.
        critical: critical speeds within the range [rad/s].
    """

    title: str
    stations: tuple[str, ...]
    speeds: Array
    amplitude: NDArray[np.complexfloating]
    points: Array
    measured: NDArray[np.complexfloating]
    critical: Array


@dataclass(frozen=True, eq=False)
class RunUpMotion:
    """Displacement while the speed rises.

    Attributes:
        title: of the scene.
        stations: names of the stations.
        seconds: duration of the rise.
        run: with the balancers, speeds (m,) [rad/s] and sqrt(x^2 + y^2) (m, n) [m].
        alone: the same without them; None where the scene has none.
        critical: critical speeds of the rotor alone within the range [rad/s].
    """

    title: str
    stations: tuple[str, ...]
    seconds: float
    run: tuple[Array, Array]
    alone: tuple[Array, Array] | None
    critical: Array


def station_names(scene: Scene) -> tuple[str, ...]:
    """What the stations are called in pictures."""
    numbers = range(1, len(scene.rotor.stations) + 1)
    if len(numbers) == 1:
        return ("disc",)
    word = "support" if scene.rotor.supports == tuple(numbers) else "station"
    return tuple(f"{word} {j}" for j in numbers)


def _outputs(count: int) -> list[str]:
    """x of all stations, then y."""
    return [f"{prefix}{axis}" for axis in "xy" for prefix in stations(count)]


def modes_at(scene: Scene) -> Modes:
    """Modes of the rotor without balancers at the operating speed."""
    scene.refuse_friction("modes are those")
    return modes(scene.assembly().rotor, scene.profile().end)


def campbell_of(scene: Scene, low: float, high: float) -> tuple[Campbell, Array]:
    """Modes of the rotor without balancers over a range of speeds, and its critical speeds there.

    Raises:
        UserError: a mode is overdamped in part of the range.
    """
    scene.refuse_friction("modes are those")
    rotor = scene.assembly().rotor
    try:
        found = campbell(rotor, np.linspace(low, high, CURVE_POINTS).tolist())
    except ValueError as error:
        raise UserError(f"{low:g} to {high:g} rad/s: {error}") from error
    return found, _within(critical_speeds(rotor), low, high)


def response_of(scene: Scene, low: float, high: float) -> UnbalanceResponse:
    """Unbalance response by the equations, and by the unit at some speeds.

    Raises:
        UserError: the rotor has no unbalance, or no damping at a critical speed.
    """
    rotor = scene.assembly().rotor
    if not np.abs(rotor.unbalance).any():
        raise UserError(f"{scene.path or scene.name}: rotor: has no unbalance to respond to")
    each = np.eye(rotor.stations)
    speeds, points = np.linspace(low, high, CURVE_POINTS), np.linspace(low, high, MEASURED_POINTS)
    try:
        curve = [influence(rotor, float(w), each) @ rotor.unbalance for w in speeds]
    except ValueError as error:
        raise UserError(str(error)) from error
    with Revolution(scene.without_balancers()) as units:
        measured = [_steady(units, float(w)) for w in points]
    return UnbalanceResponse(
        title=scene.heading,
        stations=station_names(scene),
        speeds=speeds,
        amplitude=np.array(curve),
        points=points,
        measured=np.array(measured),
        critical=_within(critical_speeds(rotor), low, high),
    )


def _steady(units: Revolution, speed: float) -> NDArray[np.complexfloating]:
    """Synchronous amplitude (2, n) of the revolution that repeats itself."""
    rest = np.zeros(len(units.states))
    # the rotor alone is linear: its map is the same everywhere
    state, _ = units.steady(speed, rest, units.monodromy(rest, speed))
    n = units.scene.assembly().rotor.stations
    table = units.record(state, speed, ["angle", *_outputs(n)])
    return synchronous(table[:, 0], table[:, 1:].T).reshape(2, n)


def _run(scene: Scene) -> tuple[Array, Array]:
    """Times (m,) of a run and the stations' motion (m, 2, n), x and y."""
    count = len(scene.rotor.stations)
    outputs = [f"rotor.{name}" for name in _outputs(count)]
    result = cosimulate(scene, record=outputs)
    motion = np.stack([result[name] for name in outputs], axis=1)
    return result.time, motion.reshape(-1, 2, count)


def run_up_of(scene: Scene, low: float, high: float) -> RunUpMotion:
    """A linear run-up through the range, with and without the balancers, from rest."""
    seconds = 2.0 * (2.0 * math.pi * RUN_UP_REVOLUTIONS) / (low + high)
    rising = scene.replace(
        {
            "operation.run_up": {"from": low, "to": high, "seconds": seconds},
            "run.revolutions": RUN_UP_REVOLUTIONS,
        }
    )
    alone = _displacement(rising.without_balancers()) if scene.balancer else None
    critical = _within(critical_speeds(scene.assembly().rotor), low, high)
    names = station_names(scene)
    return RunUpMotion(scene.heading, names, seconds, _displacement(rising), alone, critical)


def _displacement(rising: Scene) -> tuple[Array, Array]:
    """Speeds (m,) and sqrt(x^2 + y^2) (m, n); each run has times of its own."""
    time, motion = _run(rising)
    speeds = np.array([rising.profile().speed(t) for t in time])
    return speeds, np.hypot(motion[:, 0], motion[:, 1])


def _within(values: Array, low: float, high: float) -> Array:
    return values[(values >= low) & (values <= high)]
