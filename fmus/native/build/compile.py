"""Compiler of the native units: one library a platform, from any machine, always the same bytes.

A further one is for web pages, in WebAssembly, with a front of its own.

`zig cc` (the wheel `ziglang`) compiles for all platforms.  No library is linked with a C run-time
library: the C has its own elementary functions, so that results have the same bits everywhere,
and the few names it needs (calloc, memcpy, strlen) are in every process.  A stamp, the hash of the
sources, says what a library was made from.

    python -m autobalancer.fmus.native.build.compile [platform ...]
"""

from __future__ import annotations

import hashlib
import os
import re
import sys
from collections.abc import Iterable, Iterator
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path

from ...unit import alternatives
from ...xml.archive import source, write
from .targets import (
    COMPILE,
    COPIES_COMPILE,
    FAST,
    FAST_COMPILE,
    LANES_COMPILE,
    LINK,
    PAGE,
    PLATFORMS,
    TARGETS,
    WIDE_COMPILE,
    Platform,
)

COMPILER = "0.17.1"  # version of ziglang: part of the stamp, another writes other bytes

SOURCES = Path(__file__).resolve().parents[1]
BINARIES = SOURCES / "bin"
_KEPT = SOURCES / "__pycache__" / "stamp"
LANES = "lanes"  # folder of what is compiled once more, for machines side by side
TEMPLATE = "_template.h"  # end of the name of a text that is put in place where it is included
SOURCE = "autobalancer.c"  # what is compiled: all of them

_INCLUDE = re.compile(r'^#include "(.+)"$', re.M)

_STAMP = '#ifndef STAMP_H\n#define STAMP_H\n\n#define STAMP "{}"\n\n#endif\n'


class NotCompiled(RuntimeError):
    """A library is missing or made from other sources, and the compiler is not installed."""


def libraries(platforms: Iterable[str] = PLATFORMS) -> dict[str, Path]:
    """Libraries made from the present sources; what is stale is compiled first.

    Args:
        platforms: names out of PLATFORMS.

    Returns:
        platform -> file.

    Raises:
        ValueError: a name is not in PLATFORMS.
        NotCompiled: one is stale and ziglang is not installed.
        subprocess.CalledProcessError: the compiler refuses the sources; its words are on stderr.
    """
    return compiled(_known(platforms))


def page_library() -> bytes:
    """The library for web pages; raises as `libraries`."""
    return compiled([PAGE])[PAGE].read_bytes()


def compiled(names: Iterable[str] = TARGETS) -> dict[str, Path]:
    """As `libraries`, of any targets."""
    current = stamp()
    if wanted := [name for name in names if _made_from(name) != current]:
        compile(wanted)
    return {name: _library(name) for name in names}


def stale(names: Iterable[str] = TARGETS) -> bool:
    """Whether `compiled` would have to compile."""
    current = stamp()
    return any(_made_from(name) != current for name in names)


def stamp() -> str:
    """Sixteen hexadecimal digits that name the sources of the libraries.

    An installed package has it beside its libraries.  A checkout computes it, and keeps it with the
    times and sizes of the files that it was computed from until one of these changes.
    """
    if SOURCES.parents[2].name in ("site-packages", "dist-packages"):
        made = {found for name in PLATFORMS if (found := _made_from(name))}
        if len(made) == 1:
            return made.pop()
    present = _present_files()
    with suppress(OSError, ValueError):
        files, found = _KEPT.read_text(encoding="ascii").split()
        if files == present:
            return found
    current = _complete()[1]
    with suppress(OSError):  # where it cannot be kept it is computed each time
        write(_KEPT, f"{present} {current}".encode())
    return current


def _present_files() -> str:
    """Digest of the times and sizes of all files that the stamp is computed from."""
    known = (
        COMPILER,
        COMPILE,
        COPIES_COMPILE,
        LANES_COMPILE,
        WIDE_COMPILE,
        LINK,
        sorted(TARGETS.items()),
        *_times(SOURCES.parent),
    )
    shared = os.stat(SOURCES.parents[1] / "models" / "constants.py")
    return hashlib.sha256(repr((known, shared.st_mtime_ns, shared.st_size)).encode()).hexdigest()


