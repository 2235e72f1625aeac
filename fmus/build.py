"""Builder of the FMUs: the same bytes from the same sources, wherever and whenever it runs."""

from __future__ import annotations

import re
import zipfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from fmpy import platform, platform_tuple

from .catalogue import equations, sized_unit
from .native.build.compile import SOURCE, libraries, stamp
from .native.build.layout import identity_of, start_entries, token
from .native.build.package import holds_universal, native_files
from .unit import SizedUnit, Unit, alternatives
from .xml import fmi2, fmi3
from .xml.archive import digest, unzipped, write, zipped
from .xml.description import Capabilities, options_in
from .xml.documentation import LICENCE, html
from .xml.terminals import icon

_DESCRIBED_BY = {2: fmi2.model_description, 3: fmi3.model_description}
_DESCRIPTION = "modelDescription.xml"
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
        unit: RotorOnSupports | LiquidBalancer | BallBalancer.
        destination: folder (made when missing), or a file that ends in .fmu.
        backend: "native" (libraries in C), or "python" (slaves under pythonfmu: the papers'
            equations, without what `Variable.native` and `Unit.native` mark).
        fmi: 2 or 3; Python units are of FMI 2.0 only.
        platforms: of native units, default: all.
        name: model name and file name, default: that of the unit.
        start: start values of parameters and inputs in place of the unit's own; native units alone.
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
    if start:
        raise ValueError("start: only native units have start values of a scene")
    if fmi != 2:
        raise ValueError(f"fmi = {fmi!r}: Python units are of FMI 2.0 only; build native ones")
    if platforms is not None:
        raise ValueError("platforms: only native units have them to choose from")
    return _python(sized.in_python, identifier)


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


def _python(unit: SizedUnit, identifier: str) -> dict[str, bytes]:
    """Files of a Python FMU; its GUID is a hash of all the others."""
    from .python.package import python_files

    files = {**_documented(unit, identifier), **icon(unit, 2), **python_files(unit, identifier)}
    draft = _described(unit, identifier, 2, "", Capabilities())
    content = digest({**files, _DESCRIPTION: draft})
    guid = f"{{{content[:8]}-{content[8:12]}-{content[12:16]}-{content[16:20]}-{content[20:32]}}}"
    files[_DESCRIPTION] = _described(unit, identifier, 2, guid, Capabilities())
    return files


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
    files[_DESCRIPTION] = _described(unit, identifier, fmi, identity, can)
    return {**_documented(unit, identifier, machine, parts), **icon(unit, fmi), **files}


def _described(unit: SizedUnit, identifier: str, fmi: int, token: str, can: Capabilities) -> bytes:
    return _DESCRIBED_BY[fmi](unit, identifier, token, _release(), can)


def _release() -> str:
    try:
        return version("autobalancer")
    except PackageNotFoundError:
        return "0"


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
        return digest(files) == digest(contents(unit, backend="python", **options))
    library = libraries([platform_tuple])[platform_tuple].read_bytes()
    places = tuple(f"binaries/{folder}/" for folder in (platform, platform_tuple))
    found = [data for name, data in files.items() if name.startswith(places)]
    if library not in found and not any(holds_universal(data, library) for data in found):
        return False
    if text:
        own = f"{token(sized_unit(unit, **options), stamp())};"
        return text.startswith(own) and root.get("guid") == identity_of(text)
    return files[_DESCRIPTION] == contents(unit, **options)[_DESCRIPTION]


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
        root = ElementTree.fromstring(files[_DESCRIPTION])
        if root.tag != "fmiModelDescription":
            raise KeyError(f"{_DESCRIPTION} begins with {root.tag}")
    except (zipfile.BadZipFile, KeyError, ElementTree.ParseError) as error:
        raise ValueError(f"{path}: not an FMU ({error})") from None
    return files, root
