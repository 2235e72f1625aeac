"""What to do when weights that touch keep a step from converging."""

from __future__ import annotations

from ..scene import Scene
from ..scene.balancer import WeightBalancer


def contact_hint(scene: Scene) -> str:
    """Words to add to an error of the loop; empty where no weights can touch or stick.

    A collision, or a contact that opens or closes, makes the force jump within a step: no step is
    short enough for a tolerance, and corrector passes need not agree on whether it happens.
    """
    coupling = scene.coupling
    names = [
        balancer.label
        for balancer in scene.balancer
        if isinstance(balancer, WeightBalancer)
        and ((balancer.weight_radius and balancer.count > 1) or balancer.rolling_resistance)
    ]
    if not names or coupling.corrections is not None:
        return ""
    why = "corrector passes need not agree on it"
    if coupling.tolerance is not None:
        why = f"no step is short enough for tolerance = {coupling.tolerance:g}"
    return (
        f"; the weights of {', '.join(names)} can touch or stick: where one does, the force jumps "
        f"within the step, and {why}: give coupling.corrections (for example 4) with "
        "steps_per_rev instead, then such steps are counted and said"
    )
