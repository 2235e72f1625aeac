"""Builder of the FMUs: the same bytes from the same sources, wherever and whenever it runs."""

from __future__ import annotations

import ast
import hashlib
import io
import os
import re
import tempfile
import zipfile
from collections.abc import Iterable, Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from xml.etree import ElementTree

import pythonfmu

from .description import model_description
from .documentation import LICENCE, LICENCE_WITH_PYTHONFMU, external_dependencies, html
from .liquid import LiquidBalancer
from .rotor import RotorOnSupports
from .rotor_kinds import KINDS
from .rotor_parts import SHAFTS
from .signals import FRAMES
from .slave import Unit
from .weights import BallBalancer

UNITS: dict[str, type[Unit]] = {
    unit.__name__: unit for unit in (RotorOnSupports, LiquidBalancer, BallBalancer)
}
_MODULES = {"RotorOnSupports": "rotor", "LiquidBalancer": "liquid", "BallBalancer": "weights"}
_ROOT = Path(__file__).resolve().parent.parent
_PYTHONFMU = Path(pythonfmu.__file__).resolve().parent
# what a slave needs of pythonfmu, without its builder
_EMBEDDED = ("_version", "default_experiment", "enums", "fmi2slave", "logmsg", "variables")
# backend -> versions of FMI it writes
FMI_VERSIONS = {"native": (2,), "python": (2,)}
_EPOCH = (1980, 1, 1, 0, 0, 0)

_SLAVE = '''"""Loaded by pythonfmu: {unit} with its sizes."""
from {package}.fmus.host import entered
from {package}.fmus.{module} import {unit} as _unit

{unit} = _unit.configured({options})
del _unit
entered(globals(), locals())
'''


def build(
    unit: str,
    destination: Path | str,
    *,
    stations: int = 1,
    planes: int = 1,
    kind: str = "planar",
    unbalances: int = 1,
    shaft: str = SHAFTS[0],
    weights: int = 2,
    frame: str = "rotor",
    name: str | None = None,
    backend: str = "python",
    fmi: int = 2,
    platforms: Iterable[str] | None = None,
) -> Path:
    """Build one FMU.

    Args:
        unit: RotorOnSupports | LiquidBalancer | BallBalancer.
        destination: folder (made when missing), or a file that ends in .fmu.
        stations, planes, kind: of the rotor.
        unbalances: how many a rotor of kind two_support or flexible has.
        shaft: of a flexible rotor, "uniform" or "compliance".
        weights: number of weights of the ball balancer.
        frame: "rotor", or "fixed" for signals along fixed axes.
        name: model name and file name, default: that of the unit.
        backend: "native", compiled C that needs nothing, or "python", pythonfmu and the sources.
        fmi: version of FMI, 2 | 3; 3 for native units alone.
        platforms: of a native unit, names out of `native.compile.PLATFORMS`; default: all.

    Returns:
        The file.

    Raises:
        ValueError: an argument is not one of those allowed; the text names it.
        native.compile.NotCompiled: no native library of the present sources, and no compiler.
        OSError: the file cannot be written; nothing is left behind.
    """
    content = contents(
        unit,
        stations=stations,
        planes=planes,
        kind=kind,
        unbalances=unbalances,
        shaft=shaft,
        weights=weights,
        frame=frame,
        name=name,
        backend=backend,
        fmi=fmi,
        platforms=platforms,
    )
    target = Path(destination)
    if target.suffix != ".fmu" or target.is_dir():
        target = target / f"{name or unit}.fmu"
    _write(target, _zipped(content))
    return target


