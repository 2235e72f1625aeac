"""The libraries of the native units: what they need, export and carry, and when they are made."""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import fmpy
import pytest

from autobalancer.fmus.native.build import compile as compiler
from autobalancer.fmus.native.build.compile import COMPILER, PLATFORMS, NotCompiled, libraries
from autobalancer.fmus.native.build.package import universal

pytestmark = pytest.mark.slow

lief = pytest.importorskip("lief", reason="no reader of libraries: lief is not installed")
pytest.importorskip("ziglang", reason="no compiler: ziglang is not installed")
lief.logging.disable()
ROOT = Path(__file__).parents[2]
LIMIT = 480_000  # bytes

# what every C library has, and memory
_STRING = {"memcmp", "memcpy", "memmove", "memset", "strcmp", "strlen", "strncmp"}
# what a composite is made of is in a file
_FILE = {"fclose", "fopen", "fread"}
ALLOWED = _STRING | _FILE | {"calloc", "free"}
WINDOWS = {"_wfopen"}  # fopen takes no name outside the system's code page
# of clang for macOS, from libSystem; the binder belongs to the loader
DARWIN = {"bzero", "__bzero", "dyld_stub_binder", "memset_pattern16"}
LINUX = {"bcmp"}  # of clang, for memcmp == 0
# of zig's linker
MARKS = {"_mh_dylib_header", "__dso_handle"}
RUNS = {"autobalancer_runs"}  # batch.h
RUNS |= {f"autobalancer_run_{name}" for name in ("new", "free", "start", "on", "read")}  # run.h

each = pytest.mark.parametrize("platform", PLATFORMS)


@pytest.fixture(scope="module")
def library():
    """Path and parsed form of a platform's library."""
    made = libraries()

    def library(platform: str):
        path = made[platform]
        if "darwin" in platform:
            return path, lief.MachO.parse(str(path)).at(0)
        return path, lief.parse(str(path))

    return library


def _plain(names, darwin: bool) -> set[str]:
    """Names as C has them: macOS puts an underscore before each."""
    return {
        str(n).removeprefix("_") if darwin and str(n).startswith("_") else str(n) for n in names
    }


def _exports(binary, platform: str) -> set[str]:
    if "windows" in platform:
        return {entry.name for entry in binary.get_export().entries}
    return _plain((s.name for s in binary.exported_symbols), "darwin" in platform)


def _standard(version: int) -> set[str]:
    """Functions of a version of FMI, by the header that fmpy compiles units with."""
    header = Path(fmpy.__file__).parent / "c-code" / f"fmi{version}Functions.h"
    return set(re.findall(rf"fmi{version}FullName\((fmi\w+)\)", header.read_text()))


@each
def test_no_library_is_larger_than_480_kB(platform, library):
    path, _ = library(platform)
    assert path.stat().st_size <= LIMIT


@each
def test_exports_are_the_functions_of_both_versions_of_fmi_and_those_of_runs(platform, library):
    _, binary = library(platform)
    assert len(_standard(3)) == 75
    assert _exports(binary, platform) - MARKS == _standard(2) | _standard(3) | RUNS


@pytest.mark.parametrize("platform", ["x86_64-linux", "aarch64-linux"])
def test_a_linux_library_asks_for_no_other_library(platform, library):
    _, binary = library(platform)
    assert list(binary.libraries) == []
    wanted = {s.name for s in binary.dynamic_symbols if s.name and s.shndx == 0}
    assert wanted
    assert wanted <= ALLOWED | LINUX
    # a version would tie it to glibc
    assert not binary.has(lief.ELF.DynamicEntry.TAG.VERNEED)


def test_the_windows_library_asks_for_memory_strings_and_files_of_msvcrt_alone(library):
    _, binary = library("x86_64-windows")
    wanted = {entry.name: {e.name for e in entry.entries} for entry in binary.imports}
    assert set(wanted) == {"msvcrt.dll"}
    assert wanted["msvcrt.dll"] <= ALLOWED | WINDOWS


@pytest.mark.parametrize("platform", ["x86_64-darwin", "aarch64-darwin"])
def test_a_macos_library_asks_for_libsystem_and_macos_11(platform, library):
    _, binary = library(platform)
    own, system = [entry.name for entry in binary.libraries]
    assert own == "@rpath/autobalancer.dylib"
    assert system == "/usr/lib/libSystem.B.dylib"
    assert binary.build_version.platform == lief.MachO.BuildVersion.PLATFORMS.MACOS
    assert list(binary.build_version.minos) == [11, 0, 0]
    assert _plain((s.name for s in binary.imported_symbols), True) <= ALLOWED | DARWIN


