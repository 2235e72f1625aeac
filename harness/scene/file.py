"""From a path or the name of a bundled scene to a TOML document."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from ..errors import SceneError
from .messages import did_you_mean

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

BUNDLED = Path(__file__).parent.with_name("scenes")
MOST_LEVELS = 20  # of tables and lists within one another; a scene has five
_POSITION = re.compile(r"^(?P<what>.*) \(at (?P<where>.*)\)$", re.DOTALL)


def bundled_scenes() -> list[str]:
    """Names of the scenes that come with the package."""
    return sorted(path.stem for path in BUNDLED.glob("*.toml"))


def find(source: str | Path) -> Path:
    """The file of a scene: a path, or the name of a bundled scene.

    Raises:
        SceneError: there is neither, or it is a directory.
    """
    path = Path(source)
    if path.is_file():
        return path
    names = bundled_scenes()
    if isinstance(source, str) and source.removesuffix(".toml") in names:
        return BUNDLED / f"{source.removesuffix('.toml')}.toml"
    if path.is_dir():
        raise SceneError(f"{path}: is a directory; a scene is a TOML file")
    if path.exists():
        raise SceneError(f"{path}: is not a file that can be read; a scene is a TOML file")
    raise SceneError(
        f"{source}: no such file, and no bundled scene of that name"
        f"{did_you_mean(str(source), names)}; bundled: {', '.join(names)}"
    )


def refuse_deep(document: Any, label: str) -> None:
    """Refuse what is nested deeper than any scene.

    Raises:
        SceneError: so it is.
    """
    level = [document]
    for _ in range(MOST_LEVELS):
        level = [inner for outer in level for inner in _inside(outer)]
    if level:
        raise SceneError(
            f"{label}: tables or lists more than {MOST_LEVELS} deep within one another: "
            "no key of a scene is that deep"
        )


def _inside(value: Any) -> Iterable[Any]:
    values = value.values() if isinstance(value, dict) else value
    return values if isinstance(value, (dict, list, tuple)) else ()


def read(path: Path) -> dict[str, Any]:
    """The document in a file.

    Raises:
        SceneError: it cannot be read, is not UTF-8, or is not TOML.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise SceneError(f"{path}: cannot be read: {error.strerror or error}") from error
    try:
        text = content.decode("utf-8-sig")  # editors on Windows put a byte-order mark first
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise SceneError(
            f"{path}: line {line}: byte 0x{content[error.start]:02x} is not UTF-8; "
            "save the file as UTF-8 text"
        ) from error
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        match = _POSITION.match(str(error))
        what, where = match.group("what", "where") if match else (str(error), "unknown place")
        raise SceneError(f"{path}: not TOML: {where}: {what}") from error
    except (RecursionError, ValueError) as error:
        raise SceneError(f"{path}: not a TOML file a scene can be read from: {error}") from error
