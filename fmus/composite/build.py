"""Builder of composite FMUs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from ..build import COMPOSITION, native_contents, written
from ..native.build.compile import stamp
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
    files = {**_contents(composition, name, fmi, platforms), **(extra or {})}
    return written(files, destination, name)


def _contents(
    composition: Composition, name: str, fmi: int, platforms: Iterable[str] | None
) -> dict[str, bytes]:
    unit = composition.described(name)
    identify, can, models = (
        composition.identity,
        Capabilities(),
        dict.fromkeys(part.unit.unit for part in composition.parts),
    )
    files = native_contents(
        unit, name, identify, can, fmi, platforms, page(composition, name), tuple(models)
    )
    return {**files, COMPOSITION: composition.token(stamp()).encode()}
