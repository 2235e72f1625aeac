"""A virtual balancing machine: a scene's rotor unit, its supports watched, weights put on by hand.

The unit knows neither matrices nor coefficients: it is run to its steady state with an unbalance
added in some planes, and the synchronous part of what the supports do is fitted to the samples of
whole revolutions, as the instrument of a machine does.
"""

from __future__ import annotations

import cmath
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...models.linear.synchronous import Synchronous, synchronous
from ..errors import SceneError, SimulationError
from ..scene import Scene
from ..scene.balancing import Balancing
from ..scene.rotor import FlexibleRotor, PlanarRotor, TwoSupportRotor
from ..stability.revolution import Revolution

Complex = NDArray[np.complexfloating]

UNSTABLE = 1e-6  # a multiplier beyond 1 + this grows; an undamped rotor has exactly 1
DRIFT = 1e-8  # of the amplitude, between the halves of a measurement: more is no steady state
SIGMAS = 6.0  # noise may look like this much drift once in 1e9 measurements


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
        self.noise = np.random.default_rng(self.setup.seed)
        self.runs = 0
        self.revolution = Revolution(bare, fmus=fmus)
        self._watched = ["angle", *_sensors(scene, self.setup.axis)]
        self._rest = np.zeros(len(self.revolution.states))
        try:
            self._monodromy = self.revolution.monodromy(self._rest, self.speed)
            self._refuse_unstable()
        except BaseException:
            self.close()
            raise

    def _refuse_unstable(self) -> None:
        largest = float(np.abs(np.linalg.eigvals(self._monodromy)).max())
        if largest > 1.0 + UNSTABLE:
            raise SimulationError(
                f"rotor: not stable at {self.speed:g} rad/s: free vibration grows {largest:.6g} "
                "times in each revolution, so that there is no steady state to measure"
            )

    def measure(self, added: Complex | None = None) -> Synchronous:
        """Run with unbalances `added` (p,) in the correction planes [kg m] and read the supports.

        The rotor is linear: its steady motion is found at once, with no waiting for the transient
        to die away.

        Raises:
            SimulationError: the vibration is not steady.
        """
        self.runs += 1
        unbalances = self._own if added is None else self._own + added
        for (size, direction), value in zip(self._added, unbalances.tolist(), strict=True):
            self.revolution.rotor[size], self.revolution.rotor[direction] = cmath.polar(value)
        state, _ = self.revolution.steady(self.speed, self._rest, self._monodromy)
        rows = self.revolution.record(state, self.speed, self._watched, self.setup.revolutions)
        angle, samples = rows[:, 0], rows[:, 1:].T
        samples = samples + self.setup.noise * self.noise.standard_normal(samples.shape)
        _refuse_drift(angle, samples)
        return synchronous(angle, samples)

    def close(self) -> None:
        """Free the unit."""
        self.revolution.close()

    def __enter__(self) -> Machine:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.close()


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
