"""Numbers in messages: twelve digits at most, without a C library's formats."""

from __future__ import annotations

import ctypes
import math

import numpy as np
import pytest

pytestmark = pytest.mark.slow

SPECIAL = [
    0.0, -0.0, 1.0, -1.0, 0.1, 1e15, 1e16, 1e22, 1e23, 1.7976931348623157e308, 1e-4, 1e-5,
    9.5e-5, 0.00012345, 4.35, 0.5, 1e300, math.inf, -math.inf, math.nan, 999999.5, 999999999999.5,
    0.000099999951, 2.0**53, 5e-5, 0.30000000000000004,
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
    """Of every size, of few digits and of many."""
    rng = np.random.default_rng(1)
    sizes = 10.0 ** rng.uniform(-300, 300, 2000)
    short = zip(rng.integers(1, 10**6, 2000), rng.integers(-30, 30, 2000), strict=True)
    return [*SPECIAL, *sizes.tolist(), *(float(f"{m}e{e}") for m, e in short)]


def test_a_number_is_written_as_python_writes_its_first_twelve_digits(text):
    for x in numbers():
        written = text("text_format", b"%v", ctypes.c_double(x))
        assert written == repr(float(written))
        assert float(written) == pytest.approx(x, rel=5.01e-12, abs=1e-323, nan_ok=True)


@pytest.mark.parametrize("digits", [1, 3, 6, 9])
def test_a_rounded_number_is_written_as_python_writes_it(text, digits):
    for x in numbers():
        near = {format(x * share, f".{digits}g") for share in (1.0 - 1e-13, 1.0, 1.0 + 1e-13)}
        assert text("text_format", b"%%%d" % digits, ctypes.c_double(x)) in near  # ties: either way


def test_a_list_is_written_as_python_writes_it(text):
    values = [0.0, 0.1, 0.30000000000000004, -1e-9]
    array = (ctypes.c_double * 4)(*values)
    written = text("text_format", b"%l kg", array, ctypes.c_size_t(4))
    assert written == "[0.0, 0.1, 0.3, -1e-09] kg"


def test_a_whole_number(text):
    for value in (0, 7, 10, 4294967295):
        assert text("text_format", b"<%u>", ctypes.c_ulong(value)) == f"<{value}>"


@pytest.mark.parametrize("size", [4, 5, 10])
def test_a_text_too_long_ends_in_dots(text, size):
    written = text("text_put", b"abcdefghijklmnop", size=size)
    assert written == "abcdefghijklmnop"[: size - 4] + "..."
