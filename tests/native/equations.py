"""Contact and dry friction as the units compute them: the C functions."""

from __future__ import annotations

import cmath
import ctypes
from collections.abc import Sequence
from ctypes import POINTER, byref, c_bool, c_double, c_int, c_void_p
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from autobalancer.models.rotor import LinearRotor
from autobalancer.models.weights import Weights
from tests.native.core import Complex, Core

STEADY = (0.0, 0.0, 0.0)


class Moved(NamedTuple):
    """State of the weights at the end of a step.

    Attributes:
        angles, speeds: in the rotor [rad, rad/s].
        contacts: 1.0 where a weight lastingly touches the next one along increasing angle.
        impulse: of the collisions on the rotor, in the rotor frame at the step's end [N s].
        events: collisions, contacts that opened, weights that stuck or broke away.
        turning: of the collisions on the shaft, about the plane's centre [N m s].
    """

    angles: list[float]
    speeds: list[float]
    contacts: list[float]
    impulse: complex
    events: int
    turning: float


class Track:
    """Weights on one track.

    Args:
        weights: as points.
        weight_radius, restitution, rolling_resistance, offset, mobility: as in `BallBalancer`.
        lobes: of the race: how many, amplitude [m], angle [rad].

    Attributes:
        alpha: half the angle between weights that touch [rad].
    """

    def __init__(
        self,
        core: Core,
        weights: Weights,
        weight_radius: float = 0.0,
        restitution: float = 0.0,
        rolling_resistance: float = 0.0,
        offset: complex = 0j,
        mobility: float = 0.0,
        lobes: Sequence[tuple[int, float, float]] = (),
    ) -> None:
        self.core, self.weights = core, weights
        self.restitution, self.rolling_resistance = restitution, rolling_resistance
        self.offset = offset
        w = weights
        points = core.structures.Weights(w.count, w.mass, w.track_radius, w.drag, w.kappa)
        if w.unequal:
            ratios = [[one.mass / w.mass, one.drag / (w.drag or 1.0)] for one in w.each]
            sizes = [one.radius / w.radius if w.radius else 1.0 for one in w.each]
            self._each = np.array([*np.transpose(ratios), sizes])
            points.each = _pointer(self._each)
        self._lobes = np.array(lobes, float)
        points.lobes, points.lobe = len(lobes), _pointer(self._lobes)
        self.native = core.structures.Track(
            points, weight_radius, restitution, mobility, rolling_resistance,
            Complex(offset.real, offset.imag),
        )  # fmt: skip
        core.demand("track_prepare", byref(self.native))
        self.alpha = float(self.native.alpha)
        self._carried = c_void_p(core("carried_of", byref(self.native)))

    def advance(
        self,
        angles: Sequence[float],
        speeds: Sequence[float],
        contacts: Sequence[float],
        signal: Sequence[complex],
        rotor_speed: float,
        angular_acceleration: float,
        step: float,
        rates: Sequence[float] = STEADY,
    ) -> Moved:
        """Motion over a step; `signal` (4,) of the plane's centre, `rates` (3,) of w'."""
        ends = _arrays(angles, speeds, contacts)
        moved = self.core.structures.Moved(*map(_pointer, ends))
        centre = self.core.centre_motion(signal, rotor_speed, [angular_acceleration, *rates])
        self.core.demand(
            "carried_advance", self._carried, centre, float(step), c_bool(False), byref(moved)
        )
        impulse = complex(moved.impulse.re, moved.impulse.im)
        return Moved(*(e.tolist() for e in ends), impulse, moved.events, moved.turning)

    def reaction(self, *motion: Any) -> list[complex]:
        """Force on the rotor and its slope, rotor frame, without N m a and without impulses.

        Args:
            motion: as of `_reaction`.
        """
        return self._reaction(*motion)[0].tolist()

    def torque(self, *motion: Any) -> float:
        """Torque on the rotor about the plane's centre, without impulses; as `reaction`."""
        return float(self._reaction(*motion)[1][0])

    def _reaction(
        self,
        angles: Sequence[float],
        speeds: Sequence[float],
        contacts: Sequence[float],
        acceleration: complex,
        slope: complex,
        rotor_speed: float,
        *spin_up: float,
    ) -> tuple[np.ndarray, np.ndarray]:
        """Force and torque, each with its slope."""
        found, torque = np.empty(2, complex), np.empty(2)
        now = self.core.instant([acceleration, slope], 0.0, rotor_speed, *spin_up)
        self.core.demand(
            "carried_push", self._carried, *_arrays(angles, speeds, contacts), byref(now), found,
            torque,
        )  # fmt: skip
        return found, torque

    def static_moment(self, angles: Sequence[float]) -> complex:
        """Sum of m (e + R e^{i theta}) [kg m]."""
        found = self.core("track_static_moment", byref(self.native), *_arrays(angles), None)
        return complex(found.re, found.im)


