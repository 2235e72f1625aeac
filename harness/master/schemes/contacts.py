"""Events met: a step ends where a unit says that something jumps, so that it holds no jump.

Weights collide, part, stick or slide; dry supports stick, let go or turn round.  A collision
changes the weights' speeds and with them the force, and its impulse reaches the rotor as a pulse
over the two steps after it (`models.contact.pulse`).  Where a weight comes to rest the force jumps,
where one breaks away or a contact opens its slope does; where a support turns round the
acceleration jumps.  Units that end a step at the first such event tell where it is: the step before
it ends a moment earlier, the event and a collision's pulse are taken in steps so brief that what
they err is lost in rounding, and what follows starts without a past.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from typing import TYPE_CHECKING

from ...errors import SimulationError
from ..signals import Knot
from ..system import System

if TYPE_CHECKING:
    from .iterated import Iterated, Trial

QUIET = 3  # brief steps in which nothing jumps: the event and its pulse are over
AWAITED = 20  # brief steps for an event that corrector passes have put off
JUMP = 1e-6  # of the largest signal: a smooth one leaves its tangent by less in a brief step
GROWTH = 10.0  # brief steps of growth: the measure of a signal that is small so far
KINK = 1e-10  # of the largest signal: by so little its tangent turns in a brief step
SHORTER = (1.0, 0.6, 0.36)  # of a brief step, until passes agree on whether it holds an event
AGREED = 1e-6  # residual of such a step
MOST = 1000  # brief steps: weights that bounce ever faster come to rest in their unit
ROUNDING = 1e-5  # of a pulse: a residual of 1e-10 of that is above what doubles leave


def before(system: System, ahead: float) -> float:
    """Step [s] that ends before an event so far ahead [s]; 0: it is here."""
    return ahead - 0.5 * system.brief if ahead > 2.0 * system.brief else 0.0


def strike(scheme: Iterated, system: System, time: float, passes: int) -> float:
    """Go behind an event that is here; time taken [s].

    Args:
        passes: allowed in every brief step.

    Raises:
        SimulationError: one event follows another without end.
    """
    signals = [*system.forces, *system.accelerations]
    sizes, largest = [signal.largest for signal in signals], scheme.largest
    motion = max((signal.largest for signal in system.accelerations), default=0.0)
    learned, left = copy(scheme.newton), AWAITED
    allowed = scheme.tolerance
    # what is left of a force makes a steep slope in a brief step
    scheme.tolerance = min(allowed, scheme.closed)
    now = time
    for _ in range(MOST):
        system.tell_speed(now)
        trial = _brief(scheme, system, now, passes)
        now += trial.step
        past = [signal.now for signal in signals]
        trial.accept(system)
        pulse = max(abs(force.now[0]) for force in system.forces)
        # a pulse is no measure of what forces may err by, but for its own rounding, nor of how the
        # loop answers them
        scheme.largest, scheme.newton = max(largest, ROUNDING * pulse), copy(learned)
        split = len(system.forces)
        knots = [(then, signal.now) for then, signal in zip(past, signals, strict=True)]
        ways = [
            _way(knots[:split], trial.step, largest),
            _way(knots[split:], trial.step, motion),
        ]
        jumped, turned = (any(found) for found in zip(*ways, strict=True))
        # passes that do not agree disagree on whether the step holds an event; it is soon over
        left = QUIET if jumped or trial.residual > AGREED else left - 1
        if turned:
            left = min(left, QUIET)
        if not left:
            break
    else:
        raise SimulationError(f"weights collide or stick without end at t = {time:g} s")
    scheme.largest, scheme.tolerance = largest, allowed
    for signal, size in zip(signals, sizes, strict=True):
        signal.largest, signal.prediction_error = max(size, abs(signal.now[0])), 0.0
    system.drop_past()
    return now - time


def _way(knots: Sequence[tuple[Knot, Knot]], step: float, largest: float) -> tuple[bool, bool]:
    """Whether any of like signals jumps in a brief step, and whether its slope does."""
    moved = max(abs(end[0] - start[0] - step * start[1]) for start, end in knots)
    turned = step * max(abs(end[1] - start[1]) for start, end in knots)
    grown = step * max(abs(end[1]) for _, end in knots)
    return moved > JUMP * max(largest, GROWTH * grown), turned > KINK * largest


def _brief(scheme: Iterated, system: System, time: float, passes: int) -> Trial:
    """A brief step, not yet accepted."""
    newton = copy(scheme.newton)
    with system.saved() as states:
        for share in SHORTER:
            try:
                trial = scheme.attempt(system, states, time, share * system.brief, passes)
                if trial.residual <= AGREED or share == SHORTER[-1]:
                    break
            except SimulationError:  # a unit cannot follow passes that lead nowhere
                if share == SHORTER[-1]:
                    raise
            system.restore(states)
            scheme.newton = copy(newton)
            if share == SHORTER[-2]:  # weights that stick answer otherwise than those that slide
                scheme.after_start(system, time, SHORTER[-1] * system.brief)
    return trial
