"""FMU files of a scene, or of every unit: single ones, one that couples them, or an SSP."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...fmus.catalogue import CATALOGUE
from ..errors import UserError, is_own_file
from ..output.outcome import Outcome
from ..output.table import Sheet
from ..output.terminal import ready_to_fill, ready_to_write
from ..output.workers import Progress
from ..scene import Scene


@dataclass(frozen=True, repr=False)
class Built(Outcome):
    """Files that were written.

    Attributes:
        files: their paths.
        rows: what is in each, below `heads`.
        left_out: units that the scene does without.
    """

    title: str
    heads: tuple[str, ...]
    files: tuple[Path, ...]
    rows: tuple[tuple[str, ...], ...]
    left_out: tuple[str, ...] = ()

    def table(self) -> Sheet:
        """A line for every file, with its size."""
        rows = [
            (str(path), *row, f"{path.stat().st_size / 1000:.0f}")
            for path, row in zip(self.files, self.rows, strict=True)
        ]
        align = "l" * (len(self.heads) + 1) + "r"
        return Sheet(("file", *self.heads, "kB"), rows, align, self.title)


def build_files(
    scene: Scene | None,
    output: Path,
    fmi: int = 2,
    platforms: list[str] | None = None,
    *,
    python: bool = False,
    one_file: bool = False,
    ssp: bool = False,
    plain: bool = False,
    flat: bool = False,
    reference: bool = False,
    progress: Progress | None = None,
) -> Built:
    """See `Scene.build`; without a scene, every unit there is.

    >>> from pathlib import Path
    >>> len(ab.build_files(None, Path("units"), platforms=["x86_64-linux"]).files)
    5
    """
    if (plain or flat or reference) and (ssp or not one_file):
        raise UserError("--plain, --flat-names, --reference: give --one-file and leave out --ssp")
    kind = ".ssp" if ssp else ".fmu" if one_file else ""
    if output.suffix in (".fmu", ".ssp") and output.suffix != kind:
        file = f", or a file that ends in {kind}" if kind else ""
        raise UserError(f"{output}: must be a folder{file}; --one-file writes an FMU, --ssp an SSP")
    form: dict[str, Any]
    if ssp:
        if scene is None or (python and (one_file or fmi != 2)):
            raise UserError(
                "--ssp: give a scene, and with --python neither --one-file nor --fmi 3: Python "
                "units are separate ones of FMI 2.0"
            )
        form = {"backend": "python" if python else "native", "platforms": platforms, "fmi": fmi}
        return _build_ssp(scene, output, one_file, form)
    if one_file:
        if scene is None:
            raise UserError("--one-file: give the scene whose units are to be coupled")
        if python:
            raise UserError("--one-file: has no Python units; leave out --python")
        form = {"fmi": fmi, "platforms": platforms, "plain": plain, "flat": flat}
        form |= {"reference": reference, "progress": progress}
        return _build_one_file(scene, output, form)
    from ...fmus.build import build

    check_place(output / f"{next(iter(CATALOGUE))}.fmu")  # the values of a scene load a library
    form = {"backend": "python" if python else "native", "fmi": fmi, "platforms": platforms}
    wanted, left_out = _wanted(scene, python)
    files, rows = [], []
    for number, (name, (unit, sizes, values)) in enumerate(wanted.items(), start=1):
        options = {**sizes, **form, **values}
        files.append(written(output / name, lambda to, u=unit, o=options: build(u, to, **o)))  # type: ignore[misc]
        rows.append((unit, ", ".join(f"{key} = {value}" for key, value in sizes.items()) or "-"))
        if progress:
            progress(number / len(wanted))
    heads = ("unit", "options")
    return Built("Units built", heads, tuple(files), tuple(rows), tuple(left_out))


def _wanted(
    scene: Scene | None, python: bool
) -> tuple[dict[str, tuple[str, dict[str, Any], dict[str, Any]]], list[str]]:
    """File name -> unit, its options and values; and the units that the scene does without."""
    if scene is None:
        kinds = [unit for unit in CATALOGUE if not (python and CATALOGUE[unit].native)]
        return {f"{unit}.fmu": (unit, {}, {}) for unit in kinds}, [
            f"{unit} (native only)" for unit in CATALOGUE if unit not in kinds
        ]
    from ..master.plan import about, plan
    from .python_units import refuse_native_only
    from .start import start_values

    if python:
        refuse_native_only(scene)
    units, start = plan(scene).units, start_values(scene)
    wanted = {
        f"{unit.name}.fmu": (
            unit.model,
            dict(unit.sizes),
            {"start": start[unit.name], "about": about(unit, scene)},
        )
        for unit in units
    }
    used = {unit.model for unit in units}
    return wanted, [f"{unit} (none in the scene)" for unit in CATALOGUE if unit not in used]


def _build_one_file(scene: Scene, output: Path, form: dict[str, Any]) -> Built:
    from .one_file import build_one_file

    path = output if output.suffix == ".fmu" else output / f"{scene.name}.fmu"
    written(path, lambda to: build_one_file(scene, to, **form))
    parts = ", ".join(["rotor", *(balancer.label for balancer in scene.balancer)])
    return Built("Scene built", ("units", "coupling"), (path,), ((parts, scene.coupling.scheme),))


def _build_ssp(scene: Scene, output: Path, one_file: bool, form: dict[str, Any]) -> Built:
    from .ssp.build import build_ssp

    path = output if output.suffix == ".ssp" else output / f"{scene.name}.ssp"
    written(path, lambda to: build_ssp(scene, to, one_file=one_file, **form))
    units = "coupled inside" if one_file else "connected, with slopes"
    return Built("System structure package built", ("units",), (path,), ((units,),))


def written(path: Path, make: Callable[[Path], object]) -> Path:
    """A file made at a path; what prevents it is a UserError."""
    from ...fmus.native.build.compile import NotCompiled

    check_place(path)
    try:
        make(path)
    except OSError as error:
        if is_own_file(error):
            raise
        raise UserError(f"{path}: cannot be written: {error.strerror or error}") from error
    except ValueError as error:
        raise UserError(f"{path}: {error}") from error
    except NotCompiled as error:
        raise UserError(f"{error}; or build units that run Python: --python") from error
    return path


def check_place(path: Path) -> None:
    """Refuse a place that takes no file before anything is compiled, which can take minutes."""
    if path.parent.exists():
        ready_to_write(path)
    else:  # it is made
        ready_to_fill(path.parent)
