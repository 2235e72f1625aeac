"""What the methods of a scene stand on."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

if TYPE_CHECKING:
    from autobalancer.harness.scene.scene import Scene


class OfScene:
    """A part of a scene's methods."""

    @property
    def _scene(self) -> Scene:
        """The scene itself.

        Raises:
            SceneError: it has units of others, which these methods know nothing of.
        """
        scene = cast("Scene", self)
        scene.refuse_guests("this")
        return scene
