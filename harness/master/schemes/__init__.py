"""Coupling schemes, one a file, and which one couples the units of a scene.

`Scheme.step(system, time, step)` moves the coupled units one step with these calls of `System` and
no others: `rotor_pass` and `balancer_pass` step them under cubics, `save` and `restore` go back,
the present signals are `forces` and `accelerations`, and `accept` goes on with those of the
finished step.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from ....models.constants import WEAK_LOOP
from ...scene import Scene
from ..loop import rotor_response
from ..system import System
from .compensated import Compensated
from .explicit import Explicit
from .gauss_seidel import GaussSeidel
from .iterated import Iterated
from .jacobi import Jacobi

Scheme: TypeAlias = Explicit | Iterated


def choose(
    scene: Scene,
    system: System,
    jacobian: np.ndarray,
    step: float,
    gain: float,
    rounding: float = 0.0,
) -> Scheme:
    """The scene's scheme for units at their start; `auto` iterates as much as the gain asks for.

    Args:
        jacobian: from `loop.consistent_start` with `step` [s].
        gain: of the loop.
        rounding: of forces that cancel [N].
    """
    coupling = scene.coupling
    if coupling.scheme == Jacobi.name:
        return Jacobi()
    if coupling.scheme == GaussSeidel.name or not system.coupled:
        return GaussSeidel()
    if coupling.scheme == Compensated.name:
        response = rotor_response(system, step)
        return Compensated(jacobian, response, step, scene.profile().speed)
    corrections = coupling.corrections
    given = coupling.tolerance is None and corrections is None
    if given and coupling.scheme == "auto" and gain <= WEAK_LOOP:
        corrections = 1
    return Iterated(jacobian, step, system.order, corrections, rounding)
