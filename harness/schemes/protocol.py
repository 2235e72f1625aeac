"""Which scheme couples the units of a scene."""

from __future__ import annotations

import numpy as np

from ..errors import SceneError
from ..master.system import System
from ..scene import Scene
from .adaptive import Adaptive
from .compensated import Compensated
from .gauss_seidel import GaussSeidel
from .iterated import Iterated
from .jacobi import Jacobi

WEAK_LOOP = 0.1  # one corrector pass then leaves 1 % of the prediction's error

Scheme = Jacobi | GaussSeidel | Compensated | Iterated | Adaptive


def scheme_for(
    scene: Scene,
    system: System,
    jacobian: np.ndarray,
    response: np.ndarray,
    step: float,
    gain: float,
) -> Scheme:
    """The scene's scheme; `auto` iterates, and no more than the loop gain asks for.

    Args:
        jacobian, response: from `loop.consistent_start` and `loop.rotor_response` with `step` [s].
        gain: of the loop.
    """
    coupling = scene.coupling
    if coupling.scheme == "jacobi":
        return Jacobi()
    if coupling.scheme == "gauss-seidel" or not system.exchanges:
        return GaussSeidel()
    if coupling.scheme == "compensated":
        return Compensated(jacobian, response, step, scene.profile().speed)
    if coupling.tolerance is not None:
        return Adaptive(Iterated(jacobian, step), coupling.tolerance, gain)
    corrections = coupling.corrections
    if corrections is None and coupling.scheme == "auto" and gain <= WEAK_LOOP:
        corrections = 1
    return Iterated(jacobian, step, system.order, corrections)


def refuse_loose_tolerance(scene: Scene) -> None:
    """Raise SceneError where a tolerance is asked of a scheme or an order that cannot keep it."""
    coupling = scene.coupling
    if coupling.tolerance is None:
        return
    if coupling.scheme in ("jacobi", "gauss-seidel", "compensated") or coupling.order != 3:
        raise SceneError(
            f"{scene.name}: coupling.tolerance = {coupling.tolerance:g}: kept only by scheme "
            f'"iterated" or "auto" with order 3, not by "{coupling.scheme}" with order '
            f"{coupling.order}; give steps_per_rev instead"
        )
