"""Time runs of the coupled equations by SciPy, and the reference with its own error."""

from __future__ import annotations

import itertools
import warnings
from collections.abc import Callable, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import odeint, solve_ivp

from .arrays import Array
from .assembly import Assembly, SpeedProfile
from .reference.colliding import Colliding
from .reference.coupled import REST, Monolith, Start
from .reference.driven import Driven, MotorDriven
from .reference.dry import Dry
from .reference.phases import integrate_phases
from .reference.trajectory import Trajectory, differences

_POINTS = 1001  # at which a run by odeint is read where nothing else is asked for
_TOLD_EVERY = 500  # evaluations
_MOST = 1_000_000  # steps of odeint between two of them
NON_STIFF = ("DOP853", "LSODA")
STIFF = ("Radau", "LSODA")
_STIFF_RATIO = 100.0  # fastest mode over speed from which an explicit method only wastes its steps


class ReferenceDisagreement(ArithmeticError):
    """Two independent methods do not give the same motion: there is no reference."""


def simulate(
    assembly: Assembly,
    profile: SpeedProfile | MotorDriven,
    times: ArrayLike,
    *,
    initial: Start = REST,
    method: str = "DOP853",
    rtol: float = 1e-9,
    progress: Callable[[float], None] | None = None,
) -> Trajectory:
    """Integrate from time 0 and give the motion at `times`.

    Args:
        profile: the speed against time, or the motor that makes it.
        times: (T,) ascending, from 0 on [s].
        method: of `scipy.integrate.solve_ivp`, or "odeint".
        rtol: relative tolerance.
        progress: told the finished fraction; not where something sticks or collides.

    Raises:
        ValueError: weights can collide as well as stick, or something sticks under a motor.
        ArithmeticError: the method gave up, or the motion is not finite.
    """
    time = np.asarray(times, float)
    system = equations(assembly, profile, initial.angle)
    solved = None
    finite = any(m.half_angle for m in assembly.weights)
    if system.dry and finite:
        raise ValueError("weights that collide: not where something sticks")
    if isinstance(system, Driven) and system.dry:
        raise ValueError("what sticks: not under a motor")
    if system.dry or finite:
        bodies = Dry(system) if isinstance(system, Monolith) and system.dry else Colliding(system)
        states, solved = integrate_phases(bodies, time, initial, method=method, rtol=rtol)
    else:
        _, states, _ = integrate(system, time, initial, method=method, rtol=rtol, progress=progress)
    return trajectory(system, time, states, solved)


def equations(
    assembly: Assembly, profile: SpeedProfile | MotorDriven, angle: float = 0.0
) -> Monolith | Driven:
    """Of all in one piece; `angle` [rad] is the rotor's at time 0."""
    if isinstance(profile, MotorDriven):
        return Driven(assembly, profile, angle)
    return Monolith(assembly, profile, angle)


def integrate(
    system: Monolith | Driven,
    time: Array | float,
    initial: Start = REST,
    *,
    method: str,
    rtol: float,
    progress: Callable[[float], None] | None = None,
) -> tuple[Array, Array, int]:
    """Times, states there (T, size), and how often the right-hand side was evaluated.

    This is what `simulate` takes its time for; `trajectory` makes signals of the states.

    Args:
        time: ascending times [s], or the end alone: then the times are those of the method's steps.
        progress: told the finished fraction.

    Raises:
        ArithmeticError: the method gave up, or the motion is not finite.
    """
    if system.dry:
        raise ValueError("dry friction: `simulate` integrates it, from event to event")
    state = system.initial(initial)
    absolute = rtol * system.scales(initial)
    listed = None if isinstance(time, float) else time
    end = time if isinstance(time, float) else float(time[-1])
    shown = slice(1 if listed is None or listed[0] == 0.0 else 0)
    times, states = [np.zeros(1)[shown]], [state[None][shown]]
    begin, evaluations = 0.0, 0
    for stop in system.stops(end):
        at, shown = None, slice(1, None)
        if listed is not None:
            at = listed[(listed > begin) & (listed <= stop)]
            shown = slice(len(at))
            at = at if stop in at else np.append(at, stop)
        rhs = _watched(system.between(begin, stop).rhs, end, progress)
        solved = _solve(rhs, begin, stop, state, method, at, rtol, absolute)
        if not solved.success or not np.isfinite(solved.y).all():
            where = solved.t[-1] if len(solved.t) else begin
            raise ArithmeticError(f"{method} stopped after {where:g} s: {solved.message}")
        times.append(solved.t[shown])
        states.append(solved.y.T[shown])
        state, begin = solved.y[:, -1], stop
        evaluations += solved.nfev
    return np.concatenate(times), np.concatenate(states), evaluations


def _watched(
    rhs: Callable[[float, Array], Any], end: float, progress: Callable[[float], None] | None
) -> Callable[[float, Array], Any]:
    """The same that tells at every `_TOLD_EVERY`th evaluation how far it is."""
    if progress is None:
        return rhs
    count = itertools.count()

    def watched(t: float, state: Array) -> Any:
        if next(count) % _TOLD_EVERY == 0:
            progress(t / end)
        return rhs(t, state)

    return watched


