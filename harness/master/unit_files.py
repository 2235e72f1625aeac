"""The FMU file of every unit of a plan: found or built, of this build; what it declares."""

from __future__ import annotations

import atexit
import shutil
import tempfile
import threading
from collections.abc import Iterable, Mapping
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

import fmpy
from fmpy.model_description import ModelDescription

from ...fmus.build import build
from ...fmus.present import changed_files, is_present_build, opened, options_of
from ..errors import UnitError
from .names import readable
from .plan import UnitPlan
from .runtime import Backend, runtime

_BUILDING = threading.Lock()  # a unit is built once, however many threads want it


@cache
def _built(backend: Backend) -> Path:
    """Directory of the FMUs built by this process, removed when it ends."""
    directory = Path(tempfile.mkdtemp(prefix="autobalancer-units-"))
    atexit.register(shutil.rmtree, directory, ignore_errors=True)
    return directory


def find_or_build(
    units: Iterable[UnitPlan], fmus: Path | None = None, backend: Backend | None = None
) -> list[Path]:
    """The FMU file of every unit: found in `fmus`, or built once a process, for this machine.

    Args:
        backend: of those that are built; by default native ones where they can be had.

    Raises:
        UnitError: `fmus` is given and lacks a file, or has one of a different build.
    """
    if fmus is not None:
        return [_found(unit, fmus) for unit in units]
    backend = backend or runtime("native").backend
    platforms = [fmpy.platform_tuple] if backend == "native" else None
    with _BUILDING:
        paths = [(unit, _built(backend) / unit.file_name) for unit in units]
        for unit, path in paths:
            if not path.exists():
                try:
                    build(unit.model, path, backend=backend, platforms=platforms, **unit.sizes)
                except ValueError as error:  # without a library: what Python units do not compute
                    raise UnitError(f"{unit.name}: {error}") from None
    return [path for _, path in paths]


def _found(unit: UnitPlan, fmus: Path) -> Path:
    candidates = [fmus / f"{name}.fmu" for name in (unit.name, unit.file_name[:-4], unit.model)]
    for candidate in candidates:
        if candidate.is_file():
            refuse_other_build(candidate, unit)
            return candidate
    raise UnitError(
        f"{fmus}: no FMU for {unit.name!r}: expected {candidates[0].name} or "
        f"{candidates[2].name}; `autobalancer build -o {fmus} SCENE` makes them"
    )


def refuse_other_build(path: Path, unit: UnitPlan) -> None:
    """Raise UnitError where an FMU is not what this installation would build for a unit.

    An FMU of other sizes, or of older equations, would run along unseen, and a library that was
    damaged takes the process with it: nothing of the file is loaded before.
    """
    try:
        if is_present_build(path, unit.model, **unit.sizes):
            return
        built = options_of(path)
    except ValueError as error:
        raise UnitError(str(error)) from error
    except OSError as error:
        raise UnitError(f"{path}: cannot be read: {error.strerror or error}") from error
    raise UnitError(
        f"{path}: is of a different build than {unit.name!r} of this scene needs: "
        f"{_what_differs(path, unit, built)}; build it for this scene"
    )


def _what_differs(path: Path, unit: UnitPlan, built: Mapping[str, Any]) -> str:
    """Why an FMU is not what this installation would build for a unit."""
    version = opened(path)[1].get("fmiVersion", "")
    if not version.startswith("2."):
        return f"it is of FMI {version}, and separate units are coupled by FMI 2.0"
    if not built:
        return (
            "it is not from `autobalancer build`; units of others are coupled by a master of your "
            "own: the manual has one, how-to/fmi.md"
        )
    different = [
        f"{key} = {built[key]} instead of {value}"
        for key, value in {
            "unit": unit.model,
            "frame": "rotor",
            **unit.sizes,
        }.items()
        if key in built and built[key] != value
    ]
    if different:
        return f"it was built with {', '.join(different)}"
    changed = changed_files(path, unit.model, **unit.sizes)
    named = f" ({', '.join(changed[:3])}{' ...' if len(changed) > 3 else ''})" if changed else ""
    return f"its content is not what this installation builds{named}"


def described(path: Path) -> ModelDescription:
    """What an FMU declares; read once while the file stays as it is."""
    return _described(path, path.stat().st_mtime_ns)


@lru_cache(maxsize=64)
def _described(path: Path, _written: int) -> ModelDescription:
    return fmpy.read_model_description(str(path))


def measured_in(description: ModelDescription) -> dict[str, str]:
    """Unit of measurement of every variable as an FMU declares it; empty where it has none."""
    declared = {
        v.name: v.unit or getattr(v.declaredType, "unit", None) for v in description.modelVariables
    }
    return {name: readable(unit or "") for name, unit in declared.items()}
