"""Numbers in messages: twelve digits at most, without a C library's formats."""

from __future__ import annotations

import ctypes
import math
import re

import numpy as np
import pytest

pytestmark = pytest.mark.slow

SPECIAL = [
    1.0, 0.1, 1e15, 1e16, 1e22, 1e23, 1.7976931348623157e308, 1e-4, 1e-5, 9.5e-5, 0.00012345, 4.35,
    0.5, 1e300, math.inf, math.nan, 999999.5, 999999999999.5, 0.000099999951, 2.0**53, 5e-5,
    0.30000000000000004,
]  # fmt: skip


class Text(ctypes.Structure):
    _fields_ = (("at", ctypes.c_char_p), ("size", ctypes.c_size_t), ("length", ctypes.c_size_t))


def numbers() -> list[float]:
    """Of every size, of few digits and of many."""
    rng = np.random.default_rng(1)
    sizes = 10.0 ** rng.uniform(-300, 300, 2000)
    short = zip(rng.integers(1, 10**6, 2000), rng.integers(-30, 30, 2000), strict=True)
    return [*SPECIAL, *sizes.tolist(), *(float(f"{m}e{e}") for m, e in short)]


def test_a_number_is_written_as_python_writes_its_first_twelve_digits(fmus, packaging):
    """As a mass below zero, which the unit refuses."""
    host = packaging.Host(fmus.native("BallBalancer"))
    for x in numbers():
        said = host.refused(lambda x=x: host.set({"mass": -x}))
        (written,) = re.findall(r"mass = (\S+) kg: must", said)
        assert written == repr(float(written))
        assert float(written) == pytest.approx(-x, rel=5.01e-12, abs=1e-323, nan_ok=True)
    host.free()


@pytest.mark.parametrize("digits", [1, 3, 6, 12])
def test_a_rounded_number_is_written_as_python_writes_it(core, digits):
    for x in numbers():
        buffer = ctypes.create_string_buffer(200)
        words = Text(ctypes.cast(buffer, ctypes.c_char_p), 200, 0)
        core.library.text_rounded(ctypes.byref(words), ctypes.c_double(x), digits)
        near = {format(x * share, f".{digits}g") for share in (1.0 - 1e-13, 1.0, 1.0 + 1e-13)}
        assert buffer.value.decode() in near  # ties go either way


@pytest.mark.parametrize("size", [4, 5, 10])
def test_a_text_too_long_ends_in_dots(core, size):
    buffer = ctypes.create_string_buffer(size + 8)
    words = Text(ctypes.cast(buffer, ctypes.c_char_p), size, 0)
    core.library.text_put(ctypes.byref(words), b"abcdefghijklmnop")
    assert buffer.value.decode() == "abcdefghijklmnop"[: size - 4] + "..."
    assert buffer.raw[size:] == b"\0" * 8
