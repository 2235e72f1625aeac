"""The C sources as a library for the tests, and the equations' functions by ctypes."""

from __future__ import annotations

import ctypes
import math
import subprocess
from collections.abc import Callable, Sequence
from ctypes import POINTER, byref, c_bool, c_double, c_int, c_size_t, c_void_p
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from autobalancer.fmus.native.build.layout import constants

SOURCES = Path(__file__).parents[2] / "fmus" / "native"
FOLDERS = ("base", "rotor", "weights", "contact", "machine")  # the equations
CARRIED = Path(__file__).parent / "host" / "carried.c"


FLAGS = (
    *("-std=c99", "-O1", "-ffp-contract=off", "-fno-math-errno", "-shared", "-fPIC"),
    *("-Wall", "-Wextra", "-Wno-unused-parameter", "-Wpedantic", "-Werror"),
)


def shared_library(files: Sequence[str], destination: Path, *flags: str) -> Path:
    """Compile by the C compiler of this machine; `flags` come behind `FLAGS`, and win."""
    subprocess.run(["cc", *FLAGS, *flags, *files, "-o", str(destination)], check=True)
    return destination


def compile_library(destination: Path) -> Path:
    """Compile the equations into the shared library `destination`."""
    files = [str(path) for folder in FOLDERS for path in (SOURCES / folder).glob("*.c")]
    files.append(str(CARRIED))
    (destination.parent / "constants.h").write_text(constants())
    return shared_library(files, destination, f"-I{SOURCES}", f"-I{destination.parent}")


class Complex(ctypes.Structure):
    _fields_ = (("re", c_double), ("im", c_double))


class Failure(ctypes.Structure):
    _fields_ = (("code", c_int), ("words", ctypes.c_char * 1024))


def _struct(name: str, doubles: str = "", **fields: Any) -> type[ctypes.Structure]:
    listed = [(key, c_double) for key in doubles.split()] or list(fields.items())
    return type(name, (ctypes.Structure,), {"_fields_": listed})


_D = POINTER(c_double)
_MATRICES = ["mass", "damping_x", "damping_y", "stiffness_x", "stiffness_y"]
_CROSSED = ["damping_xy", "damping_yx", "stiffness_xy", "stiffness_yx"]
_MATRICES += [*_CROSSED, "internal_damping"]
_MATRICES += ["gyroscopic", "planes", "unbalance", "deflection"]
Bearings = _struct(
    "Bearings", count=c_int, speed_count=c_int, line=c_int, speeds=_D, rows=_D, values=_D
)
LinearRotor = _struct(
    "LinearRotor",
    stations=c_int,
    plane_count=c_int,
    deflections=c_int,
    **dict.fromkeys(_MATRICES, _D),
    bearings=Bearings,
    gravity=c_double * 2,
    sliders=c_bool,
    crossed=c_bool,
)
Spin = _struct("Spin", angle=c_double, speed=c_double, rates=c_double * 4)
Excitation = _struct(
    "Excitation",
    forces=_D,
    planes=c_int,
    turning_force=c_bool,
    spin=Spin,
)
Holds = _struct(
    "Holds",
    **dict.fromkeys(["sliders", "cubics", "stops"], c_void_p),
    **dict.fromkeys(["slider_count", "cubic_count", "stop_count"], c_int),
)
Weights = _struct(
    "Weights",
    count=c_int,
    **dict.fromkeys(["mass", "track_radius", "drag", "kappa", "radius"], c_double),
    each=_D,
    lobes=c_int,
    lobe=_D,
)
Track = _struct(
    "Track",
    weights=Weights,
    **dict.fromkeys(["weight_radius", "restitution", "mobility", "rolling_resistance"], c_double),
    offset=Complex,
    **dict.fromkeys(["alpha", "moment"], c_double),
    **dict.fromkeys(["solid", "full", "eventful"], c_bool),
)
Moved = _struct(
    "Moved",
    **dict.fromkeys(["angles", "speeds", "contacts"], _D),
    impulse=Complex,
    turning=c_double,
    events=c_int,
    reached=c_double,
)
CentreMotion = _struct("CentreMotion", signal=Complex * 4, spin=Spin)
Instant = _struct("Instant", motion=Complex * 2, spin=Spin)

STRUCTURES = (
    Complex, Failure, LinearRotor, Spin, Excitation, Weights, Track, Moved, Instant,
)  # fmt: skip

_RETURNS = {
    c_double: (
        "sine cosine natural_exp arc_sine hypotenuse modulo ieee_remainder nearest scaled_by_power"
        " find_first_fall find_polynomial_fall collocated"
    ),
    Complex: "rect track_static_moment hat_half pulse_ahead",
    c_size_t: ("linear_rotor_size step_matrix_scratch taylor_step_size impact_doubles"),
    c_void_p: "carried_of",
    LinearRotor: "linear_rotor_in linear_rotor_with_added_mass",
}


class Refused(Exception):
    """A function returned a failure: its words."""


