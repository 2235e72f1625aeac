"""Tokens: texts from which the library makes a unit of its sizes, with its start values."""

from __future__ import annotations

import re
import struct
from collections.abc import Mapping
from functools import cache

from ...unit import SizedUnit
from ...variables import Layout

_FNV_START, _FNV_PRIME = 0xCBF29CE484222325, 0x100000001B3


@cache
def token(unit: SizedUnit, stamp: str) -> str:
    """Identity of a native unit: GUID in FMI 2.0, instantiation token in FMI 3.0.

    Args:
        unit: with its sizes.
        stamp: of the C sources.
    """
    words = [unit.name, *(f"{key}={value}" for key, value in unit.options.items()), ""]
    return signed("/".join(words), stamp)


def signed(text: str, stamp: str) -> str:
    """A text with its digest and the stamp of the C sources behind, which the library compares."""
    return f"{text}{hashed(text)}-{stamp}"


def start_entries(layout: Layout, start: Mapping[str, float | bool], end: int) -> list[str]:
    """Entries `start=` and `flags=` of a token's text: variables below a value reference."""
    values = [
        f"{layout.index[name]}:{bits(value)}"
        for name, value in start.items()
        if layout.index.get(name, end) < end
    ]
    flags = [str(layout.boolean_index[k]) for k, v in start.items() if v is True]
    return [f"{key}={','.join(v)}" for key, v in (("start", values), ("flags", flags)) if v]


def identity_of(text: str) -> str:
    """GUID or instantiation token of an FMU that has the text among its resources."""
    return f"{re.split('[/;]', text, maxsplit=1)[0]}/{hashed(text)}"


def hashed(text: str) -> str:
    """FNV-1a of a text: 16 hexadecimal digits."""
    total = _FNV_START
    for byte in text.encode("ascii"):
        total = (total ^ byte) * _FNV_PRIME & 0xFFFFFFFFFFFFFFFF
    return f"{total:016x}"


def bits(value: float) -> str:
    """The sixteen hexadecimal digits of a double."""
    return struct.pack(">d", value).hex()