def contents(
    unit: str,
    *,
    stations: int = 1,
    planes: int = 1,
    kind: str = "planar",
    unbalances: int = 1,
    shaft: str = SHAFTS[0],
    weights: int = 2,
    frame: str = "rotor",
    name: str | None = None,
    backend: str = "python",
    fmi: int = 2,
    platforms: Iterable[str] | None = None,
) -> dict[str, bytes]:
    """Files of an FMU by their names in it; arguments as of `build`."""
    options = _options(unit, stations, planes, kind, unbalances, shaft, weights, frame)
    identifier = unit if name is None else name
    if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", identifier):
        raise ValueError(
            f"name = {identifier!r}: must be letters, digits and underscores, not a digit first"
        )
    _one_of("backend", backend, FMI_VERSIONS)
    _one_of("fmi", fmi, FMI_VERSIONS[backend])
    configured = UNITS[unit].configured(**options)
    if backend == "native":
        return _native(configured, identifier, fmi, platforms)
    if platforms is not None:
        raise ValueError("platforms: a choice for native units alone")
    sources = _sources(_MODULES[unit])
    package = f"autobalancer_{_digest(sources)[:16]}"
    slave = _SLAVE.format(
        unit=unit,
        package=package,
        module=_MODULES[unit],
        options=", ".join(f"{key}={value!r}" for key, value in sorted(options.items())),
    ).encode()
    module = f"{unit}_{hashlib.sha256(slave).hexdigest()[:16]}"
    files = {f"resources/{package}/{path}": data for path, data in sources.items()}
    files[f"resources/{module}.py"] = slave
    files["resources/slavemodule.txt"] = module.encode()
    for binary in sorted((_PYTHONFMU / "resources" / "binaries").glob("*/*")):
        if binary.suffix in (".so", ".dll", ".dylib"):
            name_ = f"binaries/{binary.parent.name}/{identifier}{binary.suffix}"
            files[name_] = binary.read_bytes()
    files["documentation/index.html"] = html(configured, identifier)
    needs_numpy = any(b"import numpy" in data for data in sources.values())
    files["documentation/externalDependencies.txt"] = external_dependencies(configured, needs_numpy)
    files["documentation/licenses/license.txt"] = LICENCE_WITH_PYTHONFMU.encode()
    release = _version()
    draft = model_description(configured, identifier, "", release)
    digest = _digest({**files, "modelDescription.xml": draft})
    guid = f"{{{digest[:8]}-{digest[8:12]}-{digest[12:16]}-{digest[16:20]}-{digest[20:32]}}}"
    files["modelDescription.xml"] = model_description(configured, identifier, guid, release)
    return files


def _native(
    unit: type[Unit], identifier: str, fmi: int, platforms: Iterable[str] | None
) -> dict[str, bytes]:
    """Files of a native FMU."""
    # imported here: Python units must build where there is no compiler
    from .native.compile import PLATFORMS
    from .native.package import native_files

    chosen = PLATFORMS if platforms is None else platforms

    def describe(token: str, sources: Sequence[str]) -> bytes:
        return model_description(unit, identifier, token, _version(), sources)

    return {
        "documentation/index.html": html(unit, identifier),
        "documentation/licenses/license.txt": LICENCE.encode(),
        **native_files(unit, identifier, describe, platforms=chosen, fmi=fmi),
    }


def identity(unit: str, **options) -> str:
    """GUID of the FMU that `build` would write from the present sources."""
    return _guid(contents(unit, **options)["modelDescription.xml"])


