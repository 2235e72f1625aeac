"""One random scene: run as it is, integrated independently, and what came of it."""

from __future__ import annotations

import time as clock
import traceback
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from autobalancer.harness import Scene
from autobalancer.harness.errors import SimulationError, UserError
from autobalancer.harness.master.limits import STATED_ERROR
from autobalancer.harness.master.names import kin
from autobalancer.harness.result.result import Result
from autobalancer.harness.result.run import cosimulate
from autobalancer.harness.scene.begin import motion_at_start
from autobalancer.harness.scene.plausible import ImplausibleWarning
from autobalancer.models.assembly import Assembly
from autobalancer.models.monolith import reference, simulate
from tests.studies.truth import compiled
from tests.studies.truth.draw import draw

RIGHT = 0.01  # of a signal's largest value: a picture would not show more
GROSS = 0.05
FACTOR = 3.0  # by which a stated or promised error may be exceeded
DISTURBANCE = 1e-9  # of the start's scales: what chaos makes of it is no fault of a method
CHAOTIC = 1e-3 / DISTURBANCE  # growth from which nobody knows the end to a tenth of RIGHT
REFERENCE_BOUND = 1e-3  # the two integrations agree to a tenth of RIGHT
RESOLVED = 1e-6  # of a signal's largest value: what the integrations know of it
RTOLS = 1e-10, 1e-12  # of the reference; the finer before a run or its estimate counts as wrong
SINGLE = 30.0  # times what both neighbours are off: a point that is alone on one side of a jump
LONGEST_RUN = 120.0  # s of processor time

OUTCOMES = {
    "right": f"right to {RIGHT:.0%}, or to {FACTOR:g} times the tolerance",
    "honest": f"wrong, and the run states its error within a factor of {FACTOR:g}",
    "not known": "wrong, and the run says that its error is not known",
    "understated": f"wrong by more than {FACTOR:g} times what the run states",
    "note": "wrong, with a note that has no figure",
    "silent": f"wrong by {RIGHT:.0%} to {GROSS:.0%}, nothing said",
    "gross": f"wrong by more than {GROSS:.0%}, nothing said",
    "needless": "refused, though right when it is let go on",
    "refused": "refused, with a reason",
    "endless": f"not done in {LONGEST_RUN:g} s of processor time",
    "chaotic": "set aside: neighbouring motions part too far",
    "unknown": "set aside: no reference",
    "crashed": "ended in another error than a refusal",
}
SET_ASIDE = ("chaotic", "unknown")
MISSES = ("understated", "note", "silent", "gross", "needless", "endless", "crashed")


@dataclass(frozen=True)
class Verdict:
    """What came of one scene.

    Attributes:
        family, number: which scene.
        outcome: a key of `OUTCOMES`.
        error: largest error over a signal's largest value; None where there is none.
        where: the signal that errs most.
        stated: error that the run states of itself, relative; 0: none.
        words: the refusal or the note.
        steps: communication steps of the run.
        seconds: processor time of the run.
        estimate: the result's own estimate of its error, however small.
        within: whether the error is at most `FACTOR` times the estimate, as far as the reference
            tells; None where there is no reference, or the run says that it is not known.
        error_known: whether the run says that it knows its error.
    """

    family: str
    number: int
    outcome: str
    error: float | None = None
    where: str = ""
    stated: float = 0.0
    words: str = ""
    steps: int = 0
    seconds: float = 0.0
    estimate: float = 0.0
    within: bool | None = None
    error_known: bool = True


class _Endless(Exception):
    """A run that takes longer than `LONGEST_RUN`."""


def judge(
    family: str,
    seed: int,
    number: int,
    changes: Mapping[str, Any] | None = None,
    separate: bool = False,
) -> Verdict:
    """Draw a scene, run it and compare.

    Args:
        changes: keys replaced in every scene, such as `coupling.tolerance`.
        separate: run it on separate FMUs; whether a refusal was needless they say in any case.
    """
    verdict = Verdict(family, number, "crashed")
    try:
        scene = Scene.from_document(draw(family, seed, number)).replace(changes or {})
        return _compared(scene, verdict, separate)
    except Exception:
        return replace(verdict, words=traceback.format_exc(limit=-3))


def _run(scene: Scene, separate: bool = False) -> Result:
    begun = clock.process_time()

    def limit(_done: float) -> None:
        if clock.process_time() - begun > LONGEST_RUN:
            raise _Endless

    with warnings.catch_warnings():  # random scenes are as a rule implausible
        warnings.simplefilter("ignore", ImplausibleWarning)
        return cosimulate(scene, progress=limit, separate=separate)


def _compared(scene: Scene, verdict: Verdict, separate: bool) -> Verdict:
    begun = clock.process_time()
    try:
        result = _run(scene, separate)
    except _Endless:
        return replace(verdict, outcome="endless", seconds=LONGEST_RUN)
    except (SimulationError, UserError) as refusal:
        seconds = clock.process_time() - begun
        outcome = "needless" if right_if_let_go_on(scene) else "refused"
        return replace(verdict, outcome=outcome, words=str(refusal), seconds=seconds)
    verdict = replace(verdict, steps=result.steps, seconds=clock.process_time() - begun)
    for rtol in RTOLS:
        try:
            right, own = referred(scene, result, rtol)
        except ArithmeticError as error:  # of the references: they disagree, or one does not end
            known = result.error_known  # of impacts that nobody can follow it should not be
            return replace(verdict, outcome="unknown", words=str(error), error_known=known)
        verdict = _against(scene, result, verdict, right, own)
        outcome = classify(verdict, scene.coupling.tolerance if scene.asks_for_coupling else None)
        if outcome not in MISSES and (verdict.within or not verdict.error_known):
            break
    if outcome in MISSES and growth(scene, result.time) > CHAOTIC:
        outcome = "chaotic"
    return replace(verdict, outcome=outcome)


