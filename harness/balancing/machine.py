"""A virtual balancing machine: a scene's rotor unit, its supports watched, weights put on by hand.

The unit knows neither matrices nor coefficients: it is run to its steady state with an unbalance
added in some planes, and the synchronous part of what the supports do is fitted to the samples of
whole revolutions, as the instrument of a machine does.
"""

from __future__ import annotations

import cmath

import numpy as np

from ...models.arrays import Array, Complex
from ...models.linear.synchronous import synchronous
from ..errors import SceneError, SimulationError
from ..master.closing import Closing
from ..master.names import station
from ..scene import Scene
from ..scene.balancing import Balancing
from ..stability.revolution import Revolution

UNSTABLE = 1e-6  # a multiplier beyond 1 + this grows; an undamped rotor has exactly 1
DRIFT = 1e-8  # of the amplitude, between the halves of a measurement: more is no steady state


class Machine(Closing):
    """The rotor of a scene, without its balancers, on the machine.

    Args:
        scene: with a table [balancing].

    Raises:
        SceneError: the scene has no table [balancing].
        SimulationError: the rotor is not stable at this speed.
    """

    def __init__(self, scene: Scene) -> None:
        if scene.balancing is None:
            raise SceneError(
                f'{scene.label}: has no table [balancing]; it needs at least grade = "G2.5"'
            )
        self.setup: Balancing = scene.balancing
        self.planes = self.setup.correction_planes(scene.rotor)
        self._room = scene.rotor.with_corrections(self.planes)
        self.speed = scene.profile().end  # the machine holds one speed: where a run-up ends
        bare = scene.without_balancers().replace(self._room.changes)
        self.runs = 0
        self.revolution = Revolution(bare)
        count = len(scene.rotor.points)
        supports = [station(j, count) + self.setup.axis for j in scene.rotor.supports]
        self._watched = ["angle", *supports]
        rest = np.zeros(len(self.revolution.states))
        try:
            self._monodromy = self.revolution.monodromy(rest, self.speed)
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

    def measure(self, added: Complex) -> Complex:
        """Amplitudes (s,) of the supports with unbalances `added` (p,) in the planes [kg m].

        The rotor is linear: its steady motion is found at once, with no waiting for the transient
        to die away.

        Raises:
            SimulationError: the vibration is not steady.
        """
        self.runs += 1
        unbalances = np.array(self._room.present) + added
        parameters = self._room.parameters
        for (size, direction), value in zip(parameters, unbalances.tolist(), strict=True):
            self.revolution.rotor[size], self.revolution.rotor[direction] = cmath.polar(value)
        state = self.revolution.steady(self.speed, self._monodromy)
        rows = self.revolution.record(state, self.speed, self._watched, self.setup.revolutions)
        angle, samples = rows[:, 0], rows[:, 1:].T
        _refuse_drift(angle, samples)
        return synchronous(angle, samples)

    def close(self) -> None:
        """Free the unit."""
        self.revolution.close()


def _refuse_drift(angle: Array, samples: Array) -> None:
    """Raise SimulationError unless both halves of a measurement tell the same."""
    half = len(angle) // 2
    first = synchronous(angle[:half], samples[:, :half])
    last = synchronous(angle[half:], samples[:, half:])
    drift = np.abs(last - first)
    # absolute: a support may happen to stand still
    allowed = DRIFT * np.abs(last).max()
    if np.any(drift > allowed):
        raise SimulationError(
            f"rotor: vibration is not steady: amplitude drifts by {drift.max():.3g} m during the "
            f"measurement, allowed {allowed:.3g} m"
        )