def content_id(path: Path | str) -> str:
    """GUID of an FMU file, a hash of its content; compare with `identity`.

    Raises:
        ValueError: the file is not an FMU.
        OSError: it cannot be read.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            return _guid(archive.read("modelDescription.xml"))
    except (zipfile.BadZipFile, KeyError, ElementTree.ParseError) as error:
        raise ValueError(f"{path}: not an FMU ({error})") from None


def _guid(description: bytes) -> str:
    guid = ElementTree.fromstring(description).get("guid")
    if not guid:
        raise KeyError("modelDescription.xml has no guid")
    return guid


def _options(
    unit: str,
    stations: int,
    planes: int,
    kind: str,
    unbalances: int,
    shaft: str,
    weights: int,
    frame: str,
) -> dict:
    """The options that concern this unit, checked."""
    _one_of("unit", unit, UNITS)
    _one_of("frame", frame, FRAMES)
    if unit == "LiquidBalancer":
        return {"frame": frame}
    if unit == "BallBalancer":
        _at_least_one("weights", weights)
        return {"frame": frame, "weights": weights}
    _one_of("kind", kind, KINDS)
    _at_least_one("stations", stations)
    _at_least_one("planes", planes)
    options = {"frame": frame, "kind": kind, "stations": stations, "planes": planes}
    if kind != "planar":
        _at_least_one("unbalances", unbalances)
        options["unbalances"] = unbalances
    if kind == "flexible":
        _one_of("shaft", shaft, SHAFTS)
        options["shaft"] = shaft
    return options


def _one_of(what: str, value: object, allowed) -> None:
    if value not in allowed:
        raise ValueError(f"{what} = {value!r}: must be one of {', '.join(map(repr, allowed))}")


def _at_least_one(what: str, value: int) -> None:
    if not isinstance(value, int) or isinstance(value, bool) or value < 1:
        raise ValueError(f"{what} = {value!r}: must be a whole number, at least 1")


def _sources(module: str) -> dict[str, bytes]:
    """Python files of the embedded package: the unit's module and what it imports, no more."""
    sources = {"__init__.py": b"", "fmus/__init__.py": b"", "pythonfmu/__init__.py": b""}
    waiting = [f"fmus.{module}"]
    while waiting:
        name = waiting.pop()
        path = f"{name.replace('.', '/')}.py"
        if path in sources:
            continue
        text = _text(_ROOT / path)
        for folder in Path(path).parents[:-1]:
            sources[f"{folder.as_posix()}/__init__.py"] = b""
        waiting += _imports(name, text)
        if path == "fmus/_pythonfmu.py":
            text = text.replace("from pythonfmu.", "from ..pythonfmu.")
        sources[path] = text.encode()
    for stem in _EMBEDDED:
        sources[f"pythonfmu/{stem}.py"] = _text(_PYTHONFMU / f"{stem}.py").encode()
    return sources


def _text(path: Path) -> str:
    """Source with the same line ends on every platform."""
    return path.read_text(encoding="utf-8").replace("\r\n", "\n")


def _imports(module: str, text: str) -> list[str]:
    """Modules of this project that a source imports relatively, by their dotted names."""
    found = []
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ImportFrom) and node.level:
            base = module.split(".")[: -node.level] + (node.module or "").split(".")
            target = ".".join(part for part in base if part)
            if (_ROOT / target.replace(".", "/")).is_dir():  # `from .package import module`
                found += [f"{target}.{alias.name}" for alias in node.names]
            else:
                found.append(target)
    return found


def _digest(files: dict[str, bytes]) -> str:
    total = hashlib.sha256()
    for path in sorted(files):
        total.update(f"{path}\0{len(files[path])}\0".encode())
        total.update(files[path])
    return total.hexdigest()


def _version() -> str:
    try:
        return version("autobalancer")
    except PackageNotFoundError:
        return "0"


def _zipped(files: dict[str, bytes]) -> bytes:
    """Archive with sorted names, fixed dates and permissions; stored, as zlib builds differ."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_STORED) as archive:
        for path in sorted(files):
            entry = zipfile.ZipInfo(path, _EPOCH)
            entry.create_system = 3
            entry.external_attr = (0o755 if path.startswith("binaries/") else 0o644) << 16
            archive.writestr(entry, files[path])
    return buffer.getvalue()


def _write(target: Path, data: bytes) -> None:
    """Write a file whole or not at all."""
    target.parent.mkdir(parents=True, exist_ok=True)
    handle, draft = tempfile.mkstemp(prefix=f".{target.name}-", dir=target.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        os.chmod(draft, 0o644)
        os.replace(draft, target)
    except BaseException:
        os.unlink(draft)
        raise
