"""The archive of an FMU: the same bytes from the same files, written whole or not at all."""

from __future__ import annotations

import hashlib
import io
import lzma
import struct
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path

from ..whole_files import whole_file

# what zipfile raises besides BadZipFile: unknown compression, encryption, a stream that breaks off
_DAMAGE = (RuntimeError, EOFError, ValueError, zlib.error, lzma.LZMAError, struct.error)
LARGEST_UNPACKED = 256_000_000  # bytes, far above any unit of `build`
_EPOCH = (1980, 1, 1, 0, 0, 0)


def digest(files: Mapping[str, bytes]) -> str:
    """Hash of names and contents, 64 hexadecimal digits."""
    total = hashlib.sha256()
    for path in sorted(files):
        total.update(f"{path}\0{len(files[path])}\0".encode())
        total.update(files[path])
    return total.hexdigest()


def zipped(files: Mapping[str, bytes]) -> bytes:
    """Archive with sorted names, fixed dates and permissions; stored, as zlib builds differ."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_STORED) as archive:
        for path in sorted(files):
            entry = zipfile.ZipInfo(path, _EPOCH)
            entry.create_system = 3
            entry.external_attr = (0o755 if path.startswith("binaries/") else 0o644) << 16
            archive.writestr(entry, files[path])
    return buffer.getvalue()


def unzipped(path: Path | str) -> dict[str, bytes]:
    """Files of an archive by name.

    Raises:
        zipfile.BadZipFile: it is none, damaged, or larger than `LARGEST_UNPACKED`.
        OSError: it cannot be read.
    """
    try:
        refuse_large(path)
        with zipfile.ZipFile(path) as archive:
            names = [name for name in archive.namelist() if not name.endswith("/")]
            return {name: archive.read(name) for name in names}
    except _DAMAGE as error:
        raise zipfile.BadZipFile(str(error)) from error


def refuse_large(path: Path | str) -> None:
    """Refuse an archive by the sizes in its directory, beyond which `zipfile` unpacks nothing.

    Raises:
        zipfile.BadZipFile: it is no archive, or larger than `LARGEST_UNPACKED`.
        OSError: it cannot be read.
    """
    with zipfile.ZipFile(path) as archive:
        size = sum(entry.file_size for entry in archive.infolist())
    if size > LARGEST_UNPACKED:
        raise zipfile.BadZipFile(f"unpacks to {size} bytes; at most {LARGEST_UNPACKED} are allowed")


def source(path: Path) -> str:
    """Text of a file, with the same line ends on every platform."""
    return path.read_text(encoding="utf-8").replace("\r\n", "\n")


def write(target: Path, data: bytes) -> None:
    """Write a file whole or not at all."""
    target.parent.mkdir(parents=True, exist_ok=True)
    with whole_file(target) as stream:
        stream.write(data)
