"""Native part of an FMU: libraries for all platforms, and the C sources."""

from __future__ import annotations

import struct
from collections.abc import Iterable, Sequence
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from .compile import PLATFORMS, SOURCE, libraries, one_source

# FMI 2.0.5, 2.3: names of its own for x86, else those of FMI 3.0
_FMI2 = {"x86_64-linux": "linux64", "x86_64-windows": "win64", "x86_64-darwin": "darwin64"}
_SUFFIXES = (("linux", ".so"), ("darwin", ".dylib"), ("win", ".dll"))  # "darwin" ends in "win"
_PAGE = 14  # of arm64, as a power of two
_UNIVERSAL = 0xCAFEBABE


def native_files(
    identifier: str, *, platforms: Iterable[str] = PLATFORMS, fmi: int = 2
) -> dict[str, bytes]:
    """Libraries and C sources of a native FMU by their names in it.

    Args:
        identifier: model identifier.
        platforms: names out of PLATFORMS.
        fmi: version, 2 | 3.

    Raises:
        ValueError, NotCompiled: as `libraries`.
    """
    made = {name: path.read_bytes() for name, path in libraries(platforms).items()}
    files = {
        f"binaries/{folder}/{identifier}{_suffix(folder)}": library
        for folder, library in (_fmi2_folders(made) if fmi == 2 else made).items()
    }
    files[f"sources/{SOURCE}"] = one_source().encode()
    if fmi == 3:
        files["sources/buildDescription.xml"] = _build_description(identifier)
    return files


def _fmi2_folders(made: dict[str, bytes]) -> dict[str, bytes]:
    """Libraries by folder under binaries/ of FMI 2.0.

    Tools on arm64 also look where they look on x86: on a Mac one library serves both processors; on
    Linux there is room for one, and that is x86 unless it is left out.
    """
    folders = {_FMI2.get(platform, platform): library for platform, library in made.items()}
    if "aarch64-darwin" in made:
        folders["darwin64"] = universal(
            [made[name] for name in ("x86_64-darwin", "aarch64-darwin") if name in made]
        )
    if "aarch64-linux" in made:
        folders.setdefault("linux64", made["aarch64-linux"])
    return folders


def universal(libraries: Sequence[bytes]) -> bytes:
    """One macOS library of several, each for another processor: header, then each on its page."""
    header = struct.pack(">II", _UNIVERSAL, len(libraries))
    body = b""
    start = 1 << _PAGE
    for library in libraries:
        processor = struct.unpack_from("<II", library, 4)
        body += bytes(-len(body) % (1 << _PAGE))
        header += struct.pack(">IIIII", *processor, start + len(body), len(library), _PAGE)
        body += library
    return header.ljust(start, b"\0") + body


def holds_universal(data: bytes, library: bytes) -> bool:
    """Whether this is a universal library with that one in it."""
    return data.startswith(struct.pack(">I", _UNIVERSAL)) and library in data


def _build_description(identifier: str) -> bytes:
    """How a tool makes the library from sources/, in FMI 3.0."""
    root = Element("fmiBuildDescription", {"fmiVersion": "3.0"})
    configuration = SubElement(root, "BuildConfiguration", {"modelIdentifier": identifier})
    files = SubElement(configuration, "SourceFileSet", {"language": "C99"})
    SubElement(files, "SourceFile", {"name": SOURCE})
    indent(root)
    return b'<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(root, "utf-8") + b"\n"


def _suffix(folder: str) -> str:
    return next(suffix for system, suffix in _SUFFIXES if system in folder)