@pytest.mark.parametrize("platform", ["x86_64-darwin", "aarch64-darwin"])
def test_lazy_pointers_of_a_macos_library_name_what_is_imported(platform, library):
    _, binary = library(platform)
    table, sections = binary.dynamic_symbol_command, {s.name: s for s in binary.sections}
    names = [symbol.name for symbol in table.indirect_symbols]
    calls = names[: sections["__la_symbol_ptr"].size // 8]
    first = sections["__la_symbol_ptr"].reserved1
    assert set(calls) < {s.name for s in binary.imported_symbols}
    assert names[first:] == calls


def test_machines_are_those_that_the_platforms_name(library):
    elf, pe, macho = lief.ELF.ARCH, lief.PE.Header.MACHINE_TYPES, lief.MachO.Header.CPU_TYPE
    kinds = {name: library(name)[1].header for name in PLATFORMS}
    assert kinds["x86_64-linux"].machine_type == elf.X86_64
    assert kinds["aarch64-linux"].machine_type == elf.AARCH64
    assert kinds["x86_64-windows"].machine == pe.AMD64
    assert kinds["x86_64-darwin"].cpu_type == macho.X86_64
    assert kinds["aarch64-darwin"].cpu_type == macho.ARM64


def _big(data: bytes, position: int) -> int:
    return int.from_bytes(data[position : position + 4], "big")


def test_the_arm64_macos_library_is_signed(library):
    """The system refuses it otherwise; nothing is changed behind the linker, which signs."""
    path, binary = library("aarch64-darwin")
    command = binary.code_signature
    assert command.data_offset + command.data_size == path.stat().st_size
    assert _big(path.read_bytes(), command.data_offset) == 0xFADE0CC0


def test_the_universal_library_holds_both_as_they_are(library):
    parts = [library(name)[0].read_bytes() for name in ("x86_64-darwin", "aarch64-darwin")]
    whole = universal(parts)
    fat = lief.MachO.parse(list(whole))
    for part, binary in zip(parts, fat, strict=True):
        start, alignment = binary.fat_offset, 1 << 14
        assert start % alignment == 0
        assert whole[start : start + len(part)] == part
        assert binary.header.cpu_type == lief.MachO.parse(list(part)).at(0).header.cpu_type


# --- making them ------------------------------------------------------------------------------


@pytest.fixture
def checkout(tmp_path):
    """The sources elsewhere, by default without libraries; runs Python with them as the package."""

    def copy(folder: str, without: tuple[str, ...] = ("bin", "__pycache__")):
        root = tmp_path / folder / "autobalancer"
        for name in ("fmus", "models"):
            shutil.copytree(ROOT / name, root / name, ignore=shutil.ignore_patterns(*without))

        def run(code: str, **environment: str) -> str:
            return subprocess.run(
                [sys.executable, "-c", code],
                env={**os.environ, "PYTHONPATH": str(root.parent), **environment},
                check=True,
                capture_output=True,
                text=True,
            ).stdout

        return root / "fmus" / "native", run

    return copy


_MAKE = "from autobalancer.fmus.native.build.compile import libraries; libraries({})"


def _bytes(native: Path) -> dict[str, str]:
    files = [path for path in (native / "bin").rglob("*") if path.is_file()]
    return {str(p.relative_to(native)): hashlib.sha256(p.read_bytes()).hexdigest() for p in files}


def test_an_edit_makes_the_libraries_stale_and_the_next_call_makes_them_anew(checkout, tmp_path):
    """Byte for byte as elsewhere, in place of what was made while a file was another.

    Bytes depend on nothing but the sources: not on folders, nor on the time, of which a PE file
    has one in whole seconds.
    """
    both = ["x86_64-linux", "x86_64-windows"]
    libraries(both)
    native, run = checkout("another folder, ü", without=("__pycache__",))
    made, source = native / "bin" / "x86_64-linux", native / "weights" / "liquid.c"
    first, text = _bytes(native), source.read_bytes()
    stale = (
        "from autobalancer.fmus.native.build.compile import stale, stamp; "
        "print(stale(['x86_64-linux']), stamp())"
    )
    fresh, stamp = run(stale).split()
    assert fresh == "False"
    source.write_bytes(text + b"/* edited */\n")
    old, edited = run(stale).split()
    assert old == "True"
    assert edited != stamp
    (made / "stamp").write_text(edited)
    (made / "autobalancer.so").write_bytes(b"made from the edited file")
    assert run(stale).split() == ["False", edited]
    source.write_bytes(text)
    assert run(stale).split() == ["True", stamp]
    (native / "bin" / "x86_64-windows" / "autobalancer.dll").unlink()
    run(_MAKE.format(both), HOME="/nonexistent", TMPDIR=str(tmp_path), SOURCE_DATE_EPOCH="1")
    assert run(stale).split() == ["False", stamp]
    assert _bytes(native) == first


def test_an_edit_in_python_that_declares_nothing_else_compiles_nothing(checkout):
    libraries(["x86_64-linux"])
    native, run = checkout("one", without=("__pycache__",))
    first = _bytes(native)
    with (native.parent / "liquid" / "slave.py").open("a") as file:
        file.write("# edited\n")
    without = "import sys; sys.modules['ziglang'] = None; " + _MAKE.format("['x86_64-linux']")
    run(without)
    changed = {name for name, digest in _bytes(native).items() if first[name] != digest}
    assert not changed


def test_another_compiler_is_refused(monkeypatch):
    monkeypatch.setattr(compiler, "version", lambda name: "0.1.0")
    with pytest.raises(NotCompiled, match=r"0\.1\.0 is installed"):
        compiler.compile(["x86_64-linux"])


def test_the_compiler_that_tests_install_is_the_one_that_the_stamp_names():
    assert f'"ziglang=={COMPILER}"' in (ROOT / "pyproject.toml").read_text()
