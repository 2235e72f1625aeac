"""A macOS library whose bytes follow from its sources alone.

Where local names are left out, zig's linker leaves memory it never wrote between two tables of
the file, and takes it along into what identifies the file (LC_UUID) and into its signature.  Here
that gap is zeroed and both are made anew (Mach-O as in Apple's `loader.h` and `cs_blobs.h`).
"""

from __future__ import annotations

import hashlib
import struct
from collections.abc import Iterator

_HEADER, _COUNT = 32, 16  # bytes of the header, where it has the number of load commands
_SYMTAB, _DYSYMTAB, _UUID, _CODE_SIGNATURE = 0x2, 0xB, 0x1B, 0x1D  # load commands
_CODE_DIRECTORY = 0xFADE0C02


def settled(library: bytes) -> bytes:
    """The library with its gap zeroed, its identity and its ad-hoc signature made anew."""
    data = bytearray(library)
    at = dict(_commands(library))
    entries, count = struct.unpack_from("<II", library, at[_DYSYMTAB] + 56)  # indirect symbols
    (names,) = struct.unpack_from("<I", library, at[_SYMTAB] + 16)
    gap = slice(entries + 4 * count, names)
    data[gap] = bytes(gap.stop - gap.start)
    identity = slice(at[_UUID] + 8, at[_UUID] + 24)
    data[identity] = bytes(16)
    signature = None
    if _CODE_SIGNATURE in at:
        (signature,) = struct.unpack_from("<I", library, at[_CODE_SIGNATURE] + 8)
    data[identity] = hashlib.sha256(data[:signature]).digest()[:16]
    if signature is not None:
        _sign(data, signature)
    return bytes(data)


def _commands(library: bytes) -> Iterator[tuple[int, int]]:
    """Kinds of load commands, and where they are."""
    (count,) = struct.unpack_from("<I", library, _COUNT)
    at = _HEADER
    for _ in range(count):
        kind, size = struct.unpack_from("<II", library, at)
        yield kind, at
        at += size


def _sign(data: bytearray, signature: int) -> None:
    """The hash of every page, where the code directory of a signature has them."""
    (count,) = struct.unpack_from(">I", data, signature + 8)
    for k in range(count):
        (offset,) = struct.unpack_from(">I", data, signature + 12 + 8 * k + 4)
        directory = signature + offset
        magic, hashes, pages, limit = (
            struct.unpack_from(">I", data, directory + place)[0] for place in (0, 16, 28, 32)
        )
        if magic != _CODE_DIRECTORY:
            continue
        size, page = data[directory + 36], 1 << data[directory + 39]
        for n in range(pages):
            content = data[n * page : min((n + 1) * page, limit)]
            place = directory + hashes + n * size
            data[place : place + size] = hashlib.sha256(content).digest()[:size]
