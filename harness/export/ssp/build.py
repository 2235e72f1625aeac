"""Builder of system structure packages."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from ....fmus.build import contents
from ....fmus.xml.archive import write, zipped
from ...master.plan import about, plan
from ...scene import Scene
from ..one_file import build_one_file
from ..python_units import refuse_native_only
from .documents import PARAMETERS, description, parameter_file, resource
from .structure import coupled, separate


def build_ssp(
    scene: Scene,
    destination: Path,
    *,
    one_file: bool = False,
    slopes: bool = True,
    backend: str = "native",
    platforms: Iterable[str] | None = None,
) -> Path:
    """Build the package of a scene: its units, one FMU an instance, or its composite FMU.

    Args:
        destination: the file.
        one_file: the composite, which couples by itself.
        slopes: whether slopes are connected beside the values.
        backend, platforms: of the FMUs, as `build` takes them.

    Returns:
        The file.

    Raises:
        SceneError: the scene cannot be expressed; the message says what.
        ValueError, NotCompiled, OSError: as `build`.
    """
    structure = coupled(scene) if one_file else separate(scene, slopes)
    files = {
        "SystemStructure.ssd": description(structure),
        PARAMETERS: parameter_file(structure),
    }
    if backend == "python":
        refuse_native_only(scene)
    if one_file:
        with tempfile.TemporaryDirectory(prefix="autobalancer-") as folder:
            fmu = build_one_file(scene, Path(folder) / "one.fmu", platforms=platforms)
            files[resource(structure.elements[0])] = fmu.read_bytes()
    else:
        for unit, element in zip(plan(scene).units, structure.elements, strict=True):
            form: dict[str, Any] = {"backend": backend, "platforms": platforms, **unit.sizes}
            form |= {"start": element.start, "about": about(unit, scene)}
            made = contents(unit.model, **form)
            files[resource(element)] = zipped(made)
    write(destination, zipped(files))
    return destination