def _solve(
    rhs: Callable[[float, Array], Any],
    begin: float,
    end: float,
    state: Array,
    method: str,
    at: Array | None,
    rtol: float,
    absolute: Array,
) -> Any:
    """One stretch by a method of `solve_ivp`, or by "odeint": LSODA without its steps in Python.

    The latter is SciPy's fastest; it has no times of its own and is read at `_POINTS`.
    """
    if method != "odeint":
        return solve_ivp(rhs, (begin, end), state, method, at, rtol=rtol, atol=absolute)
    asked = np.linspace(begin, end, _POINTS) if at is None else at
    times = asked if len(asked) and asked[0] == begin else np.append(begin, asked)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # its message is raised
        states, told = odeint(
            rhs, state, times, tfirst=True, rtol=rtol, atol=absolute, full_output=True, mxstep=_MOST
        )
    first = len(times) - len(asked)
    return SimpleNamespace(
        success=told["message"] == "Integration successful.",
        message=told["message"],
        t=asked,
        y=states[first:].T,
        nfev=int(told["nfe"][-1]) if len(times) > 1 else 0,
    )


def trajectory(
    system: Monolith | Driven,
    time: Array,
    states: Array,
    solved: Sequence[tuple[Array, ...]] | None = None,
) -> Trajectory:
    """Every signal of the states (T, size) that `integrate` found.

    Args:
        solved: accelerations there, where friction or contacts take part in them.
    """
    n, count = system.stations, system.weights
    angle, speed, angular_acceleration = system.turning(time, states)
    if solved is None:
        columns = angle[:, None], speed[:, None], angular_acceleration[:, None]
        cuts = [0, *np.searchsorted(time, [start for start, _ in system.assembly.later]), len(time)]
        parts = [slice(i, j) for i, j in itertools.pairwise(cuts) if j > i]
        found = [
            system.after(time[p][0]).accelerations_of(
                (columns[0][p], columns[1][p], columns[2][p]), states[p]
            )
            for p in parts
        ]
        a, phi2 = map(np.concatenate, zip(*found, strict=True))
    else:
        a = np.array([one[0] for one in solved])
        phi2 = np.array([one[1] for one in solved]).reshape(len(time), count)
        if isinstance(system, Driven):
            angular_acceleration = np.array([one[2] for one in solved])
    theta, theta_1, theta_2, first = {}, {}, {}, 0
    for m in system.assembly.weights:
        part = slice(first, first := first + len(m.angles))
        theta[m.name] = states[:, 4 * n : 4 * n + count][:, part] - angle[:, None]
        theta_1[m.name] = states[:, 4 * n + count :][:, part] - speed[:, None]
        theta_2[m.name] = phi2[:, part] - angular_acceleration[:, None]
    x, y, vx, vy = (states[:, j * n : (j + 1) * n] for j in range(4))
    return Trajectory(
        system.assembly, time, x, y, vx, vy, angle, speed, angular_acceleration,
        a[:, 0], a[:, 1], theta, theta_1, theta_2,
    )  # fmt: skip


def _half(progress: Callable[[float], None] | None, number: int) -> Callable[[float], None] | None:
    """Progress of the first or second of two equal parts."""
    return None if progress is None else lambda share: progress(0.5 * (number + share))


def reference(
    assembly: Assembly,
    profile: SpeedProfile | MotorDriven,
    times: ArrayLike,
    *,
    initial: Start = REST,
    methods: tuple[str, str] | None = None,
    rtol: float = 1e-12,
    bound: float = 1e-7,
    signals: Sequence[str] | None = None,
    progress: Callable[[float], None] | None = None,
) -> tuple[Trajectory, float]:
    """The motion by two independent methods, and the reference's own error.

    Args:
        methods: two of `solve_ivp`'s; by default `NON_STIFF`, or `STIFF` where a mode of the rotor
            or a drag is more than a hundred times faster than everything else turns.
        bound: largest difference that is accepted.
        signals: what the reference is for; by default every state signal.  Weights that heavy drag
            all but fixes move so little that their absolute angles leave few digits of that range:
            2e-7 at a drag of 1e5 m w, where x and y still agree to 2e-10.
        progress: told the finished fraction.

    Returns:
        The first method's trajectory, and the largest difference between the two relative to each
        signal's range (`differences`).

    Raises:
        ReferenceDisagreement: they differ by more than `bound`.
    """
    if methods is None:
        turning = max(profile.top, 1.0 / max(np.max(times), np.finfo(float).tiny))
        turning = max([turning, *(abs(rate) for m in assembly.weights for rate in m.speeds)])
        stiff = equations(assembly, profile).fastest_mode > _STIFF_RATIO * turning
        methods = STIFF if stiff else NON_STIFF
    runs = [
        simulate(
            assembly, profile, times, initial=initial, method=method, rtol=rtol,
            progress=_half(progress, number),
        )
        for number, method in enumerate(methods)
    ]  # fmt: skip
    every = differences(*runs)
    chosen = {name: every[name] for name in (every if signals is None else signals)}
    worst = max(chosen, key=chosen.__getitem__)
    if not chosen[worst] <= bound:
        raise ReferenceDisagreement(
            f"{methods[0]} and {methods[1]} differ by {chosen[worst]:.2e} of the range of {worst}, "
            f"allowed {bound:g}: the motion may be chaotic, or the tolerance {rtol:g} too loose"
        )
    return runs[0], chosen[worst]
