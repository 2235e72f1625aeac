"""What the page saves as a scene file: the document of a scene, and its keys that sliders set."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from typing import Any

from ..scene import Scene

Key = tuple[list[str | int], Any]  # where a value stands in the document, and what it is [SI]


def document(scene: Scene) -> dict[str, Any]:
    """The scene without its checks, with damping in place of a damping ratio."""
    found = scene.document
    found.pop("check", None)
    if found["rotor"].pop("damping_ratio", None) is not None:
        key = _of_supports(scene, "damping")
        found["rotor"][key] = getattr(scene.rotor, key)
    return found


def keys_of(scene: Scene, label: str, tracks: Collection[str], moment: float) -> Iterator[Key]:
    """Keys that a slider multiplies, with the values that factor 1 stands for.

    Args:
        label: of the slider.
        tracks: labels of the balancers whose weights it changes.
        moment: unbalance of a rotor that has none [kg m].
    """
    rotor, motor = scene.rotor, scene.operation.motor
    word = label.partition(" ")[0].lower()
    if word == "torque" and motor:
        if motor.stall_torque is not None:
            yield ["operation", "motor", "stall_torque"], motor.stall_torque
        for k, (_, torque) in enumerate(motor.table):
            yield ["operation", "motor", "table", k, 1], torque
    elif word == "unbalance" and rotor.kind == "planar":
        yield ["rotor", "unbalance"], rotor.unbalance or moment
    elif word == "unbalance":
        bare = not any(u.amount for u in rotor.unbalances)
        for k, unbalance in enumerate(rotor.unbalances):
            yield ["rotor", "unbalances", k, "amount"], moment if bare else unbalance.amount
    elif word in ("stiffness", "damping"):
        key = _of_supports(scene, word)
        yield ["rotor", key], getattr(rotor, key)
    else:
        for k, balancer in enumerate(scene.balancer):
            if balancer.label in tracks:
                yield ["balancer", k, word], getattr(balancer, word)


def _of_supports(scene: Scene, key: str) -> str:
    """The key of a value of the supports, by the kind of the rotor."""
    return f"support_{key}" if scene.rotor.kind == "flexible" else key