def _against(
    scene: Scene, result: Result, verdict: Verdict, right: Mapping[str, NDArray], own: float
) -> Verdict:
    """The verdict with how far a result is off, and what it says of that."""
    errors = deviations(result, right)
    where = max(errors, key=lambda name: errors[name])
    said = scene.coupling.tolerance or STATED_ERROR
    estimate = result.estimated_error
    return replace(
        verdict,
        error=errors[where],
        where=where,
        estimate=estimate,
        within=errors[where] <= FACTOR * estimate + max(own, RESOLVED)
        if result.error_known
        else None,
        error_known=result.error_known,
        stated=estimate if estimate >= said else 0.0,
        words="; ".join(result.events),
    )


def right_if_let_go_on(scene: Scene) -> bool:
    """Whether a refused run ends right on separate FMUs, which estimate no error of given steps."""
    try:
        result = _run(scene, separate=True)
        return max(deviations(result, motion(scene, result)).values()) <= RIGHT
    except (_Endless, SimulationError, UserError, ArithmeticError):
        return False


def classify(verdict: Verdict, tolerance: float | None) -> str:
    """Outcome of a run that ended, by its error and by what it says of itself."""
    assert verdict.error is not None
    allowed = RIGHT if tolerance is None else FACTOR * tolerance
    if verdict.error <= allowed:
        return "right"
    if not verdict.error_known:
        return "not known"
    if verdict.stated:
        return "honest" if verdict.error <= FACTOR * verdict.stated else "understated"
    if verdict.words:
        return "note"
    return "gross" if not verdict.error <= max(GROSS, allowed) else "silent"


def deviations(result: Result, right: Mapping[str, NDArray]) -> dict[str, float]:
    """Largest error of every kind of motion over its own largest value.

    x and y of a station belong together, and so do the parts of a balancer's moment: a component
    that stays near zero is no scale of its own.
    """
    found = {}
    for name, scale in scales(right).items():
        jumps = name.endswith(".speed")
        apart = beside_jumps(result[name], right[name]) if jumps else result[name] - right[name]
        error = float(np.abs(apart).max())
        found[name] = error / scale if scale > 0.0 else error
    return found


def beside_jumps(found: NDArray, right: NDArray) -> NDArray:
    """How far each value is off, where single points may be on the other side of a jump.

    A record has points at the instants of impacts.  There the right speed is any between those
    before and after, as long as it is right at both neighbouring points: one that stays wrong for
    two points is wrong by all that it is off.
    """
    apart = found - right
    inner, beside = np.abs(apart[1:-1]), np.maximum(np.abs(apart[:-2]), np.abs(apart[2:]))
    three = np.array([right[:-2], right[1:-1], right[2:]])
    nearest = np.clip(found[1:-1], three.min(axis=0), three.max(axis=0))
    single = inner > SINGLE * beside
    apart[1:-1] = np.where(single, np.maximum(np.abs(found[1:-1] - nearest), beside), apart[1:-1])
    return apart


def scales(signals: Mapping[str, NDArray]) -> dict[str, float]:
    """Largest value of every signal's kind."""
    largest = {name: float(np.abs(values).max()) for name, values in signals.items()}
    return {name: max(largest[other] for other in kin(name, largest)) for name in largest}


def motion(scene: Scene, result: Result) -> dict[str, NDArray]:
    """What the result's signals should be, see `referred`."""
    return referred(scene, result)[0]


def referred(
    scene: Scene, result: Result, rtol: float = RTOLS[0]
) -> tuple[dict[str, NDArray], float]:
    """What the result's signals should be, by an independent integration, and its own error.

    Raises:
        ReferenceDisagreement: two integrations of the reference differ.
    """
    names = [n for n in result.signals if not n.endswith((".angle", ".clearance"))]
    assembly, drive = scene.assembly(), scene.operation.drive()
    refer = compiled.reference if compiled.covers(assembly, drive) else reference
    right, own = refer(
        assembly,
        drive,
        result.time,
        initial=motion_at_start(scene),
        rtol=rtol,
        bound=REFERENCE_BOUND,
        signals=[n for n in names if n.endswith((".x", ".y"))],
    )
    return {name: right.signal(name) for name in names}, own


def growth(scene: Scene, times: NDArray) -> float:
    """How many times as large a small turn of every first weight is at most by the end."""
    start, drive = motion_at_start(scene), scene.operation.drive()
    ends = []
    for turn in (0.0, DISTURBANCE):
        assembly = _turned(scene.assembly(), turn)
        move = compiled.simulate if compiled.covers(assembly, drive) else simulate
        run = move(assembly, drive, times, initial=start, rtol=RTOLS[0])
        ends.append([run.moment(m.name) for m in assembly.weights])
    parted = [float(np.abs(b - a).max() / np.abs(a).max()) for a, b in zip(*ends, strict=True)]
    return max(parted, default=0.0) / DISTURBANCE


def _turned(assembly: Assembly, turn: float) -> Assembly:
    """The assembly with the first weight of every balancer turned [rad] at the start."""
    balancers = [
        replace(m, angles=(m.angles[0] + turn, *m.angles[1:])) if m.angles else m
        for m in assembly.balancers
    ]
    return replace(assembly, balancers=tuple(balancers))
