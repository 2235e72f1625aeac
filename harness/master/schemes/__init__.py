"""Coupling schemes, one a file, and which one couples the units of a scene.

`Scheme.step(system, time, step)` moves the coupled units one step with these calls of `System` and
no others: `rotor_pass` and `balancer_pass` step them under cubics, `save` and `restore` go back,
the present signals are `forces` and `accelerations`, and `accept` goes on with those of the
finished step.
"""

from __future__ import annotations

import numpy as np

from ...scene import Scene
from ..limits import WEAK_LOOP
from ..system import System
from .compensated import Compensated
from .explicit import Scheme
from .gauss_seidel import GaussSeidel
from .iterated import Iterated
from .iterated_with_shaft import IteratedWithShaft
from .jacobi import Jacobi


def choose(
    scene: Scene,
    system: System,
    slopes: np.ndarray,
    step: float,
    gain: float,
    rounding: float = 0.0,
) -> Scheme:
    """The scene's scheme for units at their start; `auto` iterates as much as the gain asks for.

    Args:
        slopes: from `loop.consistent_start` with `step` [s].
        gain: of the loop.
        rounding: of forces that cancel [N].
    """
    coupling, count = scene.coupling, slopes.shape[1]  # rows of forces, then of accelerations
    if coupling.scheme == "jacobi":
        return Jacobi()
    if coupling.scheme == "gauss-seidel" or not system.coupled:
        return GaussSeidel()
    jacobian, response = slopes[:count], slopes[count:]
    if coupling.scheme == "compensated":
        return Compensated(jacobian, response, step, scene.profile().speed)
    corrections = coupling.corrections
    given = coupling.tolerance is None and corrections is None
    if given and coupling.scheme == "auto" and gain <= WEAK_LOOP:
        corrections = 1
    if system.shaft:
        return IteratedWithShaft(jacobian, step, system.order, corrections, rounding)
    return Iterated(jacobian, step, system.order, corrections, rounding)
