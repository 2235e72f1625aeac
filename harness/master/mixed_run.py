"""A scene some of whose parts are FMUs of any origin: the rotor, balancers, or units beside them.

The drive, the schedule and the control of errors are those of `CoSimulation`; the coupling is that
of a network, as nothing is known of such a part but what its description says and its steps show.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any

from ..errors import SceneError, UnitError
from ..scene import Scene
from ..scene.pushed import push_of, read_port
from ..scene.unit import connection_problems, fmu_path
from .compared import Compared, compared_motion
from .cosimulation import CoSimulation
from .facts import Facts
from .fmu import Fmu
from .foreign.abilities import check_start
from .foreign.instance import ForeignUnit
from .foreign.versions import foreign_unit
from .names import components, plane
from .network.fixed_axes import NAME as FIXED
from .network.fixed_axes import FixedForces
from .network.network import Network
from .network.wired import wired
from .network.wiring import Wire, Wiring
from .network.words import notes
from .network_run import LINEAR_ORDER, NetworkRun
from .plan import ROTOR, Plan, UnitPlan, plan
from .runtime import runtime
from .simulation import refuse_loose_tolerance
from .unit_files import Found, find_parts

ADDED_MASS, AS_FORCE = "added_mass", "inertia_as_force"


class DrivenNetwork(Network):
    """A network with a rotor that is driven."""

    def __init__(
        self, units: Mapping[str, Any], wiring: Wiring, planned: Plan, parallel: bool, order: int
    ) -> None:
        super().__init__(units, wiring, parallel, order)
        self.plan, self.rotor = planned, units[ROTOR]
        names = ("speed", "acceleration")
        takers = [units[u.name] for u in planned.units if u.driven]
        has = {unit.name: [n for n in names if n in unit.variables] for unit in takers}
        self._driven = [(unit, unit.group(has[unit.name]), has[unit.name]) for unit in takers]

    def drive(self, speed: float, acceleration: float) -> None:
        """Write the speed at the start of a step, and its rate of change, to units that need it."""
        given = {"speed": speed, "acceleration": acceleration}
        for unit, group, names in self._driven:
            if names:
                unit.set(group, [given[name] for name in names])


class MixedRun(NetworkRun, CoSimulation):
    """The units of a scene with parts of any origin; restarted and stepped any number of times.

    Args:
        scene: what to simulate.
        fmus: directory of ready-made FMUs, ours or not.

    Raises:
        UnitError: an FMU is missing or wrong, or lacks a port.
        SceneError: the scene has a motor, or a coupling that such parts do not have.
    """

    def __init__(self, scene: Scene, *, fmus: Path | None = None) -> None:
        self.scene, self.order, self._fmus = scene, scene.coupling.order, fmus
        self._refuse()
        self.profile, self.plan = scene.profile(), plan(scene)
        self.runtime = runtime(scene.coupling.units)
        self._found = find_parts(self.plan.units, fmus, self.runtime.backend, scene.path)
        self.paths = [part.path for part in self._found]
        self._skipped: dict[str, list[str]] = {}
        with ExitStack() as stack:
            self.units = {}
            for part in self._found:
                self.units[part.unit.name] = stack.enter_context(_loaded(part, scene.label))
            for number, own in enumerate(scene.unit, start=1):
                path, key = fmu_path(own.fmu, scene.path), f"{scene.label}: unit[{number}].fmu"
                self.units[own.name] = guest = stack.enter_context(
                    foreign_unit(path, own.name, key)
                )
                check_start(guest, own.start)
                self.paths.append(path)
            wires, pushed = _wires(scene, self.plan, self.units)
            self._fixed = FixedForces(pushed, self._angle, self.profile.speed) if pushed else None
            if self._fixed:
                self.units[FIXED] = self._fixed
            self.wiring = wired(self.units, wires)
            parallel = scene.coupling.scheme == "jacobi"
            self.system = DrivenNetwork(self.units, self.wiring, self.plan, parallel, self.order)
            stack.callback(self.system.free_states)
            self.refuse_stuck()
            self._stack = stack.pop_all()
        self.coupled = self.system.coupled
        self.gain = self.amplification = self.worst_residual = self.time = 0.0
        self._largest_force = math.inf  # of parts of others nobody knows it

    def _refuse(self) -> None:
        scene = self.scene
        refuse_loose_tolerance(scene)
        if scene.operation.motor or scene.coupling.scheme == "compensated":
            key = "operation.motor" if scene.operation.motor else "coupling.scheme"
            raise SceneError(
                f"{scene.label}: {key}: not with FMUs of any origin: they are coupled by schemes "
                "auto, jacobi, gauss-seidel and iterated, at a prescribed speed"
            )

    def like(self, scene: Scene) -> MixedRun:
        """A simulation of another scene with the same units, which differs in start values."""
        return MixedRun(scene, fmus=self._fmus)

    def _restart(self, changes: Mapping[str, Mapping[str, Any]]) -> None:
        """Restart every unit with what it has of its start values; balancers before the rotor."""
        self.system.free_states()
        carries = {port.variable: sources for port, sources in self.plan.inputs("mass").items()}
        rotor_has = self.units[ROTOR].variables
        rotor: dict[str, Any] = {}
        for one in reversed(self.plan.units):
            start = {**one.start, **changes.get(one.name, {})}
            if one.name == ROTOR:
                start |= rotor
            elif not set(carries) <= set(rotor_has):
                start[AS_FORCE] = True
            self.units[one.name].restart(self._had(one, start))
            if one.name != ROTOR:
                for variable, sources in carries.items():
                    for source in sources:
                        if source.unit == one.name:
                            rotor[variable] = rotor.get(variable, 0.0) + self._mass_of(one.name)
        for own in self.scene.unit:
            self.units[own.name].restart({**own.start, **changes.get(own.name, {})})
        if self._fixed:
            self._fixed.restart({})

    def _angle(self, time: float) -> float:
        """Of the rotor at a time [s], [rad]."""
        return self.profile.angle(time) + self.scene.run.initial.angle

    def _mass_of(self, name: str) -> float:
        unit = self.units[name]
        return unit.get(unit.group([ADDED_MASS]))[0] if ADDED_MASS in unit.variables else 0.0

    def _had(self, one: UnitPlan, start: Mapping[str, Any]) -> dict[str, Any]:
        """Start values that a unit has; the others are told where they mean something."""
        unit = self.units[one.name]
        if not isinstance(unit, ForeignUnit):
            return dict(start)
        kept = {n: v for n, v in start.items() if n in unit.variables}
        off = {n: v for n, v in start.items() if n not in kept and v not in (0.0, False)}
        self._skipped[one.name] = [f"{n} = {v:g}" for n, v in off.items() if n not in _UNUSED]
        return kept

    def _prepare(self, step: float) -> None:
        self.prepare(step)

    def _leave_initialisation(self) -> None:
        """Done by `prepare`, which takes trial steps."""

    def compared(self) -> Compared:
        """What the runs of this motion are compared by; signals that the parts have."""
        found = compared_motion(self.scene, self.meets_events)
        expected = found.expected
        if not self.is_cubic:
            expected = expected._replace(order=min(expected.order, LINEAR_ORDER))
        has = [n for n in found.signals if n.partition(".")[2] in self._of(n).variables]
        signals = list(dict.fromkeys([*has, *self.wiring.signals]))
        return found._replace(expected=expected, signals=signals)

    def _of(self, signal: str) -> Any:
        return self.units[signal.partition(".")[0]]

    def facts(self) -> Facts:
        """What the run since the last start did, and what is not known of its parts."""
        found = super().facts()
        return replace(
            found,
            files=tuple(dict.fromkeys(path.name for path in self.paths)),
            messages=(*self._origins(), *notes(self)),
        )

    def _origins(self) -> list[str]:
        """Which files are not of this installation, and what that means."""
        said = []
        for part in self._found:
            if part.is_own:
                continue
            skipped = self._skipped.get(part.unit.name)
            lacks = f"; it has no {', '.join(skipped)}" if skipped else ""
            said.append(
                f"{part.unit.name}: {part.path} is not of this installation"
                f"{f' ({part.reason})' if part.reason else ''}: its equations, the order of its "
                f"signals and the exactness of its start are not known{lacks}"
            )
        return said


_UNUSED = (AS_FORCE, "speed", "acceleration")


def _loaded(part: Found, label: str) -> Any:
    """The instance of a part; errors about a file that the scene names say by which key."""
    name = part.unit.name
    if part.is_own:
        return Fmu(part.path, name)
    return foreign_unit(part.path, name, f"{label}: {name}.fmu" if part.unit.fmu else "")


def _wires(scene: Scene, planned: Plan, units: Mapping[str, Any]) -> tuple[list[Wire], list[int]]:
    """All connections, of the plan and of the scene; planes with forces along fixed axes."""
    wires: list[Wire] = []
    for target, sources in planned.inputs("signal", "value").items():
        for source in sources:
            balancer = target.unit if target.unit != ROTOR else source.unit
            port = f"{target.unit}.{target.variable}"
            of = f"{scene.label}: balancer {balancer}"
            wires.append(Wire(f"{source.unit}.{source.variable}", port, 1.0, of))
    taken = {wire.target: wire.source for wire in wires}
    own = [
        Wire(
            read_port(c.source, scene.rotor), _pushed_port(c.to, scene, planned), c.factor,
            f"{scene.label}: connection[{number}]",
        )
        for number, c in enumerate(scene.connection, start=1)
    ]  # fmt: skip
    lines: Sequence[str] = connection_problems(scene.connection, units, taken) or [
        f'{wire.where[len(scene.label) + 2 :]}.to = "{c.to}": acts where {other.to} does, which '
        "has a source already; give add = true if their sum is meant"
        for c, wire in zip(scene.connection, own, strict=True)
        for other in [scene.connection[[w.target for w in own].index(wire.target)]]
        if other is not c and not c.add
    ]
    if lines:
        raise UnitError("\n".join(f"{scene.label}: {line}" for line in lines))
    pushed = sorted({_plane_of(w.target) for w in own if w.target.startswith(f"{FIXED}.")})
    turned = [name for number in pushed for name in components(plane(number, "F"))]
    of = f"{scene.label}: forces along fixed axes"
    return [*wires, *own, *(Wire(f"{FIXED}.{n}", f"{ROTOR}.{n}", 1.0, of) for n in turned)], pushed


def _pushed_port(port: str, scene: Scene, planned: Plan) -> str:
    """An input as the units have it; of a force along a fixed axis on our rotor, what turns it."""
    push = None if scene.rotor.fmu else push_of(port)
    if push is None:
        return port
    number = push.number if push.kind == "plane" else planned.pushed[push.kind, push.number]
    return f"{FIXED}.{plane(number, f'F_{push.axis}')}"


def _plane_of(port: str) -> int:
    return int(port[port.index("[") + 1 : port.index("]")])
