"""From a path or the name of a bundled scene to a TOML document."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from ..errors import SceneError
from ..input_files import read_text
from .messages import did_you_mean

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

BUNDLED = Path(__file__).parent.with_name("scenes")
MOST_LEVELS = 20  # of tables and lists within one another; a scene has five
LARGEST_FILE = 10_000_000  # bytes; the longest bundled scene has three thousand
COMMANDS_OF = {  # files that are no scene: what does something with them
    ".fmu": "is an FMU, and a scene is a TOML file: `autobalancer run FILE.fmu` runs it alone, "
    "[[unit]] in a scene connects it, and `run SCENE --fmus DIR` uses it as a part",
    ".ssp": "is an SSP, and a scene is a TOML file: `autobalancer run FILE.ssp` runs it",
}
_POSITION = re.compile(r"^(?P<what>.*) \(at (?P<where>.*)\)$", re.DOTALL)
_TWICE = re.compile(r"Cannot overwrite a value|Cannot declare .* twice")
_REPAIRS: tuple[tuple[str, str | Callable[[re.Match[str]], str]], ...] = (
    # of a line that is not TOML, each on top of those before
    (r"^(\s*[\w.-]+)\s*:", r"\1 ="),  # as in YAML
    (r"(\d),(\d)", r"\1.\2"),  # decimal comma
    (r"(?<![\w.])\.(\d)", r"0.\1"),
    (r"(\d)\.(?!\d)", r"\1.0"),
    (r"=\s*(?:True|False)\b", lambda match: match[0].lower()),
    (r"=\s*([A-Za-z][\w -]*?)(\s*(?:#.*)?)$", r'= "\1"\2'),  # text without quotes
    (r"=\s*([-+\d.e]*\d\s*[A-Za-zµ°%][^#=]*?)(\s*(?:#.*)?)$", r'= "\1"\2'),  # with a unit
)
_LONGEST_SHOWN = 200  # characters of a line


def bundled_scenes() -> list[str]:
    """Names of the scenes that come with the package.

    >>> "two_balls" in ab.bundled_scenes()
    True
    """
    return sorted(path.stem for path in BUNDLED.glob("*.toml"))


def _meant_beside(path: Path) -> str:
    """' (did you mean ...?)', a scene file in the folder of a path that does not exist; or nothing.

    Of the names alone: endings and folders are alike.
    """
    names = {other.stem: str(path.parent / other.name) for other in path.parent.glob("*.toml")}
    return did_you_mean(path.stem, list(names), lambda stem: names[stem])


def find(source: str | Path) -> Path:
    """The file of a scene: a path, or the name of a bundled scene.

    Raises:
        SceneError: there is neither, or it is a directory.
    """
    path = Path(source)
    if path.is_file() and path.suffix in COMMANDS_OF:
        raise SceneError(f"{path}: {COMMANDS_OF[path.suffix]}")
    if path.is_file():
        return path
    names = bundled_scenes()
    if isinstance(source, str) and source.removesuffix(".toml") in names:
        return BUNDLED / f"{source.removesuffix('.toml')}.toml"
    if path.is_dir():
        raise SceneError(f"{path}: is a directory; a scene is a TOML file")
    if path.exists():
        raise SceneError(f"{path}: is not a file that can be read; a scene is a TOML file")
    if path.suffix or path.name != str(source):
        raise SceneError(f"{source}: no such file{_meant_beside(path)}")
    raise SceneError(
        f"{source}: no such file, and no bundled scene of that name"
        f"{did_you_mean(str(source).lower(), names)}; bundled: {', '.join(names)}"
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
        SceneError: it cannot be read, is too large, is not UTF-8, or is not TOML.
    """
    if path.is_file() and (size := path.stat().st_size) > LARGEST_FILE:
        raise SceneError(f"{path}: has {size} bytes; a scene has at most {LARGEST_FILE}")
    text = read_text(path, SceneError)
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        match = _POSITION.match(str(error))
        what, where = match.group("what", "where") if match else (str(error), "unknown place")
        if _TWICE.match(what):
            what = "given a second time; keep one of the two"
        lines = text.split("\n")  # as it counts them
        if number := re.match(r"line (\d+)", where):
            what += f": {_shown(lines[int(number[1]) - 1])}"
        raise SceneError(f"{path}: not TOML: {where}: {what}") from error
    except (RecursionError, ValueError) as error:
        raise SceneError(f"{path}: not a TOML file a scene can be read from: {error}") from error


def _shown(line: str) -> str:
    """A line that is not TOML, and what was probably meant."""
    meant = line = line.strip()[:_LONGEST_SHOWN]
    for pattern, instead in _REPAIRS:
        before, meant = meant, re.sub(pattern, instead, meant)
        if meant != before and _is_toml(meant):
            return f"{line} (did you mean {meant}?)"
    return line


def _is_toml(text: str) -> bool:
    try:
        return bool(tomllib.loads(text))
    except ValueError:
        return False


def is_system(document: Mapping[str, Any]) -> bool:
    """Whether a document is one of units and connections alone."""
    return "rotor" not in document and "unit" in document


def names_system(source: str | Path) -> bool:
    """Whether a path is that of a system of units: an FMU, an SSP, or a file without a rotor.

    Raises:
        SceneError: there is no such file, or it is not TOML.
    """
    path = Path(source)
    if path.is_file() and path.suffix in COMMANDS_OF:
        return True
    return is_system(read(find(source)))
