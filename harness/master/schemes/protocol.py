"""What the master asks of a coupling scheme, and which one couples the units of a scene.

A scheme moves the coupled units (`system`) with these calls and no others: `rotor_pass` and
`balancer_pass` step them under cubics, `saved` and `restore` go back, the present signals are
`forces` and `accelerations`, and `accept` goes on with those of the finished step.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from ...errors import SceneError
from ...scene import Scene
from ...scene.run import UNCORRECTED
from ..loop import rotor_response
from ..system import System
from .adaptive import Adaptive
from .compensated import Compensated
from .gauss_seidel import GaussSeidel
from .iterated import Iterated
from .jacobi import Jacobi

WEAK_LOOP = 0.1  # one corrector pass then leaves 1 % of the prediction's error


class Scheme(Protocol):
    """A way to take one step with units that depend on each other.

    Attributes:
        name: as scenes call it.
        chooses_steps: whether it picks the length of its steps.
        startup_halvings: of a step that has no past to extrapolate.
        miss_per_error: by how much a prediction misses a step's end, over what the step errs itself
            on average; 0: no error is to be estimated from it.
    """

    name: str
    chooses_steps: bool
    startup_halvings: int
    miss_per_error: float

    def step(self, system: System, time: float, step: float, longest: float) -> tuple[float, float]:
        """Take one step; its length [s], and the residual of the forces over the largest so far.

        Args:
            step: its length, or where the scheme chooses that, the time to the next point that must
                be met [s].
            longest: step allowed to a scheme that chooses [s].

        Raises:
            SimulationError: a unit failed, or the coupling diverges.
        """
        ...

    def cross_jump(self, system: System, time: float, step: float) -> None:
        """A negligible step at a jump of the drive, where nothing of the past can be used."""
        ...

    def after_start(self, system: System, time: float, step: float) -> None:
        """Look at the loop once more, when the first step of this length has been divided."""
        ...

    def amplification(self, eigenvalues: Sequence[complex], order: int) -> float:
        """Largest factor by which short steps repeat a disturbance; stable up to 1.

        Args:
            eigenvalues: of the loop, force answered per force assumed.
            order: of the exchanged signals.
        """
        ...

    def allow_error(self, share: float) -> None:
        """From the start on, let a step err by this share of a tolerance, where there is one."""
        ...

    def judge(self, system: System, time: float, residual: float) -> bool:
        """Whether a step counts as converged.

        Raises:
            LoopError: what it left cannot be tolerated.
        """
        ...


def response_before(scene: Scene, system: System, step: float) -> np.ndarray:
    """What the scene's scheme knows of the rotor before its start: empty where it needs nothing."""
    if scene.coupling.scheme == Compensated.name:
        return rotor_response(system, step)
    return np.zeros((0, 0))


def choose(
    scene: Scene,
    system: System,
    jacobian: np.ndarray,
    response: np.ndarray,
    step: float,
    gain: float,
    rounding: float = 0.0,
) -> Scheme:
    """The scene's scheme; `auto` iterates, and no more than the loop gain asks for.

    Args:
        jacobian, response: from `loop.consistent_start` and `response_before` with `step` [s].
        gain: of the loop.
        rounding: of forces that cancel [N].
    """
    coupling = scene.coupling
    if coupling.scheme == Jacobi.name:
        return Jacobi()
    if coupling.scheme == GaussSeidel.name or not system.coupled:
        return GaussSeidel()
    if coupling.scheme == Compensated.name:
        return Compensated(jacobian, response, step, scene.profile().speed, system.order)
    if coupling.tolerance is not None:
        return Adaptive(
            Iterated(jacobian, step, system.order, rounding=rounding),
            coupling.tolerance,
            gain,
            float(scene.assembly().loaded_rotor.mass.sum()),
            bool(scene.rotor.friction),
            scene.slowest_rate,
        )
    corrections = coupling.corrections
    if corrections is None and coupling.scheme == "auto" and gain <= WEAK_LOOP:
        corrections = 1
    return Iterated(jacobian, step, system.order, corrections, rounding=rounding)


def refuse_loose_tolerance(scene: Scene) -> None:
    """Raise SceneError where a tolerance is asked of a scheme or an order that cannot keep it."""
    coupling = scene.coupling
    if coupling.tolerance is None:
        return
    if coupling.scheme in UNCORRECTED or coupling.order < 3:
        raise SceneError(
            f"{scene.name}: coupling.tolerance = {coupling.tolerance:g}: kept only by scheme "
            f'"iterated" or "auto" with order 3 or 5, not by "{coupling.scheme}" with order '
            f"{coupling.order}; give steps_per_rev instead"
        )
