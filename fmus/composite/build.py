"""Builder of composite FMUs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from ..build import COMPOSITION, native_contents, written
from ..native.build.compile import stamp
from ..native.build.tokens import identity_of
from ..xml.description import Capabilities
from .composition import Composition
from .machine import page


def build_composite(
    composition: Composition,
    destination: Path | str,
    *,
    name: str,
    fmi: int = 2,
    platforms: Iterable[str] | None = None,
    extra: Mapping[str, bytes] | None = None,
) -> Path:
    """Build the FMU of coupled units.

    Args:
        composition: the units and their coupling.
        destination: folder (made when missing), or a file that ends in .fmu.
        name: model name and file name.
        fmi: 2 or 3.
        platforms: default: all.
        extra: more files, by their names in the FMU.

    Returns:
        The file.

    Raises:
        ValueError: an argument is not one of those allowed; the text names it.
        NotCompiled: a native library is not of the present sources, and there is no compiler.
        OSError: the file cannot be written; nothing is left behind.
    """
    text = composition.token(stamp())
    files = native_contents(
        composition.described(name),
        name,
        identity_of(text),
        Capabilities(interpolation=True),
        fmi,
        platforms,
        page(composition, name),
        tuple(dict.fromkeys(part.unit.unit for part in composition.parts)),
    )
    return written({**files, COMPOSITION: text.encode(), **(extra or {})}, destination, name)
