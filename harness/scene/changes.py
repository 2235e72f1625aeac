"""Values that a command line puts into a scene: --set KEY=VALUE.

Commands take them before anything heavy is loaded.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import UserError

if TYPE_CHECKING:
    from .scene import Scene

_LONGEST_SHOWN = 200  # characters of what was typed


def changed_scene(scene: str | Scene, changes: list[str] | None, quietly: bool = False) -> Scene:
    """The scene, or that of a file or name, with every --set KEY=VALUE put in its place.

    Unless `quietly`, what was understood is printed, with warnings of implausible values.

    Raises:
        UserError: the scene is wrong, or a change is.
    """
    from .plausible import tell, tell_warning
    from .scene import load_scene

    loaded = load_scene(scene) if isinstance(scene, str) else scene
    loaded = loaded.replace(dict(map(parse_change, changes))) if changes else loaded
    if not quietly:
        tell(loaded)
        if isinstance(scene, str) and loaded.name == scene and Path(f"{scene}.toml").is_file():
            tell_warning(f"{scene}: is the bundled scene; write {scene}.toml for the file here")
    return loaded


def parse_change(text: str) -> tuple[str, Any]:
    """'rotor.unbalance=0.1' as key and value, the value as TOML writes it, or with a unit.

    Raises:
        UserError: there is no '=', or what follows is not a value.
    """
    from ..units import has_unit
    from .file import tomllib

    key, equals, value = (part.strip() for part in text.partition("="))
    if key and has_unit(value):
        return key, value
    try:
        if not (key and equals and value):
            raise ValueError
        document = tomllib.loads(f"value = {value}")
        if document.keys() != {"value"}:  # a line break, and an assignment after it
            raise ValueError
        return key, document["value"]
    except (ValueError, RecursionError) as error:
        shown = text if len(text) <= _LONGEST_SHOWN else f"{text[:_LONGEST_SHOWN]}..."
        raise UserError(
            f"--set {' '.join(shown.splitlines())}: must be KEY=VALUE with one value as in "
            "a scene file, such as rotor.unbalance=0.1, speed=1200rpm or "
            "'coupling.scheme=\"jacobi\"'"
        ) from error
