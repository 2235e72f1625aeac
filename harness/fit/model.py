"""Vibration that a scene shows where it was measured, for many parameters at once.

By runs in C; or, as a first guess, by harmonic balance, where the scene is a rotor alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...models.arrays import Array, Complex
from ...models.harmonic_balance import NoResponse, largest_displacement, unbalance_response
from ..errors import SimulationError, UserError
from ..master.names import along_axes, station_residuals
from ..result.alike import table_of
from ..result.many import cosimulate_many
from ..scene import Scene
from .measured import AMPLITUDE, LARGEST, SPEED, MeasuredAmplitudes
from .parameters import Parameter


class Turning(NamedTuple):
    """Circles that make up an orbit, of displacements Re(X e^{i theta}) and Re(Y e^{i theta}).

    Attributes:
        forward: (places, rows) (X + i Y)/2, turns with the rotor [m]; of one direction, X.
        backward: (places, rows) |X - i Y|/2 [m]; of one direction, 0.
    """

    forward: Complex
    backward: Array

    @property
    def amplitude(self) -> Array:
        """(rows,) the mean of the largest displacements [m]."""
        return (np.abs(self.forward) + self.backward).mean(axis=0)


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
            raise UserError(f"{scene.label}: operation: a fit requires runs at constant speed")
        self._scene, self.parameters, self._measured = scene, parameters, measured
        others = {name: column for name, column in measured.settings.items() if name != SPEED}
        rows = np.array(list(others.values())).T.reshape(measured.count, len(others))
        distinct, self._kind = np.unique(rows, axis=0, return_inverse=True)
        self._kind = self._kind.ravel()
        self._kinds = [dict(zip(others, row, strict=True)) for row in distinct.tolist()]
        self._stations = station_residuals(len(scene.rotor.points))
        self._supports = [self._stations[number - 1] for number in scene.rotor.supports]

    def scene(self, values: Sequence[float]) -> Scene:
        """The scene with these parameters.

        Raises:
            SceneError: they do not fit together.
        """
        pairs = zip(self.parameters, values, strict=True)
        changes = [parameter.changes(value).items() for parameter, value in pairs]
        return self._scene.replace(dict(item for some in changes for item in some))

    def logarithms(self, sets: Array) -> Array:
        """What would be measured (s, values) with parameters (s, p), as `Measured.logarithms`.

        Raises:
            SceneError: parameters do not fit together.
            UserError: an amplitude is 0.
            SimulationError: a run has failed.
        """
        bases = [self.scene(values) for values in sets.tolist()]
        scenes = [base.replace(kind) for base in bases for kind in self._kinds]
        place = (np.arange(len(sets))[:, None] * len(self._kinds) + self._kind).ravel()
        speeds = self._measured.settings.get(SPEED)
        sizes, vibrations = self._found(
            scenes,
            place,
            None if speeds is None else np.tile(speeds, len(sets)),
            list(self._measured.vibrations),
        )
        sizes[AMPLITUDE] = np.mean([sizes[name] for name in self._supports], axis=0)
        sizes |= {name: np.abs(vibrations[name]) for name in self._measured.vibrations}
        shape = len(sets), -1
        with np.errstate(divide="ignore"):  # refused below
            logarithms = {n: np.log(sizes[n]).reshape(shape) for n in self._measured.sizes}
        signals = {n: vibrations[n].reshape(shape) for n in self._measured.vibrations}
        found = self._measured.joined(logarithms, signals)
        if not np.isfinite(found).all():
            raise UserError(
                f"{self._scene.label}: does not vibrate where vibration was measured, and a fit "
                "compares logarithms of amplitudes: set an unbalance"
            )
        return found

    def turning(self, values: Array) -> dict[str, Turning]:
        """By column what turns with the rotor as a run-out does, with these values.

        A run-out adds to a displacement in one direction as it is, and of an orbit to the part
        that turns forwards; at each of the supports where their mean was measured.

        Raises:
            SimulationError: a run has failed.
        """
        base = self.scene(values.tolist())
        names = along_axes(len(self._stations))
        scenes = [base.replace(kind) for kind in self._kinds]
        speeds = self._measured.settings.get(SPEED)
        _, found = self._found(scenes, self._kind, speeds, [*chain(*names)])
        x, y = (np.array([found[name] for name in axis]) for axis in names)
        forward, backward = 0.5 * (x + 1j * y), 0.5 * np.abs(x - 1j * y)
        at = {name: [k] for k, name in enumerate(self._stations)}
        at[AMPLITUDE] = [number - 1 for number in self._scene.rotor.supports]
        largest = (np.abs(forward) + backward).argmax(axis=0), np.arange(self._measured.count)
        parts = {name: Turning(forward[rows], backward[rows]) for name, rows in at.items()}
        parts[LARGEST] = Turning(forward[largest][None], backward[largest][None])
        for name in self._measured.vibrations:
            parts[name] = Turning(found[name][None], np.zeros((1, self._measured.count)))
        return {name: parts[name] for name in self._measured.sizes}

    def _found(
        self,
        scenes: Sequence[Scene],
        place: NDArray[np.int_],
        speeds: Array | None,
        signals: Sequence[str],
    ) -> tuple[dict[str, Array], dict[str, Complex]]:
        """By name residuals of what was measured and of the supports, and signals' vibrations [m].

        Args:
            place: (places,) of the scenes.
            speeds: (places,) [rad/s]; else the scene's.
            signals: displacements of which complex amplitudes (places,) are asked.
        """
        table = {name: np.array(column)[place] for name, column in table_of(scenes).items()}
        if speeds is not None:
            table[SPEED] = speeds
        own = [name for name in self._measured.amplitudes if name != AMPLITUDE]
        parts = {name: (f"{name}.in_phase", f"{name}.quadrature_lead") for name in signals}
        asked = dict.fromkeys(
            [*own, *self._supports, *(n for pair in parts.values() for n in pair)]
        )
        found = cosimulate_many(scenes[0], table, results=list(asked))
        for reason in filter(None, found["failure"]):
            raise SimulationError(f"{self._scene.label}: a run failed: {reason}")
        vibrations = {name: found[a] + 1j * found[b] for name, (a, b) in parts.items()}
        return dict(found), vibrations


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
        self,
        scenes: Sequence[Scene],
        place: NDArray[np.int_],
        speeds: Array | None,
        signals: Sequence[str],
    ) -> tuple[dict[str, Array], dict[str, Complex]]:
        motion = np.empty((len(place), 2, len(self._stations)), complex)
        for k, scene in enumerate(scenes):
            here = place == k
            own = np.full(here.sum(), scene.operation.speed) if speeds is None else speeds[here]
            motion[here] = unbalance_response(scene.assembly().rotor, own)
        largest = largest_displacement(motion)
        sizes = {LARGEST: largest.max(axis=1), **dict(zip(self._stations, largest.T, strict=True))}
        every = chain(*along_axes(len(self._stations)))
        columns = dict(zip(every, motion.reshape(len(place), -1).T, strict=True))
        return sizes, {name: columns[name] for name in signals}
