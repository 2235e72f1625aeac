"""`Scene`: the description of a machine, with a method for everything that is done with one."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pydantic import Field

from autobalancer.harness.scene import scene as description
from autobalancer.harness.scene.nested import Nested

from .methods import Methods
from .tables import Rotor, Run


class Scene(Methods, description.Scene):
    """A validated scene.

    Make one with `load`, `Scene.from_document`, or `Scene(rotor={...}, operation={...})`.
    """

    rotor: Rotor
    """A table, by kind."""
    run: Nested[Run] = Field(default_factory=Run)
    """How long, from where, and what is recorded."""

    def _fill(self, document: dict[str, Any], path: Path | None, label: str) -> None:
        super()._fill(document, path, label)
        for table in (self.run, self.rotor):  # these are called
            table.__dict__["_scene"] = self


def load(source: str | Path) -> Scene:
    """Read a scene file, or a bundled scene by its name.

    Raises:
        SceneError: the file is missing, not TOML, or wrong; one line for every problem.

    >>> ab.load("drum").balancer[0].kind
    'balls'
    """
    return Scene.load(source)
