"""What cubic springs, stops and free strokes change in answers about small motions, in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .scene import Scene


def about_restraints(scene: Scene) -> str:
    """How an answer about a linear rotor counts cubic springs, stops and free strokes, if any.

    >>> stop = {"gap": "5 mm", "stiffness": 2e5}
    >>> about_restraints(ab.load("two_balls").replace({"rotor.stops": [stop]}))[:49]
    'Small motions about rest: no stop is near: a bala'
    """
    if not (scene.rotor.is_restrained or scene.rotor.has_free_strokes):
        return ""
    sags, parts = bool(scene.operation.gravity), []
    if scene.rotor.cubic_stiffness and sags:
        parts.append("cubic springs count with their stiffness about the sag")
    elif scene.rotor.cubic_stiffness:
        parts.append("cubic springs have no stiffness there")
    touching = scene.touched_at_rest()
    if touching:
        names = ", ".join(f"rotor.stops[{k + 1}]" for k in touching)
        parts.append(f"the sag reaches {names}, which is left out: the answer does not hold")
    elif scene.rotor.stops:
        parts.append("no stop is near")
    if scene.rotor.has_free_strokes:
        parts.append("dampers rest within their free strokes")
    said = f"Small motions about {'the sag' if sags else 'rest'}: {'; '.join(parts)}"
    if scene.assembly().weights and not sags:
        said += (
            ": a balanced rotor does not move, so that its limits of stability are those without "
            "them, unchanged"
        )
    elif scene.balancer and not sags:
        said += ": the limits are those of small unbalance"
    return f"{said}."
