"""Signals that vary faster than the communication steps: said loudly instead of computed wrongly.

With steps given by the scene nothing else would notice: the loop converges, and the cubics between
the communication points miss what happens there.  The cubic of the step before, extrapolated to the
end of this one, misses a resolved signal by little (`schemes.adaptive` has the estimate).
"""

from __future__ import annotations

from .errors import SimulationError
from .scene import Scene
from .signals import Cubic, End, end_of, extrapolated
from .system import System, Track

UNRESOLVED = 0.05  # of the largest value so far: error of a cubic within one step, as estimated
NOISE = 1e-9  # of what all weights together can pull: below it a signal is cancellation
_PART = 120.0  # the prediction's miss over the error of the step's own cubic, steps being equal


class Resolution:
    """Watches the cubic signals of a run whose steps are given.

    Args:
        scene: whose weights set the size below which signals are noise.
        system: the coupled units.
    """

    def __init__(self, scene: Scene, system: System) -> None:
        assembly, profile = scene.assembly(), scene.profile()
        pull = assembly.capacity * max(profile.start, profile.end) ** 2
        mass = float(assembly.loaded_rotor.mass.sum())
        self._tracks: list[Track] = [c.force for c in system.connections] + system.accelerations
        self._names = [f"{c.unit.name}.F" for c in system.connections]
        self._names += [f"rotor.plane[{p}].a" for p in system.connected]
        forces, motions = len(system.connections), len(system.accelerations)
        self._largest = [NOISE * pull] * forces + [NOISE * pull / mass] * motions
        self._before: list[tuple[End, Cubic, float]] = []

    def before(self) -> None:
        """Remember the signals at the start of a step."""
        self._before = [(track.now, track.past, track.past_step) for track in self._tracks]

    def after(self, time: float, step: float) -> None:
        """Compare them with what the step made of them.

        Raises:
            SimulationError: a signal is not resolved.
        """
        for k, ((now, past, past_step), track) in enumerate(
            zip(self._before, self._tracks, strict=True)
        ):
            value = track.now[0]
            largest = self._largest[k] = max(self._largest[k], abs(value))
            if past_step != step:
                continue  # after a start, a jump, or a change of step there is nothing to compare
            missed = abs(value - end_of(extrapolated(now, past, step, 3), step)[0])
            if missed > UNRESOLVED * _PART * largest:
                raise SimulationError(
                    f"communication steps of {step:.3g} s are too long at t = {time:g} s: "
                    f"{self._names[k]} is {missed / largest:.2g} of its largest value away from "
                    "where the last step was leading it; use more steps_per_rev, or a tolerance"
                )
