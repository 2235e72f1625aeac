"""The same bits from any compiler and optimisation, and what both languages refuse of a rotor."""

from __future__ import annotations

import ctypes
import shutil
from ctypes import byref

import numpy as np
import pytest

from autobalancer.models.rotor import LinearRotor

pytestmark = pytest.mark.slow


def _bits(core):
    """What one of each calculation gives, as bytes."""
    random = np.random.default_rng(11)
    x = random.uniform(-1e3, 1e3, 500)
    results = [core.real(name, x) for name in ("sine", "cosine", "natural_exp")]
    results.append(core.real("arc_sine", x / 1e3))
    results.append(core.real("hypotenuse", x, x[::-1].copy()))
    for stiffness in (1e6, (1e6, 3e9)):
        rotor = core.rotor_of(LinearRotor.planar(2.0, stiffness, 40.0, 3.0, 1e-3, 0.3))
        results += [core.step_matrix(rotor, w, 1e-3, True).view(float) for w in (0.0, 310.0)]
    native = core.structures.Weights(3, 0.01, 0.05, 0.05, 1.4)
    angles, speeds, signal = random.normal(size=(3, 8))
    moved, rates = np.zeros(3), np.zeros(3)
    motion = core.centre_motion(signal.view(complex) * 1e3, 0.0, (7.0, 30.0, -2e3, 1e5))
    core.demand(
        "weights_advance", byref(native), angles, speeds, motion, 1e-2, moved, rates,
        byref(core("quadrature_empty")), None,
    )  # fmt: skip
    return b"".join(values.tobytes() for values in [*results, moved, rates, *_contact(core)])


def _contact(core):
    """Where weights are, how fast, and who touches whom, after steps with collisions."""
    points = core.structures.Weights(4, 0.01, 0.05, 0.05, 1.4)
    offset = core.structures.Complex(1e-5, 0.0)
    track = core.structures.Track(points, 0.01, 0.4, 2.0, 1e-3, offset)
    core.demand("track_prepare", byref(track))
    scratch = np.empty(core("track_scratch", 4))
    state = [np.array([0.0, 1.0, 2.0, 4.0]), np.array([9.0, -3.0, 0.0, -8.0]), np.zeros(4)]
    signal, events = [50.0 + 20.0j, 3e3 - 9e2j, 1e5, 1e6j], 0
    motion = core.centre_motion(signal, 200.0, (5.0, 0.0, 0.0, 0.0))
    for _ in range(60):
        ends = [np.empty(4) for _ in range(3)]
        arrays = (x.ctypes.data_as(ctypes.POINTER(ctypes.c_double)) for x in ends)
        moved = core.structures.Moved(*arrays)
        core.demand(
            "track_advance", byref(track), *state, motion, 5e-3, 0, byref(moved), scratch,
        )  # fmt: skip
        state, events = ends, events + moved.events
    assert events > 10
    return state


@pytest.mark.parametrize(
    "compiler", [("cc", "-O0"), ("cc", "-O3", "-funroll-loops"), ("clang", "-O3"), ("clang", "-O0")]
)
def test_results_are_the_same_bits_whatever_compiles_them(core, tmp_path, compiler):
    if shutil.which(compiler[0]) is None:
        pytest.skip(f"{compiler[0]} is not installed")
    other = type(core)(
        core.compile_library(tmp_path / "other.so", compiler[:1], flags=compiler[1:])
    )
    assert _bits(other) == _bits(core)
