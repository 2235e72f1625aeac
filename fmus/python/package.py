"""Python part of an FMU: its sources under a package of their own, pythonfmu's libraries."""

from __future__ import annotations

import ast
import hashlib
import json
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import pythonfmu

from ..unit import SizedUnit
from ..xml.archive import digest, source
from ..xml.documentation import PYTHONFMU_LICENCE
from .resources import OPTIONS, START

_ROOT = Path(__file__).resolve().parents[2]
_PYTHONFMU = Path(pythonfmu.__file__).resolve().parent
# what a slave needs of pythonfmu, without its builder
_EMBEDDED = ("_version", "default_experiment", "enums", "fmi2slave", "logmsg", "variables")
_SEAM = "fmus/python/_pythonfmu.py"

# pythonfmu's loader imports this file once a process, runs its text at every instantiation, and
# takes the class out of the module.  The sources beside it are a package that is named by their
# content: what was edited is another package, whatever the process has loaded before.
_SLAVE = '''"""Loaded by pythonfmu: the unit, of the sources that are beside this file now."""
import sys


def _load(file):
    """The class, and the module that says what the loader has done."""
    from hashlib import sha256
    from importlib import import_module
    from importlib.util import module_from_spec, spec_from_file_location
    from pathlib import Path

    home = next(Path(at) for at in sys.path if at and (Path(at) / file).is_file())
    sources = {{
        path.relative_to(home / "{package}").as_posix(): path.read_bytes()
        for path in (home / "{package}").rglob("*.py")
    }}
    content = sha256()
    for path in sorted(sources):
        content.update(f"{{path}}\\0{{len(sources[path])}}\\0".encode() + sources[path])
    package = f"autobalancer_{{content.hexdigest()[:16]}}"
    if package not in sys.modules:
        folder = str(home / "{package}")
        spec = spec_from_file_location(
            package, f"{{folder}}/__init__.py", submodule_search_locations=[folder]
        )
        sys.modules[package] = module = module_from_spec(spec)
        spec.loader.exec_module(module)
    unit = import_module(f"{{package}}.fmus.{folder}.slave").{unit}
    return unit, import_module(f"{{package}}.fmus.python.host")


{unit}, _host = _load(f"{{__name__}}.py")
globals()["{unit}"] = {unit}
_host.entered(globals(), locals())
'''

_NEEDS = """{unit} runs Python code: the host process needs CPython 3.10 or newer, 64 bit{numpy}.

Nothing else is needed: the model and the Python side of pythonfmu 0.7 are inside, under a package
name of their own, and no package installed on the host is used{but}.

How the host finds Python
  - A host that is itself a Python program (FMPy, PyFMI, libcosimpy ...) lends its own interpreter.
  - Any other host loads libpython at run time:
      Linux    libpython3.so (the stable ABI) must be found by the loader: LD_LIBRARY_PATH
               or, for hosts that load FMUs with private symbols, LD_PRELOAD=.../libpython3.x.so
      Windows  the folder of python3.dll must be in PATH, and PYTHONHOME must name its installation.

Binaries: linux64, win64.
"""


def python_files(
    unit: SizedUnit, identifier: str, start: Mapping[str, float | bool]
) -> dict[str, bytes]:
    """Files of a Python FMU by their names in it, all but what is said about the unit.

    The sources are the same for all sizes of a unit and all start values; a slave reads both from
    files when it is instantiated.

    Args:
        unit: with its sizes.
        identifier: model identifier.
        start: start values in place of the unit's own.
    """
    name, folder = unit.name, unit.unit.folder
    sources = embedded(f"fmus.{folder}.slave")
    package = f"autobalancer_{digest(sources)[:16]}"
    slave = _SLAVE.format(unit=name, package=package, folder=folder).encode()
    module = f"{name}_{hashlib.sha256(slave).hexdigest()[:16]}"
    files = {f"resources/{package}/{path}": data for path, data in sources.items()}
    files[f"resources/{module}.py"] = slave
    files["resources/slavemodule.txt"] = module.encode()
    files[f"resources/{OPTIONS}"] = json.dumps(unit.options).encode()
    if start:
        files[f"resources/{START}"] = json.dumps(dict(start)).encode()
    for library in sorted((_PYTHONFMU / "resources" / "binaries").glob("*/*")):
        if library.suffix in (".so", ".dll", ".dylib"):
            inside = f"binaries/{library.parent.name}/{identifier}{library.suffix}"
            files[inside] = library.read_bytes()
    needs_numpy = any(b"import numpy" in data for data in sources.values())
    numpy = ", with NumPy 1.24 or newer" if needs_numpy else " (the standard library is enough)"
    but = " but NumPy" if needs_numpy else ""
    needs = _NEEDS.format(unit=name, numpy=numpy, but=but)
    files["documentation/externalDependencies.txt"] = needs.encode()
    files["documentation/licenses/pythonfmu.txt"] = PYTHONFMU_LICENCE.encode()
    return files


def embedded(module: str) -> dict[str, bytes]:
    """Python files of the embedded package: a module and what it imports, no more.

    Args:
        module: dotted, from the folder that holds `fmus` and `models`.
    """
    sources = {"__init__.py": b"", "pythonfmu/__init__.py": b""}
    waiting = [module]
    while waiting:
        name = waiting.pop()
        path = f"{name.replace('.', '/')}.py"
        if path in sources:
            continue
        text = source(_ROOT / path)
        for folder in Path(path).parents[:-1]:
            sources[f"{folder.as_posix()}/__init__.py"] = b""
        waiting += imports(name, text)
        if path == _SEAM:
            text = text.replace("from pythonfmu.", "from ...pythonfmu.")
        sources[path] = text.encode()
    for stem in _EMBEDDED:
        sources[f"pythonfmu/{stem}.py"] = source(_PYTHONFMU / f"{stem}.py").encode()
    return sources


@cache
def imports(module: str, text: str) -> list[str]:
    """Modules of this project that a source imports relatively, by their dotted names."""
    imported = []
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ImportFrom) and node.level:
            base = module.split(".")[: -node.level] + (node.module or "").split(".")
            target = ".".join(part for part in base if part)
            if (_ROOT / target.replace(".", "/")).is_dir():  # `from .package import module`
                imported += [f"{target}.{alias.name}" for alias in node.names]
            else:
                imported.append(target)
    return imported