def run(track, angles, speeds, signal, speed, seconds, steps, contacts=None):
    """Angles, rates, contacts, sum of impulses in fixed axes, number of events."""
    state = list(angles), list(speeds), list(contacts or [0.0] * len(angles))
    h, events, impulse = seconds / steps, 0, 0j
    for k in range(steps):
        moved = track.advance(*state, signal(k * h), speed, 0.0, h)
        state = moved.angles, moved.speeds, moved.contacts
        events += moved.events
        impulse += moved.impulse * cmath.exp(1j * speed * (k + 1) * h)
    return (*state, impulse, events)


def whirling(size: float, rate: float, more: float = 0.0):
    """A signal: two turning vectors, with exact derivatives."""

    def signal(t: float):
        first, second = size * cmath.exp(1j * rate * t), more * cmath.exp(-2.3j * t)
        return tuple((1j * rate) ** k * first + (-2.3j) ** k * second for k in range(4))

    return signal


def discharge(
    core: Core, owed: complex, pulse: complex, impulse: complex, turn: float, step: float
) -> tuple[complex, complex]:
    """Impulse owed after a step, and the pulse of force at its end."""
    left = Complex(owed.real, owed.imag)
    given = core("pulse_ahead", complex(pulse), float(turn), float(step), byref(left))
    return complex(left.re, left.im) + impulse, complex(given.re, given.im)


class Excitation(NamedTuple):
    """What moves a rotor over a step.

    Attributes:
        forces: (4, p) complex, of the planes, and their derivatives.
        angle, speed: of the rotor.
        spin_up: its angular acceleration and the derivatives of that of order 1 to 3.
    """

    forces: NDArray[np.complex128]
    angle: float
    speed: float
    spin_up: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)


class _Slider(ctypes.Structure):
    _fields_ = (
        *(("station", c_int), ("axis", c_int), ("row", POINTER(c_double)), ("support", c_int)),
        *((name, c_double) for name in ("limit", "stiffness", "stroke", "centre")),
    )


class Friction:
    """Step of a rotor with dry friction in its supports.

    States are (q, v), x and y alternating; `held` (m, 4) is the direction of slip and the force of
    every slider, its side and its place in a free stroke.
    """

    def __init__(self, core: Core, rotor: LinearRotor, turning_force: bool = True) -> None:
        self.core, self.dof, self.turning = core, 2 * rotor.stations, turning_force
        count, native = len(rotor.sliders), core.rotor_of(rotor)
        native.sliders = count
        self._sliders = (_Slider * count)(
            *((s.station, s.axis, None, 0, s.limit, s.stiffness, 0.0, 0.0) for s in rotor.sliders)
        )
        self._native = core.taylor_step(native, self._sliders, count)

    def at_start(self, state: NDArray) -> NDArray:
        """Sliders with slack springs; rigid ones slip with the rotor."""
        held, count = np.zeros((len(self._sliders), 4)), len(self._sliders)
        places, rates = np.split(np.array(state, float), [self.dof])
        stations = self.dof // 2
        self.core("friction_at_start", self._sliders, count, stations, places, rates, held)
        return held

    def advance(
        self, state: NDArray, held: NDArray, excitation: Excitation, step: float
    ) -> tuple[NDArray, NDArray]:
        """State and sliders one step later."""
        state, held, forces = state.copy(), held.copy(), np.ascontiguousarray(excitation.forces)
        by = excitation
        given = self.core.excitation(forces, self.turning, by.angle, by.speed, *by.spin_up)
        reached = c_double(step)
        self.core.demand(
            "taylor_advance", byref(self._native), state, held, byref(given), float(step), 0,
            byref(reached),
        )  # fmt: skip
        return state, held


def _arrays(*values: Sequence[float]) -> list[NDArray]:
    return [np.array(v, float) for v in values]


def _pointer(values: NDArray) -> Any:
    return values.ctypes.data_as(POINTER(c_double))
