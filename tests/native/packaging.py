"""Native FMUs for the tests: the C sources compiled here, zipped with the Python units' description."""

from __future__ import annotations

import itertools
import subprocess
import zipfile
from pathlib import Path

from autobalancer.fmus.build import UNITS, build, contents
from autobalancer.fmus.native.layout import header, token

SOURCES = Path(__file__).parents[2] / "fmus" / "native"
STAMP = "0123456789abcdef"
FLAGS = (
    "-std=c99",
    "-O2",
    "-ffp-contract=off",
    "-fno-math-errno",
    "-fvisibility=hidden",
    "-Wall",
    "-Wextra",
    "-Wpedantic",
    "-Werror",
    "-shared",
    "-fPIC",
)


def generate(folder: Path) -> None:
    """Write the headers that the sources need besides those in their folder."""
    (folder / "layout.h").write_text(header())
    (folder / "stamp.h").write_text(f'#define STAMP "{STAMP}"\n')


def compile_units(folder: Path, *flags: str) -> Path:
    """Compile all C sources with the compiler of this machine; flags are added to `FLAGS`."""
    folder.mkdir(parents=True, exist_ok=True)
    generate(folder)
    library = folder / "autobalancer.so"
    sources = sorted(str(path) for path in SOURCES.glob("*.c"))
    command = ["cc", *FLAGS, *flags, f"-I{folder}", *sources, "-o", str(library)]
    subprocess.run(command, check=True)
    return library


class Packager:
    """FMUs of both kinds, each built once for the same options."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.library = compile_units(folder / "compiled")
        self._numbers = itertools.count()
        self._built: dict[tuple, Path] = {}

    def token(self, unit: str, **options: object) -> str:
        """GUID of a native unit."""
        return token(unit, self.options(unit, **options), STAMP)

    def options(self, unit: str, **options: object) -> dict[str, object]:
        """All options of a unit, those not given as `build` has them."""
        own = {"frame": "rotor"}
        if unit == "BallBalancer":
            own["weights"] = 2
        if unit == "RotorOnSupports":
            own |= {"kind": "planar", "stations": 1, "planes": 1}
            if options.get("kind", "planar") != "planar":
                own["unbalances"] = 1
            if options.get("kind") == "flexible":
                own["shaft"] = "uniform"
        return own | options

    def native(self, unit: str, **options: object) -> Path:
        """A native FMU for FMI 2.0."""
        return self._once("native", unit, options)

    def python(self, unit: str, **options: object) -> Path:
        """The same unit in Python."""
        return self._once("python", unit, options)

    def layout(self, unit: str, **options: object):
        return UNITS[unit].configured(**self.options(unit, **options)).layout

    def _once(self, runtime: str, unit: str, options: dict) -> Path:
        key = (runtime, unit, *sorted(options.items()))
        if key not in self._built:
            folder = self.folder / f"{runtime}-{next(self._numbers)}"
            made = self._native if runtime == "native" else build
            self._built[key] = made(unit, folder, **options)
        return self._built[key]

    def _native(self, unit: str, folder: Path, **options) -> Path:
        description = contents(unit, **options)["modelDescription.xml"].decode()
        start = description.index('guid="') + len('guid="')
        end = description.index('"', start)
        description = description[:start] + self.token(unit, **options) + description[end:]
        folder.mkdir()
        path = folder / f"{unit}.fmu"
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("modelDescription.xml", description)
            archive.write(self.library, f"binaries/linux64/{unit}.so")
        return path
