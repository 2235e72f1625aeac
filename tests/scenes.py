"""Bundled scenes by what drives them."""

from __future__ import annotations

from autobalancer.harness import bundled_scenes, load_scene


def driven_scenes() -> list[str]:
    """Those whose speed is known ahead, without stops: one piece and an SSP of separate units know
    no motor, and one piece no stops."""
    scenes = {name: load_scene(name) for name in bundled_scenes()}
    return [
        name
        for name, scene in scenes.items()
        if scene.operation.motor is None and not scene.rotor.stops
    ]
