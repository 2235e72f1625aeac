"""The same bits from any compiler and optimisation, and what both languages refuse of a rotor."""

from __future__ import annotations

import ctypes
import math
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
    core.demand(
        "weights_advance", byref(native), angles, speeds, signal * 1e3,
        np.array([7.0, 30.0, -2e3, 1e5]), 1e-2, moved, rates,
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
    signal, events = np.array([50.0, 20.0, 3e3, -9e2, 1e5, 0.0, 0.0, 1e6]), 0
    for _ in range(60):
        ends = [np.empty(4) for _ in range(3)]
        arrays = (x.ctypes.data_as(ctypes.POINTER(ctypes.c_double)) for x in ends)
        moved = core.structures.Moved(*arrays)
        core.demand(
            "track_advance", byref(track), *state, signal, 200.0, np.array([5.0, 0.0, 0.0, 0.0]),
            5e-3, 0, byref(moved), scratch,
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


def _array(values):
    values = np.ascontiguousarray(values, float).ravel()
    return (ctypes.c_double * len(values))(*values)


TWO_SUPPORT = {
    "mass": 12.0,
    "inertia": 0.7,
    "polar_inertia": 0.1,
    "span": 0.8,
    "com": 0.4,
    "stiffness": [[2e5, 2e5], [2e5, 2e5]],
    "damping": [[1.0, 1.0], [1.0, 1.0]],
    "planes": [0.2],
    "unbalances": [(0.2, 1e-4, 0.0)],
}
FLEXIBLE = {
    "stations": [0.0, 0.1, 0.2, 0.4],
    "masses": [1.0, 1.0, 1.0, 1.0],
    "supports": [1, 4],
    "support_stiffness": [[2e5, 2e5], [2e5, 2e5]],
    "support_damping": [[1.0, 1.0], [1.0, 1.0]],
    "bending_stiffness": 1.6e3,
    "internal_damping": 0.0,
    "unbalances": [(0.1, 1e-4, 0.0)],
}


def _native(core, kind, values):
    """The structure of a kind from the arguments of its Python twin."""
    values = dict(values)
    doubles = ("stiffness", "damping", "planes", "unbalances", "stations", "masses", "compliance")
    unbalances = values["unbalances"]
    for name in list(values):
        if name in doubles or name.startswith("support_"):
            values[name] = _array(values[name])
    if kind == "flexible":
        values["supports"] = (ctypes.c_int * 2)(*values["supports"])
        values["ports"] = (ctypes.c_int * 1)(1)
    made = {"two_support": core.structures.TwoSupport, "flexible": core.structures.Flexible}[kind]
    pointers = {k: t for k, t in made._fields_ if t is ctypes.POINTER(ctypes.c_double)}
    for name in values.keys() & pointers:
        values[name] = ctypes.cast(values[name], pointers[name])
    if "ports" in values:
        values["ports"] = ctypes.cast(values["ports"], ctypes.POINTER(ctypes.c_int))
    return made(**values, unbalance_count=len(unbalances))


@pytest.mark.parametrize(
    ("kind", "change", "code", "text"),
    [
        ("two_support", {"mass": 0.0}, "FAILURE_NOT_POSITIVE", "mass"),
        ("two_support", {"span": math.inf}, "FAILURE_NOT_POSITIVE", "span"),
        ("two_support", {"com": math.nan}, "FAILURE_NOT_FINITE", "com"),
        ("two_support", {"polar_inertia": 1.5}, "FAILURE_POLAR_INERTIA", "polar_inertia"),
        ("two_support", {"stiffness": [[1, 1], [0, 1]]}, "FAILURE_NOT_POSITIVE", "stiffness"),
        ("two_support", {"damping": [[1, 1], [-1, 1]]}, "FAILURE_NEGATIVE", "damping"),
        ("two_support", {"unbalances": [(0, -1, 0)]}, "FAILURE_NEGATIVE", "unbalances: amount"),
        ("flexible", {"stations": [0, 0.2, 0.2, 1]}, "FAILURE_STATIONS", "stations"),
        ("flexible", {"masses": [1, 0, 1, 1]}, "FAILURE_STATION_MASS", "masses"),
        ("flexible", {"supports": [2, 2]}, "FAILURE_SUPPORTS", "supports"),
        ("flexible", {"supports": [1, 5]}, "FAILURE_SUPPORTS", "supports"),
        ("flexible", {"internal_damping": -1.0}, "FAILURE_NEGATIVE", "internal_damping"),
        ("flexible", {"bending_stiffness": 0.0}, "FAILURE_NOT_POSITIVE", "bending_stiffness"),
        (
            "flexible",
            {"unbalances": [(1.5, 1, 0)]},
            "FAILURE_UNBALANCE_PLACE",
            "unbalances: position",
        ),
        (
            "flexible",
            {"compliance": [[1e-6, 2e-6], [3e-6, 1e-6]], "bending_stiffness": None},
            "FAILURE_COMPLIANCE",
            "compliance",
        ),
        (
            "flexible",
            {"compliance": [[1e-6, 2e-6], [2e-6, 1e-6]], "bending_stiffness": None},
            "FAILURE_NOT_ELASTIC",
            "compliance",
        ),
    ],
)
def test_rotors_that_python_refuses_are_refused(core, kind, change, code, text):
    good = {"two_support": TWO_SUPPORT, "flexible": FLEXIBLE}[kind]
    values = good | change
    with pytest.raises(ValueError, match=f"^{text}"):
        getattr(LinearRotor, kind)(**values)
    values = {name: value for name, value in values.items() if value is not None}
    stations = 2 if kind == "two_support" else 4
    assert core.rotor(kind, stations, 1, _native(core, kind, good)).stations == stations
    found, failure = core.refusal(core.rotor, kind, stations, 1, _native(core, kind, values))
    assert (found, failure.name.decode()) == (code, text)


def test_internal_damping_of_a_shaft_that_cannot_bend_is_refused(core):
    values = FLEXIBLE | {"stations": [0, 1], "masses": [1, 1], "supports": [1, 2]}
    values |= {"unbalances": [], "internal_damping": 2.0}
    with pytest.raises(ValueError, match="cannot bend"):
        LinearRotor.flexible(**values)
    assert core.refusal(core.rotor, "flexible", 2, 1, _native(core, "flexible", values))[0] == (
        "FAILURE_CANNOT_BEND"
    )