class Core:
    """The equations in C; arrays take the place of pointers.

    Attributes:
        structures: the C structures, by name.
    """

    def __init__(self, path: Path) -> None:
        self.structures = SimpleNamespace(**{t.__name__: t for t in STRUCTURES})
        self.library = ctypes.CDLL(str(path))
        self._kept: list[Any] = []
        for type_, names in _RETURNS.items():
            for name in names.split():
                getattr(self.library, name).restype = type_

    def __call__(self, name: str, *arguments: Any) -> Any:
        """Call a function: floats go as doubles, arrays as pointers."""
        return getattr(self.library, name)(*map(_argument, arguments))

    def demand(self, name: str, *arguments: Any) -> None:
        """Call a function that may fail, and raise `Refused` when it does."""
        failure = Failure()
        if self(name, *arguments, byref(failure)):
            raise Refused(failure.words.decode())

    def refusal(self, call: Callable[..., object], *arguments: Any) -> str:
        """Words of a call that must fail."""
        with pytest.raises(Refused) as refused:
            call(*arguments)
        return str(refused.value)

    def real(self, name: str, x: NDArray, *others: NDArray) -> NDArray:
        """A function of numbers for each of the arrays' elements."""
        call = getattr(self.library, name)
        call.argtypes = [c_double] * (1 + len(others))
        return np.array([call(*values) for values in zip(x, *others, strict=True)])

    def rotor_of(self, rotor: Any) -> Any:
        """The rotor of a `models.rotor.LinearRotor`."""
        n, p = rotor.stations, rotor.plane_count
        memory = np.zeros(self("linear_rotor_size", n, p))
        made = self("linear_rotor_in", memory, n, p)
        made.memory = memory
        made.gravity[:] = rotor.gravity.real, rotor.gravity.imag
        made.crossed = rotor.crossed
        crossed = {
            f"{name}_{'xy'[a]}{'xy'[1 - a]}": each[a, 1 - a]
            for name, each in (("damping", rotor.dampers), ("stiffness", rotor.springs))
            for a in (0, 1)
        }
        for name in _MATRICES:
            if name != "deflection":
                own = crossed[name] if name in crossed else getattr(rotor, name)
                values = np.ascontiguousarray(own).view(float).ravel()
                ctypes.memmove(getattr(made, name), values.ctypes.data, values.nbytes)
        return made

    def instant(self, motion: Sequence[complex], angle: float, speed: float, *rates: float) -> Any:
        """What drives weights: the acceleration of a centre with its slope, and the rotor."""
        parts = [Complex(z.real, z.imag) for z in map(complex, motion)]
        return Instant((Complex * 2)(*parts), Spin(angle, speed, (c_double * 4)(*rates)))

    def centre_motion(
        self, signal: Sequence[complex], speed: float, spin_up: Sequence[float]
    ) -> Any:
        """How a track's centre moves over a step: a cubic acceleration, and how the rotor turns."""
        parts = [Complex(z.real, z.imag) for z in map(complex, signal)]
        spin = Spin(0.0, speed, (c_double * 4)(*spin_up))
        return byref(CentreMotion((Complex * 4)(*parts), spin))

    def taylor_step(self, rotor: Any, sliders: Any = None, count: int = 0) -> Any:
        """The step at any speed of a rotor made by `rotor_of`, with `count` sliders."""
        n, p = rotor.stations, rotor.plane_count
        held = Holds(ctypes.cast(sliders, c_void_p) if count else None, None, None, count, 0, 0)
        memory = np.full(self("taylor_step_size", n, p, byref(held)), math.nan)
        scratch = np.full(12 * n * n, math.nan)
        made = (c_double * 64)()  # longer than the structure
        self.demand("taylor_step_in", memory, byref(rotor), byref(held), scratch, byref(made))
        self._kept.append((memory, sliders, rotor))
        return made

    def excitation(
        self, forces: NDArray, turning: bool, angle: float, speed: float, *rates: float
    ) -> Any:
        """What moves a rotor: forces (4, p) on the planes, and how it turns."""
        spin = Spin(angle, speed, (c_double * 4)(*rates))
        made = Excitation(forces.ctypes.data_as(_D), forces.shape[1], turning, spin)
        made.kept = forces
        return made

    def step_matrix(self, rotor: Any, speed: float, step: float, turning: bool) -> NDArray:
        """As `models.propagator.step_matrix`, of a rotor made by `rotor_of`.

        C has x and y alternating, Python blocks (x..., y...).
        """
        axes = 1 if self("linear_rotor_isotropic", byref(rotor)) else 2
        sizes = rotor.stations, rotor.plane_count, axes
        shape = self("step_matrix_rows", *sizes), self("step_matrix_columns", *sizes)
        matrix = np.empty(shape, complex if axes == 1 else float)
        scratch = np.full(self("step_matrix_scratch", *sizes), math.nan)
        self.demand("step_matrix", byref(rotor), speed, step, int(turning), matrix, scratch)
        n, p = sizes[:2]
        rows = _alternating([n, n, p, p], axes)
        columns = _alternating([n, n, *[p] * 4, 1], axes)
        return matrix[np.ix_(rows, columns)]


def _alternating(sizes: Sequence[int], axes: int) -> list[int]:
    """Where the elements of blocks (x..., y...) stand in blocks with x and y alternating."""
    starts = axes * np.cumsum([0, *sizes])
    return [
        int(start) + axes * k + axis
        for start, size in zip(starts, sizes, strict=False)
        for axis in range(axes)
        for k in range(size)
    ]


def _argument(value: Any) -> Any:
    if isinstance(value, float):
        return c_double(value)
    if isinstance(value, complex):
        return Complex(value.real, value.imag)
    if isinstance(value, np.ndarray):
        return value.ctypes.data_as(_D)
    return value