def _times(folder: Path | str) -> Iterator[tuple[str, int, int]]:
    """Path, time and size of every source below a folder, of Python and of C."""
    for entry in sorted(os.scandir(folder), key=lambda entry: entry.name):
        if entry.is_dir():
            if entry.name not in ("bin", "__pycache__"):
                yield from _times(entry.path)
        elif entry.name.endswith((".py", ".c", ".h", ".def")):
            found = entry.stat()
            yield entry.path, found.st_mtime_ns, found.st_size


def one_source(folder: str = "") -> str:
    """The C sources one behind the other, each behind what it includes, with the folder's own."""
    written, _ = _complete()
    return _joined(written, _sources(written, folder))


def _sources(written: dict[str, str], folder: str) -> list[str]:
    others = {platform.folder for platform in TARGETS.values()} - {folder, ""} | {LANES}
    return [n for n in written if n.endswith(".c") and n.split("/")[0] not in others]


def fast_of(sources: Iterable[str]) -> list[str]:
    """Those that are compiled with more put in line, in their order.

    Raises:
        ValueError: an entry of `FAST` is no file and no folder with files: it was renamed.
    """
    sources = list(sources)
    found = {e: [n for n in sources if n == e or (e[-1] == "/" and n.startswith(e))] for e in FAST}
    if absent := [entry for entry, names in found.items() if not names]:
        raise ValueError(
            f"FAST in build/targets.py: no file of {', '.join(absent)}; name it as it is"
        )
    return [name for name in sources if any(name in names for names in found.values())]


def parts_of_library(platform: Platform) -> dict[str, tuple[str, tuple[str, ...]]]:
    """Text and options of each object of a library, by name; together they are `one_source`.

    `lanes`, which an FMU's sources do not have, is the series once more, of several machines or
    weights; `copies` is the recurrence once more for plain machines; `wide` and `wide_copies` are
    the same for processors with wider vectors.
    """
    written, _ = _complete()
    sources = _sources(written, platform.folder)
    fast = fast_of(sources)
    has = {"-DHAS_LANES": platform.lanes, "-DHAS_WIDE_VECTORS": platform.wide}
    common = (*COMPILE, *platform.compiler, *(option for option in has if has[option]))
    parts = {
        "autobalancer": (_joined(written, [n for n in sources if n not in fast]), common),
        "series": (_joined(written, fast), (*common, *FAST_COMPILE)),
    }
    if platform.lanes:
        side_by_side = {**written, "base/number.h": written[f"{LANES}/lane_number.h"]}
        text = _joined(side_by_side, [f"{LANES}/lanes.c"])
        parts[LANES] = (text, (*common, *LANES_COMPILE))
        if platform.wide:
            parts["wide"] = (text, (*common, *LANES_COMPILE, *WIDE_COMPILE))
        copies = _joined(written, [f"{LANES}/copies.c"])
        parts["copies"] = (copies, (*common, *COPIES_COMPILE))
        if platform.wide:
            parts["wide_copies"] = (copies, (*common, *COPIES_COMPILE, *WIDE_COMPILE))
    return parts


def _joined(written: dict[str, str], sources: Iterable[str]) -> str:
    """Texts one behind the other, each once and behind what it includes."""
    parts: dict[str, str] = {}

    def in_place(name: str) -> str:
        """Text of a file whose templates stand where they are included."""
        lines = written[name].splitlines()
        for k, line in enumerate(lines):
            if (found := _INCLUDE.match(line)) and found[1].endswith(TEMPLATE):
                lines[k] = f"{_line(1, found[1])}{written[found[1]]}{_line(k + 2, name)}"
            elif found:
                lines[k] = ""
        # messages of the compiler then name the file and the line
        return _line(1, name) + "\n".join(lines) + "\n"

    def add(name: str) -> None:
        if name not in parts and not name.endswith(TEMPLATE):
            for included in _INCLUDE.findall(written[name]):
                add(included)
            parts[name] = in_place(name)

    for name in sources:
        add(name)
    return "".join(parts.values())


def _line(number: int, name: str) -> str:
    return f'#line {number} "{name}"\n'


def texts() -> dict[str, str]:
    """Text of every C source by its path, those for one platform in a folder of their own."""
    paths = [path for kind in ("[ch]", "def") for path in sorted(SOURCES.glob(f"*/*.{kind}"))]
    return {path.relative_to(SOURCES).as_posix(): source(path) for path in paths}


