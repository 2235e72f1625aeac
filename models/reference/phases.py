"""Integration from event to event: between two events of what collides or sticks, a phase holds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Protocol

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import OptimizeResult

from ..arrays import Array
from .coupled import Start

LONGEST = 0.3  # rad of the fastest turning in a step: nothing may come and go within one
MOST_EVENTS = 5000  # of a run


class Bodies(Protocol):
    """What collides or sticks: bodies that move by one set of equations between two events."""

    system: Any  # a `Monolith`, or a `Driven` where weights collide

    def begin(self, initial: Start, /) -> tuple[Array, Any]:
        """The state at the start, and the phase that holds there."""

    def scales(self, initial: Start, /) -> Array:
        """Sizes of the states, of which tolerances are parts."""

    def accelerations(self, t: float, y: Array, phase: Any, /) -> Any:
        """Of rotor and weights in a state of a phase."""

    def settled(self, t: float, y: Array, phase: Any, /) -> tuple[Array, Any]:
        """State and phase where the system has changed."""

    def rhs(self, t: float, y: Array, phase: Any, /) -> Array:
        """The derivative of the state."""

    def fastest(self, y: Array, /) -> float:
        """Fastest turning [rad/s], which limits a step."""

    @property
    def solve(self) -> Callable[..., OptimizeResult]:
        """Of `t`, the end, a state and a phase: the motion up to the end or the next event."""

    def watched(self, t: float, y: Array, phase: Any, /) -> Array:
        """Values that fall through 0 where the phase ends."""

    def after(self, t: float, y: Array, phase: Any, happened: list[int], /) -> tuple[Array, Any]:
        """State and phase behind the events of these numbers."""


def integrate_phases(
    bodies: Bodies, time: Array, initial: Start, *, method: str, rtol: float
) -> tuple[Array, list[tuple[Array, ...]]]:
    """States at ascending times (T, size), and the accelerations there.

    Raises:
        ArithmeticError: the method gave up, or events do not come to an end.
    """
    whole, t, left = bodies.system, 0.0, MOST_EVENTS
    phase: Any  # of these bodies
    y, phase = bodies.begin(initial)
    absolute = rtol * bodies.scales(initial)
    states, accelerations = [], []

    def keep(at: Array, reached: Sequence[Array] | Array) -> None:
        for moment, state in zip(at, reached, strict=True):
            states.append(state[: whole.size])
            accelerations.append(bodies.accelerations(moment, state, phase))

    if time[0] == 0.0:
        keep(time[:1], [y])
    for stop in whole.stops(float(time[-1])):
        bodies.system = whole.between(t, stop)
        y, phase = bodies.settled(t, y, phase)
        while t < stop:
            done = bodies.solve(t, stop, y, phase, method=method, rtol=rtol, atol=absolute)
            if not done.success or not np.isfinite(done.y).all():
                raise ArithmeticError(f"{method} stopped after {done.t[-1]:g} s: {done.message}")
            at = time[(time > t) & (time <= done.t[-1])]
            if len(at):
                keep(at, done.sol(at).T)
            t, y = float(done.t[-1]), done.y[:, -1]
            happened = [j for j, times in enumerate(done.t_events) if len(times)]
            if happened:
                y, phase = bodies.after(t, y, phase, happened)
            left -= 1
            if not left:
                raise ArithmeticError(f"more than {MOST_EVENTS} events by {t:g} s")
    return np.array(states), accelerations


def solve_to_event(
    bodies: Bodies, t: float, end: float, y: Array, phase: Any, **options: Any
) -> OptimizeResult:
    """The motion from `t` up to `end`, or until a value of `bodies.watched` falls through 0.

    Raises:
        ArithmeticError: SciPy does not find an event between the ends of its step.
    """
    last: list = [None, None, None]

    def value(t: float, y: Array, number: int) -> float:
        if last[0] != t or not np.array_equal(last[1], y):
            last[:] = t, y.copy(), bodies.watched(t, y, phase)  # computed once for all
        return float(last[2][number])

    events = []
    for number in range(len(bodies.watched(t, y, phase))):

        def event(t: float, y: Array, number: int = number) -> float:
            return value(t, y, number)

        event.terminal, event.direction = True, -1  # type: ignore[attr-defined]
        events.append(event)
    try:
        return solve_ivp(
            lambda t, y: bodies.rhs(t, y, phase), (t, end), y, events=events, dense_output=True,
            max_step=LONGEST / bodies.fastest(y), **options,
        )  # fmt: skip
    except ValueError as error:  # its interpolation and its steps may differ in a sign
        raise ArithmeticError(f"an event after {t:g} s is not found: {error}") from None
