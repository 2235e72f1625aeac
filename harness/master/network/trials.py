"""What is not declared about units, found by trial steps at the start.

Units that can be rolled back take trial steps of any length.  Of others nothing can be taken back:
they go ahead in brief steps, so short that nothing moves in them but what acts at once, and these
are a part of the first step.
"""

from __future__ import annotations

from collections.abc import Sequence
from ctypes import c_void_p
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..foreign.abilities import HELD
from ..loop import Vector, of_values, pack, unpack
from ..signals import Cubics, Knots
from .member import Member
from .network import Network
from .wiring import Inlet

PROBE = 1e-3  # of an input's value, or in its unit: a disturbance that shows what depends on it
PROBE_SHARE = 1.0 / 8.0  # of a step: what integrates an input answers that much less


def probe(network: Network, step: float) -> None:
    """Find which held inputs act on outputs directly, of units that can be rolled back.

    An input that is integrated changes an output by less in a shorter step; one that acts directly
    changes it by as much.

    Args:
        step: communication step to come [s].
    """
    for member in network.members:
        unknown = _unknown(member)
        if not unknown:
            continue
        answers = [_answers(member, unknown, length) for length in (step, PROBE_SHARE * step)]
        for inlet, long, short in zip(unknown, *answers, strict=True):
            member.learn(inlet, long, short)


def _unknown(member: Member) -> list[Inlet]:
    """Held inputs that trial steps of other lengths could tell more of."""
    if not member.is_free:
        return []
    return [i for i in member.inlets if i.takes == HELD and i.is_direct is not False]


def _answers(member: Member, inlets: Sequence[Inlet], step: float) -> list[NDArray[np.float64]]:
    """How a unit's outputs change in a step when each of some inputs is changed; taken back."""
    unit, state = member.unit, c_void_p()
    unit.save(state)
    try:

        def after() -> NDArray[np.float64]:
            unit.step(unit.time, step)
            found = member.every_output()
            unit.restore(state)
            return found

        before, found = after(), []
        for inlet in inlets:
            found.append(_changed(member, inlet, after) - before)
    finally:
        unit.restore(state)
        unit.free(state)
    return found


def _changed(member: Member, inlet: Inlet, act: Any) -> Any:
    """What `act` returns while one input of a unit is changed."""
    group = member.unit.group([inlet.variable])
    value = member.unit.get(group)[0]
    member.unit.set(group, [value + PROBE * max(1.0, abs(value))])
    found = act()
    member.unit.set(group, [value])
    return found


class Ahead:
    """A network that goes ahead where it would be rolled back: its steps must be brief.

    Args:
        network: whose units take steps of any length.
        time: where they are [s].
        brief: length of a step [s].

    Attributes:
        time: where they have come to [s].
    """

    def __init__(self, network: Network, time: float, brief: float) -> None:
        self._network, self.time, self.brief = network, time, brief

    def __getattr__(self, name: str) -> Any:
        return getattr(self._network, name)

    def rotor_pass(self, forces: Cubics, _time: float, step: float) -> Knots:
        """`Network.rotor_pass` from where the units are."""
        found = self._network.rotor_pass(forces, self.time, step)
        self.time += step
        return found

    def save(self) -> None:
        """Nothing: units stay where they have come to."""

    def restore(self) -> None:
        """Nothing: units stay where they have come to."""

    def probe(self) -> None:
        """Find which held inputs act on outputs directly, as `probe` does, by going ahead."""
        unknown = {m: found for m in self._network.members if (found := _unknown(m))}
        tried = {m: [i for i in found if not i.is_tried] for m, found in unknown.items()}
        most = max(map(len, tried.values()), default=0)
        lengths = (self.brief, PROBE_SHARE * self.brief)
        changes: dict[tuple[Member, int], list[NDArray[np.float64]]] = {}
        for length in lengths if most else ():
            before = self._outputs(length)
            for number in range(most):
                chosen = {m: i[number] for m, i in tried.items() if number < len(i)}
                there = self._outputs(length, chosen)
                after = self._outputs(length)
                for m in chosen:  # less what the outputs do by themselves
                    changes.setdefault((m, number), []).append(
                        there[m] - 0.5 * (before[m] + after[m])
                    )
                before = after
        for (m, number), (long, short) in changes.items():
            m.learn(tried[m][number], long, short)
            # in brief steps integration does not show, and may be there
            tried[m][number].is_mixed = bool(tried[m][number].is_direct)

    def jacobian(self) -> NDArray[np.float64]:
        """The loop's Jacobian as `loop.jacobian`, of what acts at once, by going ahead.

        What signals do by themselves in a brief step is taken out.
        """
        now = pack(self._network.forces.now, 0.0)

        def respond(u: Vector) -> NDArray[np.float64]:
            signals = self._network.forces.to(unpack(u, 1.0), self.brief)
            self.rotor_pass(signals, self.time, self.brief)
            return pack(self._network.answers, 0.0).view(float)

        size = 2 * len(now)
        found, before = np.zeros((size, size)), respond(now)
        for place in np.flatnonzero(of_values(found)):
            change = np.zeros(size)
            change[place] = PROBE * max(1.0, abs(now.view(float)[place]))
            there, after = respond(now + change.view(complex)), respond(now)
            found[:, place] = (there - 0.5 * (before + after)) / change[place]
            before = after
        found[2:, 2:] += found[:-2, :-2] * ~of_values(found)[2:]  # slopes answer as values do
        return found

    def _outputs(
        self, length: float, changed: dict[Member, Inlet] | None = None
    ) -> dict[Member, NDArray[np.float64]]:
        """Outputs of all units behind a brief step, one input of some of them changed."""
        found = {}
        for m in self._network.members:

            def act(m: Member = m) -> NDArray[np.float64]:
                m.unit.step(self.time, length)
                return m.every_output()

            found[m] = _changed(m, changed[m], act) if changed and m in changed else act()
        self.time += length
        return found
