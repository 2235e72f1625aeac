"""What a run does without because its scene does not need it, known before anything is loaded."""

from __future__ import annotations

from collections.abc import Sequence

from ...fmus.catalogue import CATALOGUE
from ..scene import Scene
from ..scene.run import UNCORRECTED


def left_out(scene: Scene, recorded: Sequence[str], coupled: bool = True) -> list[str]:
    """In words.

    Args:
        recorded: signals of the record.
        coupled: whether separate FMUs run; in one piece none exchanges a signal.
    """
    motor = scene.operation.motor is not None
    present = {scene.rotor.model, *(balancer.model for balancer in scene.balancer)}
    present |= {"Motor"} if motor else set()
    notes = [f"{model} (none in the scene)" for model in CATALOGUE if model not in present]
    exchanging = any(balancer.exchanges_force for balancer in scene.balancer)
    coupling, profile = scene.coupling, scene.profile()
    if not exchanging:
        alone = "the liquid acts as added mass alone" if scene.balancer else "no balancer"
        notes += [f"force exchange ({alone})"]
        notes += [] if motor else ["corrector passes and rollback"]
    elif coupled and coupling.scheme in UNCORRECTED:
        notes.append("corrector passes and rollback (explicit scheme)")
    if coupled and exchanging and coupling.order < 3:
        notes.append("slopes of the signals" if coupling.order == 0 else "second derivatives")
    if not profile.changes and not motor:
        notes.append("variable speed")
    if scene.assembly().rotor.isotropic:
        notes.append("second axis of the rotor (isotropic: complex system of half the size)")
    if not recorded:
        notes.append("recording")
    return notes
