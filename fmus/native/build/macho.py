"""A macOS library whose bytes follow from its sources alone.

Where local names are left out, zig's linker leaves memory it never wrote between two tables of
the file; and of pointers without a name it counts an indirect symbol each but writes none, so that
those after them stand too early and the last are memory it never wrote.  All that goes along into
what identifies the file (LC_UUID) and into its signature.  Here the gap is zeroed, indirect symbols
stand where their sections look for them, and the others are made anew (Mach-O as in Apple's
`loader.h` and `cs_blobs.h`).
"""

from __future__ import annotations

import hashlib
import struct
from collections.abc import Iterator

_HEADER, _COUNT = 32, 16  # bytes of the header, where it has the number of load commands
_SYMTAB, _DYSYMTAB, _UUID, _CODE_SIGNATURE = 0x2, 0xB, 0x1B, 0x1D  # load commands
_SEGMENT, _FIRST_SECTION, _SECTION = 0x19, 72, 80  # a load command; where its sections begin; size
_POINTERS, _LAZY_POINTERS, _STUBS = 6, 7, 8  # types of sections with indirect symbols
_NAMELESS = 0x80000000  # an indirect symbol
_CODE_DIRECTORY = 0xFADE0C02


def settled(library: bytes) -> bytes:
    """The library without what was never written, its identity and ad-hoc signature made anew."""
    data = bytearray(library)
    at = dict(_commands(library))
    entries, count = struct.unpack_from("<II", library, at[_DYSYMTAB] + 56)  # indirect symbols
    _place(data, entries, count, dict(_indirect(library)))
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


def _indirect(library: bytes) -> Iterator[tuple[int, tuple[int, int]]]:
    """Types of sections that have indirect symbols, which is the first of each, and how many."""
    for kind, at in _commands(library):
        if kind != _SEGMENT:
            continue
        (sections,) = struct.unpack_from("<I", library, at + 64)
        for k in range(sections):
            place = at + _FIRST_SECTION + k * _SECTION
            (size,) = struct.unpack_from("<Q", library, place + 40)
            flags, first, stub = struct.unpack_from("<III", library, place + 64)
            if flags & 0xFF in (_POINTERS, _LAZY_POINTERS, _STUBS):
                yield flags & 0xFF, (first, size // (stub or 8))


def _place(data: bytearray, entries: int, count: int, sections: dict[int, tuple[int, int]]) -> None:
    """Put indirect symbols, written one after another, where their sections have the first of them.

    Stubs and lazy pointers are of the same symbols in the same order.
    """
    if not {_POINTERS, _LAZY_POINTERS, _STUBS} <= sections.keys():
        return
    symbols = list(struct.unpack_from(f"<{count}I", data, entries))
    (stubs, calls), (pointers, some), (lazy, _) = (
        sections[kind] for kind in (_STUBS, _POINTERS, _LAZY_POINTERS)
    )
    called = symbols[stubs : stubs + calls]
    named = next(k for k in range(some + 1) if symbols[pointers + k :][:calls] == called)
    symbols[pointers + named : pointers + some] = [_NAMELESS] * (some - named)
    symbols[lazy : lazy + calls] = called
    struct.pack_into(f"<{count}I", data, entries, *symbols)


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
