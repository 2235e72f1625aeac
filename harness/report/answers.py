"""The verdicts that stand first on a page: does it balance, and is it better than without."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ...models.arrays import Array
from ..capture.captured import captured_or_none
from ..motions.starts import first_speed
from ..result.result import Result
from ..result.sag import complex_motion, from_sag
from ..result.verdict.words import millimetres, percent
from ..scene import Scene
from ..units import in_both, in_words
from .parts import Lead
from .runs import SwitchedOn

WORSE = 1.05  # times the vibration without balancers
LIKELY = 0.9  # share of random run-ups that balance


@dataclass(frozen=True)
class Answer:
    """One sentence, and whether it is good news."""

    text: str
    good: bool | None


def verdicts(scene: Scene, own: Result, started: SwitchedOn) -> list[Answer]:
    """What a reader must know, most important first."""
    none = "The scene has no balancer: `autobalancer design` says whether one is better."
    answers = [fitted(started)] if scene.balancer else [Answer(none, None)]
    summary = own.summary()
    answers.append(Answer(f"The scene as it is: {summary}", summary.balanced))
    first = first_speed(started.scene)
    begins = f"at {in_both(first, 'rad/s')}" if first else "from rest"
    if started.run is not None:
        after = started.run.summary()
        answers.append(Answer(f"Switched on {begins}: {after}", after.balanced))
    elif started.reason:
        answers.append(Answer(f"Switched on {begins}: cannot tell: {started.reason}", None))
    found = captured_or_none(scene)
    if found is not None:
        answers.append(Answer(in_words(found.sentence()), found.found.all_pass))
    return answers


def judged(one: Answer) -> Lead:
    """As part of the page."""
    look: Literal["good", "bad", ""] = "" if one.good is None else "good" if one.good else "bad"
    return Lead(one.text, look)


def fitted(started: SwitchedOn) -> Answer:
    """Whether balancers are better than none, at speed and on the way there."""
    with_them, without = ends_and_peaks(started.run), ends_and_peaks(started.bare)
    if with_them is None or without is None:
        return Answer("Should balancers be fitted? Cannot tell: the run-up could not be run.", None)
    (end, peak), (bare_end, bare_peak) = with_them, without
    largest, share, said = "at most ", 1.0, ""
    points = started.run_ups
    if points is not None and math.isfinite(points.largest) and not started.scene.operation.gravity:
        peak, share = points.largest, points.balanced.share
        largest = "a largest vibration of "
        said = f" (median of {points.balanced.of} random starts, of which {points.balanced.count} "
        said += "balance)"
    text = (
        f"At speed it vibrates {_compared(end, bare_end)}; "
        f"on the way there {largest}{_compared(peak, bare_peak)}{said}."
    )
    if not is_settled(started.run):
        unknown = "Whether balancers are better here is not known: the run has not settled."
        return Answer(f"{unknown} {text}", None)
    better = end < bare_end / WORSE
    if better and share < LIKELY:
        return Answer(f"Balancers are better here than none only if they balance. {text}", False)
    if better and peak <= WORSE * bare_peak:
        return Answer(f"Balancers are better here than none. {text}", True)
    if better:
        return Answer(f"Balancers are better at speed and worse in the run-up. {text}", None)
    return Answer(f"Balancers are no better here than none. {text}", False)


def is_settled(run: Result | None) -> bool:
    """Whether a run does not ask for a longer one."""
    return run is not None and run.summary().revolutions is None


def ends_and_peaks(run: Result | None) -> tuple[float, float] | None:
    """Vibration at the end, and the largest of the run [m]; None without a run."""
    if run is None:
        return None
    end = run.summary().vibration
    return None if end is None else (end, max(end, largest(run)))


def largest(run: Result) -> float:
    """Largest distance of a station from its rest in the run [m]."""
    return float(distances(run).max())


def distances(run: Result) -> Array:
    """Largest distance of a station from its rest at every time (T,) [m]."""
    moved = from_sag(run.signals, run.sag())
    assert run.scene is not None
    found: Array = np.abs(complex_motion(moved, len(run.scene.rotor.points))).max(axis=0)
    return found


def _compared(value: float, without: float) -> str:
    share = f" ({percent(value / without)})" if without > 0.0 else ""
    return f"{millimetres(value)} instead of {millimetres(without)} without{share}"
