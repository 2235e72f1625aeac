"""Runs of colliding weights by `collide.c`: what `models.monolith.simulate` does, in C.

Neither shares code with the units, nor with the other: `tests/models/test_compiled_reference.py`
compares them.
"""

from __future__ import annotations

import ctypes
import subprocess
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate._ivp import dop853_coefficients as table

from autobalancer.models.arrays import Array
from autobalancer.models.assembly import Assembly, SpeedProfile, weights_of
from autobalancer.models.monolith import ReferenceDisagreement, trajectory
from autobalancer.models.reference.colliding import Colliding
from autobalancer.models.reference.coupled import REST, Monolith, Start
from autobalancer.models.reference.trajectory import Trajectory, differences

SOURCE = Path(__file__).parent / "collide.c"
METHODS = "stages", "extrapolation"
_REASONS = (
    "",
    "too many steps",
    "too many events",
    "impacts do not come to an end",
    "the motion is not finite",
    "weights pass through each other",
    "more weights, stations or contacts than it has room for",
)
_Doubles = ctypes.POINTER(ctypes.c_double)


class _Contact(ctypes.Structure):
    _fields_ = (
        *[(name, ctypes.c_int) for name in ("first", "second")],
        *[(name, ctypes.c_double) for name in ("touching", "turns", "restitution")],
    )


class _Machine(ctypes.Structure):
    _fields_ = (
        *[(name, ctypes.c_int) for name in ("stations", "weights", "contacts")],
        ("mass", _Doubles),
        ("stiffness", _Doubles * 4),
        ("damping", _Doubles * 4),
        *[(name, _Doubles) for name in ("internal_damping", "gyroscopic", "unbalance")],
        ("gravity", ctypes.c_double * 2),
        *[(name, _Doubles) for name in ("row", "own", "offset")],
        ("between", ctypes.POINTER(_Contact)),
        *[(name, ctypes.c_double) for name in ("angle", "speed", "acceleration")],
    )


class _Stages(ctypes.Structure):
    _fields_ = (
        ("stages", ctypes.c_int),
        *[(name, _Doubles) for name in ("a", "c", "b", "fifth", "third")],
    )


@cache
def _library() -> ctypes.CDLL:
    """The compiled reference."""
    with TemporaryDirectory(prefix="autobalancer-") as folder:
        made = Path(folder) / "collide.so"
        options = ("-std=c99", "-O2", "-Wall", "-Wextra", "-shared", "-fPIC")
        subprocess.run(["cc", *options, str(SOURCE), "-o", str(made), "-lm"], check=True)
        return ctypes.CDLL(str(made))


def covers(assembly: Assembly, profile: object) -> bool:
    """Whether weights collide on this machine, nothing sticks, and its speed is prescribed."""
    weights = assembly.weights
    finite = any(m.half_angle and len(m.angles) > 1 for m in weights)
    dry = any(m.rolling_resistance for m in weights) or bool(assembly.rotor.sliders)
    return isinstance(profile, SpeedProfile) and finite and not dry


def _pointer(values: ArrayLike, kept: list[Array]) -> ctypes.Array | object:
    kept.append(np.ascontiguousarray(values, float))
    return kept[-1].ctypes.data_as(_Doubles)


def _parts(values: ArrayLike) -> Array:
    """Complex numbers as pairs."""
    numbers = np.asarray(values, complex).ravel()
    return np.stack([numbers.real, numbers.imag], axis=-1)


