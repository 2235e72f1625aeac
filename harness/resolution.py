"""Signals that vary faster than the communication steps: said loudly instead of computed wrongly.

With steps given by the scene nothing else would notice: the loop converges, and the cubics between
the communication points miss what happens there.  The cubic of the step before, taken on to the end
of this one, misses a resolved signal by little (`schemes.adaptive` has the estimate).
"""

from __future__ import annotations

from .errors import SimulationError
from .scene import Scene
from .system import System, Track

UNRESOLVED = 0.05  # of the largest value so far: error of a cubic within one step, as estimated
NOISE = 1e-9  # of what all weights together can pull: below it a signal is cancellation
PERSISTENT = 20  # steps in all: a transient that dies sooner does little harm to the rest
_PART = 120.0  # the prediction's miss over the error of the step's own cubic, steps being equal
_ALLOWED = UNRESOLVED * _PART


class Resolution:
    """Watches the cubic signals of a run whose steps are given.

    Args:
        scene: whose weights set the size below which signals are noise.
        system: the coupled units.
    """

    def __init__(self, scene: Scene, system: System) -> None:
        assembly, profile = scene.assembly(), scene.profile()
        pull = NOISE * assembly.capacity * max(profile.start, profile.end) ** 2
        mass = float(assembly.loaded_rotor.mass.sum())
        forces = [(c.force, f"{c.unit.name}.F", pull) for c in system.connections]
        motions = [
            (track, f"rotor.plane[{plane}].a", pull / mass)
            for track, plane in zip(system.accelerations, system.connected, strict=True)
        ]
        self._watched: list[tuple[Track, str]] = []
        for track, name, least in [*forces, *motions]:
            track.largest = max(least, abs(track.now[0]))
            self._watched.append((track, name))
        self.unresolved = 0

    def check(self, time: float, step: float) -> None:
        """Look at the step just finished.

        Raises:
            SimulationError: signals have been unresolved for too many steps.
        """
        for track, name in self._watched:
            if track.missed > _ALLOWED * track.largest:
                self._unresolved(track, name, time, step)
                return

    def _unresolved(self, track: Track, name: str, time: float, step: float) -> None:
        self.unresolved += 1
        if self.unresolved >= PERSISTENT:
            raise SimulationError(
                f"communication steps of {step:.3g} s are too long at t = {time:g} s: {name} has "
                f"ended {self.unresolved} steps far from where the one before led, now by "
                f"{track.missed / track.largest:.2g} of its largest value; use more "
                "steps_per_rev, or a tolerance"
            )
