"""What every scene file has: a title, its numbers' source, and the document it was made of."""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from pydantic import PrivateAttr

from ..errors import SceneError
from .file import read, refuse_deep
from .quantities import Table, Text
from .replace import plain

if TYPE_CHECKING:
    from typing_extensions import Self

Made = TypeVar("Made")
_MADE = "_made"  # by `once`; what begins with _ is no key


class Described(Table):
    """A validated document: a scene with a rotor, or a system of units."""

    title: Text = ""
    """For tables and pictures; default: the file's name."""
    source: Text = ""
    """Where the scene's numbers come from, for tables."""

    _document: dict[str, Any] = PrivateAttr(default_factory=dict)
    _path: Path | None = PrivateAttr(default=None)
    _label: str = PrivateAttr(default="scene")

    @classmethod
    def from_document(
        cls, document: Mapping[str, Any], *, path: Path | None = None, label: str = "scene"
    ) -> Self:
        """Validate a document as `tomllib` gives it.

        Args:
            path: file it came from.
            label: what messages call it.

        Raises:
            SceneError: one line for every problem there is.

        >>> ab.Scene.from_document(ab.load("drum").document) == ab.load("drum")
        True
        """
        refuse_deep(document, label)
        return cls._of(plain(document), path, label)

    @classmethod
    def _of(cls, document: dict[str, Any], path: Path | None, label: str) -> Self:
        """The scene of a document that nobody else can change."""
        scene = cls.__new__(cls)
        scene._fill(document, path, label)
        return scene

    def _fill(self, document: dict[str, Any], path: Path | None, label: str) -> None:
        """Validate a document into this object."""
        raise NotImplementedError

    def once(self, make: Callable[[Self], Made]) -> Made:
        """What a function makes of the scene, made when it is first asked for: no scene changes.

        >>> ab.load("two_balls").once(lambda scene: scene.rotor.mass)
        0.95
        """
        made: dict[Any, Any] = self.__dict__.setdefault(_MADE, {})
        if make not in made:
            made[make] = make(self)
        return made[make]

    def __getstate__(self) -> dict[Any, Any]:
        state = super().__getstate__()  # what was made is made again
        state["__dict__"] = {k: v for k, v in state["__dict__"].items() if k != _MADE}
        return state

    @property
    def path(self) -> Path | None:
        """File the scene was read from."""
        return self._path

    @property
    def label(self) -> str:
        """What messages call the scene: the file or name as it was given."""
        return self._label

    @property
    def name(self) -> str:
        """Short name: the file's stem."""
        return self._path.stem if self._path else self._label

    @property
    def document(self) -> dict[str, Any]:
        """What the scene was made from, as a TOML file would say it."""
        return copy.deepcopy(self._document)

    @property
    def toml(self) -> str:
        """As a file says it: in its own words where nothing was replaced."""
        from tomli_w import dumps

        with suppress(SceneError, OSError):  # the file may have changed since
            if self._path is not None and read(self._path) == self._document:
                return self._path.read_text(encoding="utf-8-sig")
        return dumps(self._document)

    def save(self, path: str | Path) -> Path:
        """Write the scene as a TOML file, from which `load` makes an equal one.

        Raises:
            UserError: the file cannot be written.

        >>> drum = ab.load("drum").replace({"speed": "900 rpm"})
        >>> path = drum.save("slow_drum.toml")
        >>> ab.load("slow_drum.toml") == drum
        True
        """
        from ..output.files import write_whole

        with write_whole(Path(path)) as stream:
            stream.write(self.toml)
        return Path(path)

    @property
    def heading(self) -> str:
        """What tables and pictures call the scene: its title, else its name."""
        return self.title or self.name
