"""Amplitudes that a scene shows where they were measured, for many parameters at once.

By runs in C; or, as a first guess, by harmonic balance, where the scene is a rotor alone.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ...models.arrays import Array
from ...models.harmonic_balance import NoResponse, largest_displacement, unbalance_response
from ..errors import SimulationError, UserError
from ..master.names import station_residuals
from ..result.alike import table_of
from ..result.many import cosimulate_many
from ..scene import Scene
from .measured import AMPLITUDE, LARGEST, SPEED, MeasuredAmplitudes
from .parameters import Parameter


class Model:
    """Runs of a scene under the settings of a measurement, in C.

    Args:
        scene: at constant speed; its revolutions are a run's, the last is compared.

    Raises:
        UserError: the speed changes.
    """

    most_steps = 60  # of a search

    def __init__(
        self, scene: Scene, parameters: Sequence[Parameter], measured: MeasuredAmplitudes
    ) -> None:
        if scene.profile().changes:
            raise UserError(f"{scene.name}: operation: a fit requires runs at constant speed")
        self._scene, self.parameters, self._measured = scene, parameters, measured
        others = {name: column for name, column in measured.settings.items() if name != SPEED}
        rows = np.array(list(others.values())).T.reshape(self._count, len(others))
        distinct, self._kind = np.unique(rows, axis=0, return_inverse=True)
        self._kind = self._kind.ravel()
        self._kinds = [dict(zip(others, row, strict=True)) for row in distinct.tolist()]
        self._stations = station_residuals(len(scene.rotor.stations))
        self._supports = [self._stations[number - 1] for number in scene.rotor.supports]

    @property
    def _count(self) -> int:
        return len(next(iter(self._measured.amplitudes.values())))

    def scene(self, values: Sequence[float]) -> Scene:
        """The scene with these parameters.

        Raises:
            SceneError: they do not fit together.
        """
        pairs = zip(self.parameters, values, strict=True)
        changes = [parameter.changes(value).items() for parameter, value in pairs]
        return self._scene.replace(dict(item for some in changes for item in some))

    def amplitudes(self, sets: Array) -> Array:
        """What would be measured (s, values) with parameters (s, p) [m].

        Raises:
            SceneError: parameters do not fit together.
            SimulationError: a run has failed.
        """
        bases = [self.scene(values) for values in sets.tolist()]
        scenes = [base.replace(kind) for base in bases for kind in self._kinds]
        place = (np.arange(len(sets))[:, None] * len(self._kinds) + self._kind).ravel()
        speeds = self._measured.settings.get(SPEED)
        found = self._found(scenes, place, None if speeds is None else np.tile(speeds, len(sets)))
        found[AMPLITUDE] = np.mean([found[name] for name in self._supports], axis=0)
        columns = [
            found[name].reshape(len(sets), -1)[:, ~np.isnan(column)]
            for name, column in self._measured.amplitudes.items()
        ]
        return np.concatenate(columns, axis=1)

    def _found(
        self, scenes: Sequence[Scene], place: NDArray[np.int_], speeds: Array | None
    ) -> dict[str, Array]:
        """By name the residuals of what was measured and of the supports, (places,) [m].

        Args:
            place: (places,) of the scenes.
            speeds: (places,) [rad/s]; else the scene's.
        """
        table = {name: np.array(column)[place] for name, column in table_of(scenes).items()}
        if speeds is not None:
            table[SPEED] = speeds
        own = [name for name in self._measured.amplitudes if name != AMPLITUDE]
        found = cosimulate_many(scenes[0], table, results=[*{*own, *self._supports}])
        for reason in filter(None, found["failure"]):
            raise SimulationError(f"{self._scene.name}: a run failed: {reason}")
        return dict(found)


class HarmonicModel(Model):
    """The same by harmonic balance: a rotor alone, as it vibrates when it has settled.

    Raises:
        NoResponse: the scene has balancers, gravity or a motor.
    """

    most_steps = 200

    def __init__(
        self, scene: Scene, parameters: Sequence[Parameter], measured: MeasuredAmplitudes
    ) -> None:
        operation = scene.operation
        if scene.balancer or operation.gravity or operation.motor or operation.unbalance_changes:
            raise NoResponse(
                "harmonic balance does not support balancers, gravity, motor or changes"
            )
        super().__init__(scene, parameters, measured)

    def _found(
        self, scenes: Sequence[Scene], place: NDArray[np.int_], speeds: Array | None
    ) -> dict[str, Array]:
        largest = np.empty((len(place), len(self._stations)))
        for k, scene in enumerate(scenes):
            here = place == k
            own = np.full(here.sum(), scene.operation.speed) if speeds is None else speeds[here]
            largest[here] = largest_displacement(unbalance_response(scene.assembly().rotor, own))
        return {LARGEST: largest.max(axis=1), **dict(zip(self._stations, largest.T, strict=True))}
