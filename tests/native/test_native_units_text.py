"""Numbers in messages: Python's own digits, without a C library's formats."""

from __future__ import annotations

import ctypes
import math
import struct

import numpy as np
import pytest

pytestmark = pytest.mark.slow

SPECIAL = [
    0.0, -0.0, 1.0, -1.0, 0.1, 1e15, 1e16, 123456789012345680.0, 1e22, 1e23, 9007199254740993.0,
    5e-324, 2.2250738585072014e-308, 2.225073858507201e-308, 1.7976931348623157e308, 1e-4, 1e-5,
    9.5e-5, 0.00012345, 4.35, 0.5, 2.5, 1e300, 8.41e21, 2.0**-1074 * 3, 9.999999999999999e22,
    math.inf, -math.inf, math.nan, 999999.5, 9999995.0, 0.000099999951, 2.0**53, 2.0**70, 5e-5,
]  # fmt: skip


class Text(ctypes.Structure):
    _fields_ = (("at", ctypes.c_char_p), ("size", ctypes.c_size_t), ("length", ctypes.c_size_t))


@pytest.fixture(scope="module")
def text(core):
    """Calls a function of text.c and returns what it wrote into a buffer of some size."""

    def write(function: str, *arguments: object, size: int = 200) -> str:
        buffer = ctypes.create_string_buffer(size + 8)
        words = Text(ctypes.cast(buffer, ctypes.c_char_p), size, 0)
        getattr(core.library, function)(ctypes.byref(words), *arguments)
        assert buffer.raw[size:] == b"\0" * 8
        return buffer.value.decode()

    return write


def numbers() -> list[float]:
    """Of every size: random bits, and decimal numbers of few digits."""
    rng = np.random.default_rng(1)
    bits = rng.integers(0, 2**64, 3000, dtype=np.uint64).tolist()
    drawn = [struct.unpack("<d", struct.pack("<Q", b))[0] for b in bits]
    short = [
        float(f"{m}e{e}")
        for m, e in zip(
            rng.integers(1, 10**6, 3000).tolist(), rng.integers(-30, 30, 3000), strict=True
        )
    ]
    return [
        *SPECIAL,
        *(x for x in drawn if math.isfinite(x)),
        *short,
        *rng.normal(size=500).tolist(),
    ]


def test_a_number_is_written_as_python_writes_it(text):
    for x in numbers():
        assert text("text_number", ctypes.c_double(x)) == repr(x)


@pytest.mark.parametrize("digits", [1, 3, 6, 12, 17])
def test_a_rounded_number_is_written_as_python_writes_it(text, digits):
    for x in numbers():
        assert text("text_rounded", ctypes.c_double(x), digits) == format(x, f".{digits}g")


def test_a_list_is_written_as_python_writes_it(text):
    values = [0.0, 0.1, 0.30000000000000004, -1e-9]
    array = (ctypes.c_double * 4)(*values)
    assert text("text_list", array, ctypes.c_size_t(4)) == repr(values)


def test_a_whole_number(text):
    for value in (0, 7, 10, 4294967295):
        assert text("text_integer", ctypes.c_ulong(value)) == str(value)


@pytest.mark.parametrize("size", [4, 5, 10])
def test_a_text_too_long_ends_in_dots(text, size):
    written = text("text_put", b"abcdefghijklmnop", size=size)
    assert written == "abcdefghijklmnop"[: size - 4] + "..."
