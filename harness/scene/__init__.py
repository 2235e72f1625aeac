"""What a user writes: scene files, validated."""

from typing import TYPE_CHECKING

from ...fmus.lazy import lazy_names

if TYPE_CHECKING:
    from .file import bundled_scenes
    from .scene import Scene, load_scene

__all__ = ["Scene", "bundled_scenes", "load_scene"]
__getattr__, __dir__ = lazy_names(
    __name__, {"Scene": ".scene", "bundled_scenes": ".file", "load_scene": ".scene"}
)
