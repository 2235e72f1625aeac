"""Scenes that differ in numbers alone, which run together in C."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ..errors import UserError
from ..master.one_file import drive
from ..master.plan import Plan, plan
from ..scene import Scene
from ..scene.replace import SPEED, in_full

_DRIVE = ("speed", "acceleration")  # of the composite, which tells its units


def table_of(scenes: Sequence[Scene]) -> dict[str, list[float]]:
    """By the composite's names, the values in which scenes differ; where they do not, one of them.

    Args:
        scenes: at least one; the same units, connections, coupling and revolutions, and the same
            run-up where there is one.

    Raises:
        UserError: they differ in more than numbers.
    """
    first, plans = scenes[0], [plan(scene) for scene in scenes]
    common = _common(first, plans[0])
    if any(_common(*pair) != common for pair in zip(scenes, plans, strict=True)):
        raise UserError(
            f"{first.label}: only numbers of the rotor, the balancers and the motor, run.initial, "
            "gravity and a constant speed may differ between runs in C"
        )
    starts = [values_of(*pair) for pair in zip(scenes, plans, strict=True)]
    changed = [name for name in starts[0] if any(s[name] != starts[0][name] for s in starts)]
    return {name: [s[name] for s in starts] for name in changed or list(starts[0])[:1]}


def refuse_unvaried(scene: Scene, path: str) -> None:
    """Refuse a path in whose values runs of one table cannot differ.

    Raises:
        UserError: it is one.
    """
    balancers = [balancer.label for balancer in scene.balancer]
    holders = ["rotor", *balancers, *scene.body_names]
    allowed = (*(f"{holder}." for holder in holders), "run.initial.")
    allowed += ("operation.gravity", "operation.unbalance_changes")
    if scene.operation.motor:
        allowed += ("operation.motor.",)
    full = in_full(path, scene.body_names)
    if full != SPEED and not full.startswith(allowed):
        raise UserError(
            f"{path}: cannot be varied; must be speed or begin with one of: {', '.join(allowed)}"
        )


def _common(scene: Scene, found: Plan) -> Any:
    profile = scene.profile()
    units = [(unit.name, unit.model, unit.sizes) for unit in found.units]
    changing = profile if profile.changes else None
    many = len(scene.operation.unbalance_changes)
    return (
        units,
        found.connections,
        scene.coupling,
        scene.run.duration or scene.run.revolutions,
        changing,
        many,
    )


def values_of(scene: Scene, found: Plan) -> dict[str, float]:
    """Start values of a scene with its plan, by the composite's names."""
    values = {
        f"{unit.name}.{name}": float(value)
        for unit in found.units
        for name, value in unit.start.items()
        if name not in _DRIVE
    }
    return values | drive(scene)
