"""Bundled scenes by what drives them."""

from __future__ import annotations

from autobalancer.harness import bundled_scenes, load_scene


def driven_scenes() -> list[str]:
    """Those whose speed is known ahead: one piece and an SSP of separate units know no motor."""
    return [name for name in bundled_scenes() if load_scene(name).operation.motor is None]
