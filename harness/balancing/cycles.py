"""Balancing on the virtual machine: trial runs, corrections, control, by both technologies.

Polushkin 2016: trial runs give the influence coefficients (20), (22); their inverse gives the
unbalances (23), whose opposites are mounted, until a control run finds the grade met.  A cycle is
one such run: what is found in the last one needs no correction any more.

What remains in the correction planes is moved to the supports by the lever before it is compared
with what the grade permits there.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ...models.arrays import Array, Complex
from ...models.papers.influence import (
    from_runs,
    influence,
    scalar_coefficients,
    unbalance_from_response,
)
from ..errors import SceneError
from ..output.outcome import Outcome
from ..output.table import Sheet
from ..output.workers import Progress
from ..scene import Scene
from ..scene.grade import permissible
from .machine import Machine

MOST_CYCLES = 20  # until a technology that does not converge is given up
TRIAL = 10.0  # times what is permissible: seen clearly, and as harmless as the unbalance itself


@dataclass(frozen=True, eq=False)
class Cycle:
    """One run of the machine and what it was taken to mean.

    Attributes:
        mounted: (p,) corrections in place during the run [kg m].
        amplitude: (s,) of the supports [m].
        found: (p,) unbalance by the technology's coefficients [kg m].
        at_supports: (s,) the same, moved to the supports [kg m].
        actual: (p,) unbalance that really is there at this speed, by the rotor's equations [kg m].
        actual_at_supports: (s,) the same at the supports [kg m].
    """

    mounted: Complex
    amplitude: Complex
    found: Complex
    at_supports: Array
    actual: Complex
    actual_at_supports: Array


@dataclass(frozen=True, eq=False)
class Technology:
    """How balancing went with one kind of coefficients.

    Attributes:
        name: "complex" or "scalar".
        coefficients: (s, p) used to tell the unbalance [1/kg].
        cycles: every run, the last one the control run.
        meets: the control run found the grade met.
        actually_met: and so it is, by the unbalance that really is left.
        note: why it ended otherwise.
    """

    name: str
    coefficients: Complex
    cycles: tuple[Cycle, ...]
    meets: bool
    actually_met: bool
    note: str = ""


@dataclass(frozen=True, eq=False, repr=False)
class BalancingReport(Outcome):
    """Everything the machine found out about a scene.

    Attributes:
        name, title, grade: of the scene.
        speed: of the machine [rad/s].
        planes: numbers of the correction planes, from 1.
        permissible: U_per [kg m].
        at_supports: (s,) its share at each support [kg m].
        trial: unbalance of the trial runs [kg m].
        measured: (s, p) coefficients by trial runs [1/kg].
        analytic: (s, p) by the rotor's equations, (15), (17) [1/kg].
        technologies: in the order asked for.
        runs: of the machine in all.
        units: FMUs loaded.
    """

    drawn_by: ClassVar[str] = "..balancing.plot:plot_corrections"
    document_by: ClassVar[str] = "dataclasses:asdict"

    name: str
    title: str
    grade: str
    speed: float
    planes: tuple[int, ...]
    permissible: float
    at_supports: Array
    trial: float
    measured: Complex
    analytic: Complex
    technologies: tuple[Technology, ...]
    runs: int
    units: tuple[str, ...]

    @property
    def met(self) -> bool:
        """Whether the grade is really met, by every technology."""
        return all(technology.actually_met for technology in self.technologies)

    def table(self) -> Sheet:
        """A row for every cycle and plane: what was mounted in it, and what is really left."""
        rows = [
            (t.name, number, plane, *map(float, (abs(on), np.degrees(np.angle(on)), abs(left))))
            for t in self.technologies
            for number, cycle in enumerate(t.cycles, start=1)
            for plane, on, left in zip(self.planes, cycle.mounted, cycle.actual, strict=True)
        ]
        columns = ("coefficients", "cycle", "plane", "mounted [kg m]", "at [deg]", "left [kg m]")
        return Sheet(columns, rows, "lrrrrr", self.title)

    @property
    def difference(self) -> float:
        """Largest relative difference of a measured coefficient from its analytic value."""
        return float((np.abs(self.measured - self.analytic) / np.abs(self.analytic)).max())


def balance(scene: Scene, *, progress: Progress | None = None) -> BalancingReport:
    """See `Scene.balance`."""
    report = progress or (lambda done: None)
    with Machine(scene) as machine:
        setup = machine.setup
        levers = support_levers(scene, machine.planes)
        total, shares = permissible(scene, setup)
        trial = TRIAL * total
        analytic, unbalance = _by_equations(scene, machine.planes, setup.axis)
        first, measured = trial_runs(machine, trial)
        report(0.3)
        done = []
        for name in setup.technologies:
            used = measured
            if name == "scalar":
                # the one phase is that of the first support under the first trial unbalance
                used = scalar_coefficients(measured, float(np.angle(measured[0, 0])))
            done.append(_cycles(machine, name, used, first, levers, shares, unbalance))
            report(0.3 + 0.7 * len(done) / len(setup.technologies))
        return BalancingReport(
            name=scene.name,
            title=scene.heading,
            grade=setup.grade,
            speed=machine.speed,
            planes=tuple(machine.planes),
            permissible=total,
            at_supports=shares,
            trial=trial,
            measured=measured,
            analytic=analytic,
            technologies=tuple(done),
            runs=machine.runs,
            units=tuple(path.name for path in dict.fromkeys(machine.revolution.cosim.paths)),
        )


def trial_runs(machine: Machine, trial: float) -> tuple[Complex, Complex]:
    """(20), (22): the first amplitudes (s,) [m], and the coefficients (s, p)."""
    count = len(machine.planes)
    mounted = trial * np.eye(count + 1, count, -1, complex)  # nothing first, then plane by plane
    amplitudes = np.array([machine.measure(row) for row in mounted])
    return amplitudes[0], from_runs(amplitudes, mounted)


def _cycles(
    machine: Machine,
    name: str,
    used: Complex,
    first: Complex,
    levers: Array,
    allowed: Array,
    unbalance: Complex,
) -> Technology:
    """Correct and run again until what is found is permissible."""
    mounted = np.zeros(len(machine.planes), complex)
    cycles: list[Cycle] = []
    amplitude, meets = first, False
    try:
        while not meets and len(cycles) < MOST_CYCLES:
            if cycles:
                mounted = mounted - cycles[-1].found
                amplitude = machine.measure(mounted)
            found = unbalance_from_response(used, amplitude)
            actual = unbalance + mounted
            sizes = [np.abs(levers @ each) for each in (found, actual)]
            cycles.append(Cycle(mounted, amplitude, found, sizes[0], actual, sizes[1]))
            meets = bool(np.all(sizes[0] <= allowed))
        note = "" if meets else f"grade not met after {len(cycles)} cycles"
    except ValueError as error:
        note = str(error)
    actually_met = meets and bool(np.all(cycles[-1].actual_at_supports <= allowed))
    if meets and not actually_met:
        note = "the control run is wrong: the actual unbalance is above the permissible one"
    return Technology(name, used, tuple(cycles), meets, actually_met, note)


def support_levers(scene: Scene, planes: list[int]) -> Array:
    """(s, p): what an unbalance in each correction plane is at each support of a rigid rotor."""
    return scene.rotor.levers([scene.rotor.planes[p - 1] for p in planes])


def _by_equations(scene: Scene, planes: list[int], axis: str) -> tuple[Complex, Complex]:
    """Coefficients (s, p) [1/kg], and unbalance (p,) of the same effect at the supports [kg m].

    For comparison only: no operator knows what the rotor's equations say.

    Raises:
        SceneError: the supports' vibration does not tell the planes apart.
    """
    rotor, speed = scene.assembly().rotor, scene.profile().end
    sensors = [s - 1 for s in scene.rotor.supports]
    along = "xy".index(axis)
    coefficients = influence(rotor, speed, rotor.planes[[p - 1 for p in planes]])[along][sensors]
    everywhere = influence(rotor, speed, np.eye(rotor.stations))[along][sensors]
    response = everywhere @ rotor.unbalance
    try:
        return coefficients, unbalance_from_response(coefficients, response)
    except ValueError as error:
        raise SceneError(f"{scene.label}: {error}") from None
