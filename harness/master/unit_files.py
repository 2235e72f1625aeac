"""The FMU file of every unit of a plan: found or built, of this build; what it declares."""

from __future__ import annotations

import atexit
import shutil
import tempfile
import threading
from collections.abc import Iterable
from functools import cache, lru_cache
from pathlib import Path
from typing import NamedTuple

import fmpy
from fmpy.model_description import ModelDescription

from ...fmus.build import build
from ...fmus.present import changed_files, is_present_build, opened, options_of
from ..errors import UnitError
from ..scene.unit import fmu_path
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


def _candidate(unit: UnitPlan, fmus: Path) -> Path:
    candidates = [fmus / f"{name}.fmu" for name in (unit.name, unit.file_name[:-4], unit.model)]
    for candidate in candidates:
        if candidate.is_file():
            return candidate
    raise UnitError(
        f"{fmus}: no FMU for {unit.name!r}: expected {candidates[0].name} or "
        f"{candidates[2].name}; `autobalancer build -o {fmus} SCENE` makes them"
    )


def _found(unit: UnitPlan, fmus: Path) -> Path:
    path = _candidate(unit, fmus)
    if reason := _difference(path, unit):
        raise UnitError(f"{path}: is not what this installation builds: {reason}")
    return path


class Found(NamedTuple):
    """The file of a part.

    Attributes:
        is_own: whether this installation would build it as it is.
        reason: how it differs; empty where the scene names it.
    """

    unit: UnitPlan
    path: Path
    is_own: bool
    reason: str = ""


def find_parts(
    units: Iterable[UnitPlan], fmus: Path | None, backend: Backend, scene: Path | None
) -> list[Found]:
    """The file of every part: named by the scene, found in `fmus`, or built.

    Args:
        scene: file of the scene, from whose folder it names others.

    Raises:
        UnitError: a file is missing, is no FMU, or was built for parts of other sizes.
    """
    found = []
    for unit in units:
        if unit.fmu:
            found.append(Found(unit, fmu_path(unit.fmu, scene), False))
        elif fmus is not None:
            path = _candidate(unit, fmus)
            reason = _difference(path, unit)
            found.append(Found(unit, path, not reason, reason))
        else:
            found.append(Found(unit, find_or_build([unit], None, backend)[0], True))
    return found


def has_strangers(units: Iterable[UnitPlan], fmus: Path | None) -> bool:
    """Whether a folder of FMUs has one for a part that this installation would not build so.

    Raises:
        UnitError: as `find_parts`.
    """
    if fmus is None:
        return False
    return any(_difference(_candidate(unit, fmus), unit) for unit in units if not unit.fmu)


def _difference(path: Path, unit: UnitPlan) -> str:
    """How an FMU differs from what this installation would build for a unit; empty: not at all.

    Raises:
        UnitError: it is no FMU, or of other sizes: it would run along unseen.
    """
    try:
        if is_present_build(path, unit.model, **unit.sizes):
            return ""
        built = options_of(path)
    except ValueError as error:
        raise UnitError(str(error)) from error
    except OSError as error:
        raise UnitError(f"{path}: cannot be read: {error.strerror or error}") from error
    asked = {"unit": unit.model, "frame": "rotor", **unit.sizes}
    different = [
        f"{key} = {built[key]} instead of {value}"
        for key, value in asked.items()
        if key in built and built[key] != value
    ]
    if different:
        raise UnitError(
            f"{path}: is of a different build than {unit.name!r} of this scene needs: it was "
            f"built with {', '.join(different)}; build it for this scene"
        )
    version = opened(path)[1].get("fmiVersion", "")
    if not built:
        return "not from `autobalancer build`"
    if not version.startswith("2."):
        return f"of FMI {version}"
    changed = changed_files(path, unit.model, **unit.sizes)
    if not changed:
        return "its content is not what this installation builds"
    return f"changed: {', '.join(changed[:3])}{' ...' if len(changed) > 3 else ''}"


def described(path: Path) -> ModelDescription:
    """What an FMU declares; read once while the file stays as it is."""
    return _described(path, path.stat().st_mtime_ns)


@lru_cache(maxsize=64)
def _described(path: Path, _written: int) -> ModelDescription:
    return fmpy.read_model_description(str(path))