def _complete() -> tuple[dict[str, str], str]:
    """Sources with what is generated, the variables of the units and the stamp; and the stamp."""
    from .layout import constants, header, weight_parameters  # made of all declarations

    generated = {"layout.h": header(), "constants.h": constants()}
    written = {**texts(), **generated, "weights_parameters.h": weight_parameters()}
    total = hashlib.sha256()
    for text in (
        COMPILER,
        *COMPILE,
        *FAST,
        *FAST_COMPILE,
        *COPIES_COMPILE,
        *LANES_COMPILE,
        *WIDE_COMPILE,
        *LINK,
        *map(repr, TARGETS.values()),
    ):
        total.update(text.encode() + b"\0")
    for name, text in written.items():
        total.update(f"{name}\0{len(text)}\0{text}".encode())
    current = total.hexdigest()[:16]
    return {**written, "stamp.h": _STAMP.format(current)}, current


def compile(names: list[str]) -> None:
    """Compile the libraries of these targets; raises as `libraries`."""
    import tempfile
    from concurrent.futures import ThreadPoolExecutor

    _installed()
    current = stamp()
    with (
        tempfile.TemporaryDirectory(prefix="autobalancer-zig-") as folder,
        ThreadPoolExecutor(os.cpu_count()) as pool,
    ):
        made = pool.map(lambda name: _compiled(TARGETS[name], Path(folder, name)), names)
        for name, library in zip(names, made, strict=True):
            write(_library(name), library)
            write(BINARIES / name / "stamp", current.encode())


def _compiled(platform: Platform, folder: Path) -> bytes:
    """Bytes of a library; the compiler runs in the folder of the source, so no path is in them."""
    target = ("cc", "-target", platform.target)
    linked = []
    for name, (text, options) in parts_of_library(platform).items():
        write(folder / f"{name}.c", text.encode())
        linked.append(f"{name}.o")
        _zig(folder, *target, *options, "-c", f"{name}.c", "-o", linked[-1])
    if platform.library.endswith(".dll"):
        # what names msvcrt.dll has: zig's own import libraries take a minute to make
        write(folder / "msvcrt.def", texts()["windows/msvcrt.def"].encode())
        _zig(folder, "dlltool", "-m", "i386:x86-64", "-d", "msvcrt.def", "-l", "msvcrt.lib")
        linked.append("msvcrt.lib")
    _zig(folder, *target, *LINK, *platform.link, *linked, "-o", platform.library)
    return (folder / platform.library).read_bytes()


def _zig(folder: Path, *arguments: str) -> None:
    """Run zig in a folder, with caches where the caller named them, else beside it."""
    import importlib.resources
    import subprocess

    caches = dict.fromkeys(("ZIG_GLOBAL_CACHE_DIR", "ZIG_LOCAL_CACHE_DIR"), str(folder.parent))
    # not `python -m ziglang`: while that loads it answers Ctrl-C with a traceback
    command = [str(importlib.resources.files("ziglang") / "zig"), *arguments]
    environment = {**caches, **os.environ}
    subprocess.run(command, cwd=folder, env=environment, check=True, stdin=subprocess.DEVNULL)


def _installed() -> None:
    import importlib.util

    if importlib.util.find_spec("ziglang") is None:
        found = "it is not installed"
    elif (present := version("ziglang")) != COMPILER:
        found = f"{present} is installed"
    else:
        return
    raise NotCompiled(
        f"the native libraries were not made from the present sources, and to compile them needs "
        f"ziglang {COMPILER}: {found}. Run: {sys.executable} -m pip install ziglang=={COMPILER}"
    )


def _known(platforms: Iterable[str], known: Iterable[str] = PLATFORMS) -> list[str]:
    names = list(dict.fromkeys(platforms))
    for name in names:
        if name not in known:
            raise ValueError(f"platform = {name!r}: must be one of {alternatives(known)}")
    return names


def _library(platform: str) -> Path:
    return BINARIES / platform / TARGETS[platform].library


def _made_from(platform: str) -> str | None:
    """Stamp of the library that is there."""
    path = BINARIES / platform / "stamp"
    return path.read_text() if path.exists() and _library(platform).exists() else None


if __name__ == "__main__":
    for platform_, path_ in compiled(_known(sys.argv[1:] or TARGETS, TARGETS)).items():
        print(f"{platform_:15} {path_.stat().st_size:7} bytes  {path_}")
