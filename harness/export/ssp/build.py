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
from .documents import (
    FORMS,
    PARAMETERS,
    WITH_OUTPUTS,
    description,
    parameter_file,
    resource,
    with_outputs,
)
from .structure import coupled, separate


def build_ssp(
    scene: Scene,
    destination: Path,
    *,
    one_file: bool = False,
    slopes: bool = True,
    backend: str = "native",
    platforms: Iterable[str] | None = None,
    fmi: int = 2,
) -> Path:
    """Build the package of a scene: its units, one FMU an instance, or its composite FMU.

    Args:
        destination: the file.
        one_file: the composite, which couples by itself.
        slopes: whether slopes are connected beside the values.
        backend, platforms, fmi: of the FMUs, as `build` takes them; with 3 it is SSP 2.0.

    Returns:
        The file.

    Raises:
        SceneError: the scene cannot be expressed; the message says what.
        ValueError, NotCompiled, OSError: as `build`.
    """
    structure = coupled(scene) if one_file else separate(scene, slopes)
    files = {
        "SystemStructure.ssd": description(structure, FORMS[fmi]),
        WITH_OUTPUTS: with_outputs(structure, FORMS[fmi]),
        PARAMETERS: parameter_file(structure, FORMS[fmi]),
    }
    if backend == "python":
        refuse_native_only(scene)
    if one_file:
        with tempfile.TemporaryDirectory(prefix="autobalancer-") as folder:
            fmu = build_one_file(scene, Path(folder) / "one.fmu", fmi, platforms)
            files[resource(structure.elements[0])] = fmu.read_bytes()
    else:
        for unit, element in zip(plan(scene).units, structure.elements, strict=True):
            form: dict[str, Any] = {
                "backend": backend,
                "platforms": platforms,
                "fmi": fmi,
                **unit.sizes,
            }
            form |= {"start": element.start, "about": about(unit, scene)}
            made = contents(unit.model, **form)
            files[resource(element)] = zipped(made)
    write(destination, zipped(files))
    return destination