def _machine(system: Monolith, contacts: ctypes.Array, kept: list[Array]) -> _Machine:
    """What `collide.c` reads; `kept` holds its arrays."""
    assembly, rotor, profile = system.assembly, system.assembly.rotor, system.profile
    each = [(m, one) for m in assembly.weights for one in weights_of(m).each]
    others = [m for m in assembly.balancers if m not in assembly.weights]
    added = np.zeros(rotor.plane_count)
    for m in others:
        added[m.plane] += m.device.added_mass
    machine = _Machine(rotor.stations, len(each), len(contacts))
    machine.mass = _pointer(rotor.with_added_mass(added).mass, kept)
    for k in range(4):
        machine.stiffness[k] = _pointer(rotor.springs[k // 2, k % 2], kept)
        machine.damping[k] = _pointer(rotor.dampers[k // 2, k % 2], kept)
    machine.internal_damping = _pointer(rotor.internal_damping, kept)
    machine.gyroscopic = _pointer(rotor.gyroscopic, kept)
    machine.unbalance = _pointer(_parts(rotor.unbalance), kept)
    machine.gravity[:] = rotor.gravity.real, rotor.gravity.imag
    machine.row = _pointer([rotor.planes[m.plane] for m, _ in each], kept)
    own = [(d.mass, d.track_radius, d.drag, d.kappa, d.radius, 0.0) for _, d in each]
    machine.own = _pointer(own, kept)
    machine.offset = _pointer(_parts([m.offset for m, _ in each]), kept)
    machine.between = contacts
    start = profile.times[0]
    machine.acceleration = profile.acceleration(start)
    machine.speed = profile.speed(start) - machine.acceleration * start
    machine.angle = system.angle - (machine.speed + 0.5 * machine.acceleration * start) * start
    return machine


def _stages(kept: list[Array]) -> _Stages:
    """Order 8 of Prince and Dormand (1981), from SciPy's table."""
    count = table.N_STAGES
    made = _Stages(count)
    made.a, made.c = (
        _pointer(values, kept) for values in (table.A[:count, :count], table.C[:count])
    )
    made.b = _pointer(table.B, kept)
    made.fifth, made.third = (_pointer(values[:count], kept) for values in (table.E5, table.E3))
    return made


def simulate(
    assembly: Assembly,
    profile: SpeedProfile,
    times: ArrayLike,
    *,
    initial: Start = REST,
    method: str = "stages",
    rtol: float = 1e-12,
) -> Trajectory:
    """The motion at `times`, as `models.monolith.simulate`.

    Args:
        method: "stages", an explicit Runge-Kutta method of order 8, or "extrapolation".

    Raises:
        ArithmeticError: a run has no end.
    """
    time = np.asarray(times, float)
    system = Monolith(assembly, profile, initial.angle)
    pairs = Colliding(system)
    contacts = (_Contact * max(1, len(pairs.pairs)))(
        *[_Contact(*pair, pairs.restitution[pair]) for pair in pairs.pairs]
    )
    kept: list[Array] = []
    y, joined = system.initial(initial), np.zeros(max(1, len(pairs.pairs)), np.intc)
    scale, stages = np.ascontiguousarray(system.scales(initial)), _stages(kept)
    states, accelerations = [], []
    events, begin = ctypes.c_int(0), 0.0
    for stop in system.stops(float(time[-1])) or [0.0]:
        stretch = system.between(begin, stop) if stop else system
        machine = _machine(stretch, contacts, kept)
        machine.contacts = len(pairs.pairs)
        shown = time[(time > begin) & (time <= stop)] if begin else time[time <= stop]
        asked = shown if len(shown) and shown[-1] == stop else np.append(shown, stop)
        found = np.empty((len(asked), len(y)))
        moved = np.empty((len(asked), 2 * system.stations + system.weights))
        wrong = _library().integrate(
            ctypes.byref(machine),
            ctypes.byref(stages) if method == "stages" else None,
            ctypes.c_double(rtol),
            scale.ctypes.data_as(_Doubles),
            ctypes.c_double(begin),
            int(not begin),
            len(asked),
            np.ascontiguousarray(asked).ctypes.data_as(_Doubles),
            y.ctypes.data_as(_Doubles),
            joined.ctypes.data_as(ctypes.POINTER(ctypes.c_int)),
            found.ctypes.data_as(_Doubles),
            moved.ctypes.data_as(_Doubles),
            ctypes.byref(events),
        )
        if wrong:
            reason = _REASONS[wrong] if wrong < len(_REASONS) else "the motion is not finite"
            raise ArithmeticError(f"between {begin:g} and {stop:g} s: {reason}")
        states.append(found[: len(shown)])
        accelerations.append(moved[: len(shown)])
        begin = stop
    lateral = 2 * system.stations
    solved = [(a[:lateral].reshape(2, -1), a[lateral:]) for a in np.concatenate(accelerations)]
    return trajectory(system, time, np.concatenate(states), solved)


def reference(
    assembly: Assembly,
    profile: SpeedProfile,
    times: ArrayLike,
    *,
    initial: Start = REST,
    rtol: float = 1e-12,
    bound: float = 1e-7,
    signals: Sequence[str] | None = None,
) -> tuple[Trajectory, float]:
    """The motion by both methods, and the reference's own error, as `models.monolith.reference`.

    Raises:
        ReferenceDisagreement: they differ by more than `bound`.
    """
    runs = [
        simulate(assembly, profile, times, initial=initial, method=method, rtol=rtol)
        for method in METHODS
    ]
    every = differences(*runs)
    chosen = {name: every[name] for name in (every if signals is None else signals)}
    worst = max(chosen, key=chosen.__getitem__)
    if not chosen[worst] <= bound:
        raise ReferenceDisagreement(
            f"{' and '.join(METHODS)} differ by {chosen[worst]:.2e} of the range of {worst}, "
            f"allowed {bound:g}: the motion may be chaotic"
        )
    return runs[0], chosen[worst]
