"""One random scene: run as it is, integrated independently, and what came of it."""

from __future__ import annotations

import time as clock
import traceback
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...models.assembly import Assembly
from ...models.monolith import ReferenceDisagreement, reference, simulate
from ..errors import SimulationError, UserError
from ..master.cosimulation import cosimulate
from ..master.resolution import SAID
from ..master.result import Result
from ..scene import Scene
from .draw import draw

RIGHT = 0.01  # of a signal's largest value: a picture would not show more
GROSS = 0.05
FACTOR = 3.0  # by which a stated or promised error may be exceeded
DISTURBANCE = 1e-9  # of the start's scales: what chaos makes of it is no fault of a method
CHAOTIC = 1e-3 / DISTURBANCE  # growth from which nobody knows the end to a tenth of RIGHT
REFERENCE_BOUND = 1e-3  # the two integrations agree to a tenth of RIGHT
RTOL = 1e-10

OUTCOMES = {
    "right": f"right to {RIGHT:.0%}, or to {FACTOR:g} times the tolerance",
    "honest": f"wrong, and the run states its error within a factor of {FACTOR:g}",
    "understated": f"wrong by more than {FACTOR:g} times what the run states",
    "note": "wrong, with a note that has no figure",
    "silent": f"wrong by {RIGHT:.0%} to {GROSS:.0%}, nothing said",
    "gross": f"wrong by more than {GROSS:.0%}, nothing said",
    "refused": "refused, with a reason",
    "chaotic": "set aside: neighbouring motions part too far",
    "unknown": "set aside: two integrations disagree",
    "crashed": "ended in another error than a refusal",
}
SET_ASIDE = ("chaotic", "unknown")
MISSES = ("understated", "note", "silent", "gross", "crashed")


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


def judge(family: str, seed: int, number: int, changes: Mapping[str, Any] | None = None) -> Verdict:
    """Draw a scene, run it and compare.

    Args:
        changes: keys replaced in every scene, such as `coupling.tolerance`.
    """
    verdict = Verdict(family, number, "crashed")
    try:
        scene = Scene.from_document(draw(family, seed, number)).replace(changes or {})
        return _compared(scene, verdict)
    except Exception:
        return replace(verdict, words=traceback.format_exc(limit=-3))


def _compared(scene: Scene, verdict: Verdict) -> Verdict:
    begun = clock.process_time()
    try:
        result = cosimulate(scene)
    except (SimulationError, UserError) as refusal:
        words = str(refusal)
        return replace(
            verdict, outcome="refused", words=words, seconds=clock.process_time() - begun
        )
    verdict = replace(verdict, steps=result.steps, seconds=clock.process_time() - begun)
    try:
        right = motion(scene, result)
    except ReferenceDisagreement as error:
        return replace(verdict, outcome="unknown", words=str(error))
    errors = deviations(result, right)
    where = max(errors, key=lambda name: errors[name])
    verdict = replace(
        verdict,
        error=errors[where],
        where=where,
        stated=result.estimated_error if result.estimated_error >= SAID else 0.0,
        words="; ".join(result.events),
    )
    outcome = classify(verdict, scene.coupling.tolerance)
    if outcome in MISSES and growth(scene, result.time) > CHAOTIC:
        outcome = "chaotic"
    return replace(verdict, outcome=outcome)


def classify(verdict: Verdict, tolerance: float | None) -> str:
    """Outcome of a run that ended, by its error and by what it says of itself."""
    assert verdict.error is not None
    allowed = RIGHT if tolerance is None else FACTOR * tolerance
    if verdict.error <= allowed:
        return "right"
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
    found: dict[str, float] = {}
    for name in right:
        base = name.rpartition(".")[0]
        kind = name[len(base) :].removesuffix("_xi").removesuffix("_eta")
        partners = [n for n in right if n.startswith(base + ".") and _alike(n, kind, base)]
        scale = max(float(np.abs(right[n]).max()) for n in partners)
        error = float(np.abs(result[name] - right[name]).max())
        found[name] = error / scale if scale > 0.0 else error
    return found


def _alike(name: str, kind: str, base: str) -> bool:
    end = name[len(base) :]
    return end in (".x", ".y") if kind in (".x", ".y") else end.startswith(kind)


def motion(scene: Scene, result: Result) -> dict[str, NDArray]:
    """What the result's signals should be, by an independent integration.

    Raises:
        ReferenceDisagreement: two integrations of the reference differ.
    """
    names = [n for n in result.signals if not n.endswith((".angle", ".clearance"))]
    right, _ = reference(
        scene.assembly(),
        scene.profile(),
        result.time,
        initial=scene.run.initial.motion(),
        rtol=RTOL,
        bound=REFERENCE_BOUND,
        signals=[n for n in names if n.endswith((".x", ".y"))],
    )
    return {name: right.signal(name) for name in names}


def growth(scene: Scene, times: NDArray) -> float:
    """How many times as large a small turn of every first weight is at most by the end."""
    start, profile = scene.run.initial.motion(), scene.profile()
    ends = []
    for turn in (0.0, DISTURBANCE):
        assembly = _turned(scene.assembly(), turn)
        run = simulate(assembly, profile, times, initial=start, rtol=RTOL)
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
