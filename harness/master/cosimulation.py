"""Separate FMUs of a scene, coupled in Python.

Data flow of a step: predicted forces -> rotor -> accelerations -> balancers -> forces; the scheme
decides whether they are compared with the prediction and the step is taken again.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import ExitStack
from functools import partial
from pathlib import Path

from ..errors import SimulationError
from ..scene import Scene
from .compared import Compared, compared_motion
from .coupled import FINER_FIRST, Coupled
from .event_steps import SHORT, before_events, cover_events, stopping_parameters
from .facts import Facts, advice
from .first_steps import divided_doubling, steep_halvings
from .fmu import Fmu
from .limits import FEWEST_CHOSEN, FORCE_ROUNDING, KINK_STEP
from .loop import consistent_start, value_eigenvalues
from .plan import plan
from .runtime import runtime
from .scales import largest_force
from .schedule import brief_step, meets_events, milestones, schedule, step_size
from .schemes import choose
from .simulation import refuse_loose_tolerance
from .system import System
from .unit_files import find_or_build

RUNAWAY = 1e4  # times the largest force there can be: a resonance makes 10 in three turns


class CoSimulation(Coupled):
    """The units of a scene, loaded and connected; restarted and stepped any number of times.

    With a tolerance a run has the fewest steps, and the runs after it divide these
    (`global_error.Controlled`).  With given steps nothing estimates what the signals miss.

    Args:
        scene: what to simulate.
        fmus: directory of ready-made FMUs; by default exactly those needed are built.

    Attributes:
        coupled: whether there is a loop.
        meets_events: whether steps end where a stop is touched, or weights or supports stick.
        time: reached so far [s]; may be set to where a step was to end.

    Raises:
        UnitError: an FMU is missing, corrupt, or of a different build.
        SceneError: the scheme or the order cannot keep a tolerance, and one is given.
    """

    def __init__(self, scene: Scene, *, fmus: Path | None = None) -> None:
        self.scene, self.order, self._fmus = scene, scene.coupling.order, fmus
        refuse_loose_tolerance(scene)
        self.profile = scene.profile()
        self.plan = plan(scene)
        self.runtime = runtime(scene.coupling.units)
        self.paths = find_or_build(self.plan.units, fmus, self.runtime.backend)
        with ExitStack() as stack:
            self.units = {
                one.name: stack.enter_context(Fmu(path, one.name))
                for path, one in zip(self.paths, self.plan.units, strict=True)
            }
            self.system = System(self.plan, self.units, self.order)
            stack.callback(self.system.free_states)
            self._stack = stack.pop_all()
        self.coupled = self.system.coupled
        self.meets_events = self.coupled and meets_events(scene)
        self.gain = self.amplification = self.worst_residual = self.time = 0.0
        self._largest_force, self._brief = largest_force(scene), brief_step(scene)

    def like(self, scene: Scene) -> CoSimulation:
        """A simulation of another scene with the same units, which differs in start values."""
        return CoSimulation(scene, fmus=self._fmus)

    def start(
        self,
        changes: Mapping[str, Mapping[str, float | bool]] | None = None,
        step: float | None = None,
        attempt: int | None = None,
        parts: int = 1,
    ) -> None:
        """Restart all units from the scene's start values, `changes` by unit name on top.

        Args:
            step: communication step to come [s]; by default the scene's.
            attempt: at a first run with a tolerance; each has more steps than the one before.
            parts: of every step of the first run, which this one repeats.

        Raises:
            SimulationError: a unit refuses its parameters, or no consistent start exists.
        """
        self.time = self.worst_residual = 0.0
        self.steps = self.unconverged = 0
        first, self._parts = None, parts
        self._first_steps: list[list[float]] = []
        self._behind_event = False
        if self.scene.coupling.tolerance is not None and self.coupled:
            first = FEWEST_CHOSEN * FINER_FIRST ** (attempt or 0)
        self._schedule = schedule(self.scene, first)
        step = step or step_size(self.scene, first) / self._parts
        self._restart(changes or {})
        self._acceleration, self._changed = self.profile.acceleration(0.0), 0
        self._prepare(step)
        self._leave_initialisation()
        # forces grow with the square of a speed that the start gives instead of the scene's
        speeds = [float(own["speed"]) for own in (changes or {}).values() if "speed" in own]
        faster = max([abs(speed) / self.profile.top for speed in speeds], default=1.0)
        self.system.most = RUNAWAY * self._largest_force * max(1.0, faster) ** 2

    def _restart(self, changes: Mapping[str, Mapping[str, float | bool]]) -> None:
        told = stopping_parameters(self.scene, self._brief) if self.meets_events else {}
        self.system.restart({n: {**told.get(n, {}), **changes.get(n, {})} for n in self.units})

    def _leave_initialisation(self) -> None:
        for unit in self.units.values():
            unit.start()

    def _prepare(self, step: float) -> None:
        """Bring the units to a consistent start, and make the scheme for this loop."""
        system, rounding = self.system, FORCE_ROUNDING * self._largest_force
        slopes = consistent_start(system, step, rounding)
        eigenvalues = value_eigenvalues(slopes[: slopes.shape[1]])
        self.gain = max(map(abs, eigenvalues), default=0.0)
        self.scheme = choose(self.scene, system, slopes, step, self.gain, rounding)
        self.amplification = self.scheme.amplification(eigenvalues, system.order)

    @property
    def scheme_name(self) -> str:
        """As the scene calls it."""
        return self.scene.coupling.scheme

    def _bounds(self) -> list[float]:
        return milestones(self.scene)

    def _about_loop(self, error: SimulationError) -> str:
        return f"loop gain {self.gain:.3g}{advice(error, self.scene)}"

    def _cross_jump(self, step: float) -> float:
        """Cross a jump of the drive here, if there is one; the part of the step that took [s]."""
        if not self._drive_jumps():
            return 0.0
        negligible = min(KINK_STEP * step, brief_step(self.scene))
        self.scheme.cross_jump(self.system, self.time, negligible)
        self.system.drop_past()
        self.time += negligible
        return negligible

    def _cover(self, step: float) -> None:
        """A communication step: behind a jump of the drive, and divided where there is no past."""
        started, begin = self.system.has_no_past and not self._behind_event, self.time
        left = step - self._cross_jump(step)
        halvings = self.scheme.startup_halvings
        if self.system.has_no_past and (started or halvings):
            halvings = steep_halvings(self.system, self._parts * step, halvings)
            self._first_steps = divided_doubling(halvings, self._parts)
        shares = self._first_steps.pop(0) if self._first_steps else [1.0]
        for number, share in enumerate(shares):
            if number:
                self._drive_jumps()
            self._advance_part(share * left)
        if started and len(shares) > 1:
            before_events(step, partial(self.scheme.after_start, self.system, self.time))
        self.time = begin + step

    def _advance_part(self, step: float) -> None:
        """A part of a communication step, in steps that end at the rotor's events."""
        if not self.meets_events:
            self._advance(step)
            return
        begin = self.time

        def advance(part: float, at_event: bool, tolerant: bool = False) -> bool:
            if self.time != begin:
                self._drive_jumps()
            self._behind_event = at_event or part < SHORT * step
            agrees = self._advance(part, self._behind_event, tolerant)
            if self._behind_event:
                self.system.drop_past()
            return agrees

        cover_events(step, self._brief, advance)

    def _drive_jumps(self) -> bool:
        """Write changing speed and unbalance to the units; whether a force jumps with them."""
        changes = self.scene.operation.unbalance_changes
        changed, self._changed = self._changed, sum(c.time <= self.time for c in changes)
        for change in changes[changed : self._changed]:
            names = self.scene.rotor.unbalance_names[change.number - 1]
            self.system.rotor.set(self.system.rotor.group(names), (change.amount, change.angle))
        jumps = self._changed != changed
        if not self._acceleration and self.time >= self.profile.seconds:
            return jumps
        before, self._acceleration = self._acceleration, self.profile.acceleration(self.time)
        self.system.drive(self.profile.speed(self.time), self._acceleration)
        return jumps or self._acceleration != before

    def compared(self) -> Compared:
        """What the runs of this motion are compared by."""
        return compared_motion(self.scene, self.meets_events)

    def facts(self) -> Facts:
        """What the run since the last start did."""
        units, kinds = self.units.values(), self.system.rotor.calls
        return Facts(
            scene=self.scene,
            files=tuple(path.name for path in dict.fromkeys(self.paths)),
            note=self.runtime.note,
            messages=tuple(message for unit in units for message in unit.messages),
            calls={kind: sum(unit.calls[kind] for unit in units) for kind in kinds},
            passes=self.system.rotor.calls["step"],
            steps=self.steps,
            unconverged=self.unconverged,
            worst_residual=self.worst_residual,
        )
