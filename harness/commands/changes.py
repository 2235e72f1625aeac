"""Values that a command line puts into a scene: `--set KEY=VALUE`.

Commands take them before anything heavy is loaded.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import typer

from ..errors import UserError
from ..scene.changes import parse_change

if TYPE_CHECKING:
    from ..api.scene import Scene
    from ..scene.scene import Scene as Description

AnyScene = TypeVar("AnyScene", bound="Description")


def changed_scene(source: str, changes: list[str] | None, quietly: bool = False) -> Scene:
    """The scene of a file or name, with every --set KEY=VALUE put in its place.

    Unless `quietly`, what was understood is printed, with warnings of implausible values.

    Raises:
        UserError: the scene is wrong, or a change is.
    """
    from autobalancer.scene import load

    from ..scene.plausible import tell, tell_warning

    scene: Scene = with_changes(load(source), changes)
    if not quietly:
        tell(scene)
        if scene.name == source and Path(f"{source}.toml").is_file():
            tell_warning(f"{source}: is the bundled scene; write {source}.toml for the file here")
    return scene


def with_changes(scene: AnyScene, changes: list[str] | None) -> AnyScene:
    """The scene with every KEY=VALUE put in its place.

    Raises:
        UserError: a change is wrong.
    """
    return scene.replace(dict(map(parse_change, changes))) if changes else scene


def _settings(texts: list[str] | None) -> list[str] | None:
    """Refuse what is no KEY=VALUE before the words after it are refused as further arguments."""
    keys = [parse_change(text)[0] for text in texts or ()]
    if twice := next((key for key in keys if keys.count(key) > 1), ""):
        raise UserError(f"--set {twice}: given {keys.count(twice)} times; give it once")
    return texts


def set_option(example: str) -> Any:
    """`--set KEY=VALUE`, any number of times."""
    help = f"Replace a value: {example}"
    return typer.Option("--set", metavar="KEY=VALUE", help=help, callback=_settings)
