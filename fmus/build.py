"""Builder of the FMUs: the same bytes from the same sources, wherever and whenever it runs."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from .catalogue import equations, sized_unit
from .native.build.compile import SOURCE, stamp
from .native.build.package import native_files
from .native.build.tokens import identity_of, start_entries, token
from .unit import SizedUnit, Unit, alternatives
from .xml import fmi2, fmi3
from .xml.archive import digest, write, zipped
from .xml.description import Capabilities
from .xml.documentation import LICENCE, html
from .xml.terminals import icon

_DESCRIBED_BY = {2: fmi2.model_description, 3: fmi3.model_description}
DESCRIPTION = "modelDescription.xml"
COMPOSITION = "resources/composition.txt"  # as fmi/front.c reads it


def build(
    unit: str,
    destination: Path | str,
    *,
    backend: str = "native",
    fmi: int = 2,
    platforms: Iterable[str] | None = None,
    name: str | None = None,
    start: Mapping[str, float | bool] | None = None,
    about: Mapping[str, Any] | None = None,
    **options: Any,
) -> Path:
    """Build one FMU.

    Args:
        unit: RotorOnSupports | LiquidBalancer | BallBalancer | RingBalancer | Motor.
        destination: folder (made when missing), or a file that ends in .fmu.
        backend: "native" (libraries in C), or "python" (slaves under pythonfmu: the papers'
            equations, no motor, without what `Variable.native` and `Unit.native` mark).
        fmi: 2 or 3; Python units are of FMI 2.0 only.
        platforms: of native units, default: all.
        name: model name and file name, default: that of the unit.
        start: start values of parameters and inputs in place of the unit's own.
        about: `summary`, `stop` and `step` of the description of a unit that has them.
        options: frame ("rotor", or "fixed" for signals along fixed axes); of a rotor kind,
            stations, planes, unbalances and shaft; of a ball balancer weights.  `Sizes` of the
            units say what they mean and what is allowed; a unit leaves those of others aside.

    Returns:
        The file.

    Raises:
        ValueError: an argument is not one of those allowed; the text names it.
        TypeError: no unit has such an option.
        NotCompiled: a native library is not of the present sources, and there is no compiler.
        OSError: the file cannot be written; nothing is left behind.

    >>> ab.build("LiquidBalancer", "units", platforms=["x86_64-linux"]).name
    'LiquidBalancer.fmu'
    """
    form: dict[str, Any] = {"backend": backend, "fmi": fmi, "platforms": platforms, "name": name}
    content = contents(unit, **form, start=start, about=about, **options)
    return written(content, destination, name or unit)


def written(content: Mapping[str, bytes], destination: Path | str, name: str) -> Path:
    """Write an FMU as a file, or in a folder under its name; the file."""
    target = Path(destination)
    if target.suffix != ".fmu" and target.is_file():
        raise NotADirectoryError(f"{target}: is a file: give a folder, or a file that ends in .fmu")
    if target.suffix != ".fmu" or target.is_dir():
        target = target / f"{name}.fmu"
    write(target, zipped(content))
    return target


def contents(
    unit: str,
    *,
    backend: str = "native",
    fmi: int = 2,
    platforms: Iterable[str] | None = None,
    name: str | None = None,
    start: Mapping[str, float | bool] | None = None,
    about: Mapping[str, Any] | None = None,
    **options: Any,
) -> dict[str, bytes]:
    """Files of an FMU by their names in it; arguments as of `build`."""
    sized = sized_unit(unit, **options)
    identifier = unit if name is None else name
    _refuse_wrong(identifier, fmi)
    if backend not in ("python", "native"):
        raise ValueError(f"backend = {backend!r}: must be one of 'python', 'native'")
    if backend == "native":
        can = Capabilities(
            interpolation=True,
            time_derivatives=True,
            directional_derivatives=True,
            early_return=sized.returns_early,
        )

        entries = start_entries(sized.layout, start or {}, sized.layout.inputs.stop)
        text = ";".join([token(sized, stamp()), *entries])
        if not start:
            return native_contents(sized, identifier, text, can, fmi, platforms)
        shown = sized.started(start, about or {})
        files = native_contents(shown, identifier, identity_of(text), can, fmi, platforms)
        return {**files, COMPOSITION: text.encode()}
    if fmi != 2:
        raise ValueError(f"fmi = {fmi!r}: Python units are of FMI 2.0 only; build native ones")
    if platforms is not None:
        raise ValueError("platforms: only native units have them to choose from")
    if problems := sized.python_problems(start or {}):
        raise ValueError("; ".join(problems))
    return _python(sized.started(start or {}, about or {}).in_python, identifier, start or {})


def _refuse_wrong(identifier: str, fmi: int) -> None:
    if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", identifier):
        raise ValueError(
            f"name = {identifier!r}: must be letters, digits and underscores, not a digit first"
        )
    if fmi not in _DESCRIBED_BY:
        raise ValueError(f"fmi = {fmi!r}: must be one of {alternatives(_DESCRIBED_BY)}")


def _documented(
    unit: SizedUnit, identifier: str, machine: str = "", parts: Sequence[Unit] = ()
) -> dict[str, bytes]:
    texts = [equations(one) for one in (unit.unit, *parts)]
    return {
        "documentation/index.html": html(unit, identifier, machine, texts),
        "documentation/licenses/license.txt": LICENCE.encode(),
    }


def _python(
    unit: SizedUnit, identifier: str, start: Mapping[str, float | bool]
) -> dict[str, bytes]:
    """Files of a Python FMU; its GUID is a hash of all the others."""
    from .python.package import python_files

    files = {**_documented(unit, identifier), **icon(unit, 2)}
    files |= python_files(unit, identifier, {k: v for k, v in start.items() if unit.has(k)})
    files[DESCRIPTION] = _described(unit, identifier, 2, "", Capabilities())
    files[DESCRIPTION] = _described(unit, identifier, 2, content_guid(files), Capabilities())
    return files


def content_guid(files: Mapping[str, bytes]) -> str:
    """Identity of a Python FMU whose description has none yet."""
    content = digest(files)
    return f"{{{content[:8]}-{content[8:12]}-{content[12:16]}-{content[16:20]}-{content[20:32]}}}"


def native_contents(
    unit: SizedUnit,
    identifier: str,
    identity: str,
    can: Capabilities,
    fmi: int,
    platforms: Iterable[str] | None,
    machine: str = "",
    parts: Sequence[Unit] = (),
) -> dict[str, bytes]:
    """Files of a native FMU by their names in it.

    Args:
        unit: what descriptions and documentation say of it.
        identifier: model and file name.
        identity: GUID or instantiation token.
        can: what it offers.
        fmi, platforms: as of `build`.
        machine: what the documentation says first, HTML.
        parts: units whose equations it has besides.
    """
    _refuse_wrong(identifier, fmi)

    chosen = {} if platforms is None else {"platforms": platforms}
    files = native_files(identifier, fmi=fmi, **chosen)
    can = replace(can, sources=(SOURCE,))
    files[DESCRIPTION] = _described(unit, identifier, fmi, identity, can)
    return {**_documented(unit, identifier, machine, parts), **icon(unit, fmi), **files}


def _described(unit: SizedUnit, identifier: str, fmi: int, token: str, can: Capabilities) -> bytes:
    return _DESCRIBED_BY[fmi](unit, identifier, token, _release(), can)


def _release() -> str:
    try:
        return version("autobalancer")
    except PackageNotFoundError:
        return "0"
