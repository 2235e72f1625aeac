"""A virtual balancing machine: a scene's rotor unit, its supports watched, weights put on by hand.

The unit knows neither matrices nor coefficients: it is run to its steady state with an unbalance
added in some planes, and the synchronous part of what the supports do is fitted to the samples of
whole revolutions, as the instrument of a machine does.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError, SimulationError
from ..master.cosimulation import CoSimulation
from ..master.schedule import steps_per_rev
from ..scene import Scene
from ..scene.balancing import Balancing
from ..scene.rotor import FlexibleRotor, PlanarRotor, TwoSupportRotor
from ..stability.revolution import states

Complex = NDArray[np.complexfloating]

STEADY = 1e-10  # of each state's scale: what one revolution may still change; rounding is 1e-13
STEADY_ITERATIONS = 6  # the rotor is linear: one does it, the rest take out rounding
UNSTABLE = 1e-6  # a multiplier beyond 1 + this grows; an undamped rotor has exactly 1
DRIFT = 1e-8  # of the amplitude, between the halves of a measurement: more is no steady state
SIGMAS = 6.0  # noise may look like this much drift once in 1e9 measurements


@dataclass(frozen=True, eq=False)
class Reading:
    """Synchronous vibration of the supports.

    Attributes:
        amplitude: (s,) complex A, 0-peak: displacement = Re(A e^{i angle}) [m].
        uncertainty: (s,) standard uncertainty of its real and of its imaginary part [m].
    """

    amplitude: Complex
    uncertainty: NDArray[np.float64]


class Machine:
    """The rotor of a scene, without its balancers, on the machine.

    Args:
        scene: with a table [balancing].
        fmus: directory of ready-made FMUs.

    Raises:
        SceneError: the scene has no table [balancing].
        SimulationError: the rotor is not stable at this speed.
    """

    def __init__(self, scene: Scene, fmus: Path | None = None) -> None:
        if scene.balancing is None:
            raise SceneError(
                f"{scene.path or scene.name}: has no table [balancing]; it needs at least "
                'grade = "G2.5"'
            )
        self.setup: Balancing = scene.balancing
        self.planes = self.setup.correction_planes(scene.rotor)
        bare, self._own, self._added = _with_corrections(scene, self.planes)
        self.speed = bare.profile().speed(0.0)
        self.steps = steps_per_rev(bare)
        self._step = 2.0 * math.pi / (self.speed * self.steps)
        self._states = states(bare)
        self._scale = np.array([s.scale * (self.speed if s.is_rate else 1.0) for s in self._states])
        self.noise = np.random.default_rng(self.setup.seed)
        self.runs = 0
        self.cosim = CoSimulation(bare, fmus=fmus, watch=False)
        try:
            unit = self.cosim.units["rotor"]
            self._outputs = unit.group([s.output for s in self._states])
            self._watched = unit.group(["angle", *_sensors(scene, self.setup.axis)])
            self._map = self._one_turn_map()
        except BaseException:
            self.close()
            raise

    @property
    def sensors(self) -> int:
        """Number of supports watched."""
        return self._watched.size - 1

    def measure(self, added: Complex | None = None) -> Reading:
        """Run with unbalances `added` (p,) in the correction planes [kg m] and read the supports.

        Raises:
            SimulationError: the vibration is not steady.
        """
        self.runs += 1
        mounted = np.zeros(len(self.planes), complex) if added is None else added
        self._start(self._steady(mounted), mounted)
        unit, rows = self.cosim.units["rotor"], []
        for _ in range(self.setup.revolutions * self.steps):
            self.cosim.step(self._step)
            rows.append(unit.get(self._watched))
        angle, *motion = np.array(rows).T
        samples = np.array(motion)
        samples = samples + self.setup.noise * self.noise.standard_normal(samples.shape)
        _refuse_drift(angle, samples)
        return synchronous(angle, samples)

    def _steady(self, mounted: Complex) -> NDArray[np.float64]:
        """States that one revolution returns to: no waiting for the transient to die away."""
        state = np.zeros(len(self._states))
        back = np.eye(len(state)) - self._map
        for _ in range(STEADY_ITERATIONS):
            residual = (self._turn(state, mounted) - state) / self._scale
            state = state + np.linalg.lstsq(back, residual, rcond=None)[0] * self._scale
            if np.abs(residual).max() <= STEADY * (1.0 + np.abs(state / self._scale).max()):
                return state
        raise SimulationError(
            f"rotor: no steady vibration found at {self.speed:g} rad/s: one revolution still moves "
            f"the states by {np.abs(residual).max():.3g} of their scale"
        )

    def _one_turn_map(self) -> NDArray[np.float64]:
        """Derivative of the states after one revolution, (n, n) in their scales; any size will do.

        Raises:
            SimulationError: vibration grows by itself.
        """
        still = np.zeros(len(self.planes), complex)
        rest = self._turn(np.zeros(len(self._states)), still)
        columns = [
            (self._turn(scale * unit, still) - rest) / self._scale
            for scale, unit in zip(self._scale, np.eye(len(self._states)), strict=True)
        ]
        matrix = np.array(columns).T
        largest = float(np.abs(np.linalg.eigvals(matrix)).max())
        if largest > 1.0 + UNSTABLE:
            raise SimulationError(
                f"rotor: not stable at {self.speed:g} rad/s: free vibration grows {largest:.6g} "
                "times in each revolution, so that there is no steady state to measure"
            )
        return matrix

    def _turn(self, state: NDArray[np.float64], mounted: Complex) -> NDArray[np.float64]:
        self._start(state, mounted)
        for _ in range(self.steps):
            self.cosim.step(self._step)
        return np.array(self.cosim.units["rotor"].get(self._outputs))

    def _start(self, state: NDArray[np.float64], mounted: Complex) -> None:
        changes: dict[str, float | bool] = {
            s.start: float(value) for s, value in zip(self._states, state, strict=True)
        }
        for (amount, angle), own, more in zip(self._added, self._own, mounted, strict=True):
            total = complex(own + more)
            changes[amount], changes[angle] = abs(total), math.atan2(total.imag, total.real)
        self.cosim.start({"rotor": changes}, self._step)

    def close(self) -> None:
        """Free the unit."""
        self.cosim.close()

    def __enter__(self) -> Machine:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.close()


def synchronous(angle: NDArray[np.float64], samples: NDArray[np.float64]) -> Reading:
    """Least-squares fit of Re(A e^{i angle}) + c to samples (s, m) taken at rotor angles (m,).

    The uncertainty comes from what the fit leaves, shared over the samples by their covariance.
    """
    matrix = np.column_stack([np.cos(angle), -np.sin(angle), np.ones_like(angle)])
    found = np.linalg.lstsq(matrix, samples.T, rcond=None)[0]
    left = samples.T - matrix @ found
    variance = (left**2).sum(axis=0) / max(1, len(angle) - matrix.shape[1])
    spread = np.linalg.inv(matrix.T @ matrix).diagonal()[:2].max()
    return Reading(found[0] + 1j * found[1], np.sqrt(variance * spread))


def _refuse_drift(angle: NDArray[np.float64], samples: NDArray[np.float64]) -> None:
    """Raise SimulationError unless both halves of a measurement tell the same."""
    half = len(angle) // 2
    first = synchronous(angle[:half], samples[:, :half])
    last = synchronous(angle[half:], samples[:, half:])
    drift = np.abs(last.amplitude - first.amplitude)
    # absolute: a support may happen to stand still
    allowed = DRIFT * np.abs(last.amplitude).max() + SIGMAS * np.hypot(
        first.uncertainty, last.uncertainty
    )
    if np.any(drift > allowed):
        raise SimulationError(
            f"rotor: vibration is not steady: amplitude drifts by {drift.max():.3g} m during the "
            f"measurement, allowed {allowed.max():.3g} m"
        )


def _sensors(scene: Scene, axis: str) -> list[str]:
    """Outputs that show the supports' displacement."""
    rotor = scene.rotor
    if isinstance(rotor, PlanarRotor):
        return [axis]
    supports = rotor.supports if isinstance(rotor, FlexibleRotor) else (1, 2)
    return [f"station[{j}].{axis}" for j in supports]


def _with_corrections(
    scene: Scene, planes: list[int]
) -> tuple[Scene, Complex, list[tuple[str, str]]]:
    """The bare scene with room for corrections.

    Returns:
        The scene, unbalances (p,) its rotor already has at these places [kg m], and the parameters
        (amount, angle) of each.
    """
    # the machine holds one speed: where a run-up ends
    bare = scene.without_balancers().replace({"operation.speed": scene.profile().end})
    rotor = bare.rotor
    if isinstance(rotor, PlanarRotor):
        own = rotor.unbalance * np.exp(1j * rotor.unbalance_angle)
        return bare, np.array([own]), [("unbalance", "unbalance_angle")]
    places = rotor.planes if isinstance(rotor, TwoSupportRotor) else rotor.stations
    table: list[Mapping[str, Any]] = [u.model_dump() for u in rotor.unbalances]
    first = len(table) + 1
    table += [{"position": places[p - 1], "amount": 0.0, "angle": 0.0} for p in planes]
    names = [
        (f"unbalance[{k}].amount", f"unbalance[{k}].angle")
        for k in range(first, first + len(planes))
    ]
    zero = np.zeros(len(planes), complex)
    return bare.replace({"rotor.unbalances": table}), zero, names
