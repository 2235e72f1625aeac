"""Whether an FMU file is of the present sources, and what it was built as."""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from fmpy import platform, platform_tuple

from .build import COMPOSITION, DESCRIPTION, content_guid, contents
from .catalogue import sized_unit
from .native.build.compile import libraries, stamp
from .native.build.package import holds_universal
from .native.build.tokens import identity_of, token
from .python.resources import START
from .xml.archive import unzipped
from .xml.description import options_in


def is_present_build(path: Path | str, unit: str, **options: Any) -> bool:
    """Whether an FMU file is what `build` writes from the present sources, either backend.

    Start values and description may be those of any scene, and other platforms' libraries any.

    Raises:
        ValueError: the file is not an FMU.
        OSError: it cannot be read.
    """
    files, root = opened(path)
    text = files.get(COMPOSITION, b"").decode()
    if any(name.startswith("resources/") for name in files) and not text:
        return _is_present_python(files, root.get("guid") or "", unit, options)
    library = libraries([platform_tuple])[platform_tuple].read_bytes()
    places = tuple(f"binaries/{folder}/" for folder in (platform, platform_tuple))
    found = [data for name, data in files.items() if name.startswith(places)]
    if library not in found and not any(holds_universal(data, library) for data in found):
        return False
    if text:
        own = f"{token(sized_unit(unit, **options), stamp())};"
        return text.startswith(own) and root.get("guid") == identity_of(text)
    return files[DESCRIPTION] == contents(unit, **options)[DESCRIPTION]


def _is_present_python(
    files: Mapping[str, bytes], guid: str, unit: str, options: Mapping[str, Any]
) -> bool:
    """The same of a Python FMU: nothing in it was changed, and its sources are the present ones."""
    draft = files[DESCRIPTION].replace(f'guid="{guid}"'.encode(), b'guid=""')
    as_built = content_guid({**files, DESCRIPTION: draft}) == guid
    return as_built and not _other_files(files, contents(unit, backend="python", **options))


def _other_files(files: Mapping[str, bytes], present: Mapping[str, bytes]) -> list[str]:
    """Names of files that differ, other than those that say what a scene is."""
    of_scene = {DESCRIPTION, f"resources/{START}", "documentation/index.html"}
    return sorted(n for n in {*files, *present} - of_scene if files.get(n) != present.get(n))


def changed_files(path: Path | str, unit: str, **options: Any) -> list[str]:
    """Names of files in a Python FMU that are not those of the present build; else nothing.

    Raises:
        ValueError: the file is not an FMU.
        OSError: it cannot be read.
    """
    files, _ = opened(path)
    if "resources/slavemodule.txt" not in files:
        return []
    return _other_files(files, contents(unit, backend="python", **options))


def options_of(path: Path | str) -> dict[str, Any]:
    """What an FMU file was built as, by its model description: its options, and `unit`, its name.

    Empty for an FMU that `build` did not write.

    Raises:
        ValueError: the file is not an FMU.
        OSError: it cannot be read.
    """
    return options_in(opened(path)[1])


def opened(path: Path | str) -> tuple[dict[str, bytes], ElementTree.Element]:
    """Files of an FMU, and its model description."""
    try:
        files = unzipped(path)
        root = ElementTree.fromstring(files[DESCRIPTION])
        if root.tag != "fmiModelDescription":
            raise KeyError(f"{DESCRIPTION} begins with {root.tag}")
    except (zipfile.BadZipFile, KeyError, ElementTree.ParseError) as error:
        raise ValueError(
            f"{path}: not an FMU ({error}); copy, download or build the file again"
        ) from None
    return files, root
