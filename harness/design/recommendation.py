"""What a design says in words: the recommendation, and what must be known about the numbers."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ...models.papers.touching import critical_unbalance
from ...models.readable import readable_unbalance, rounded
from ..capture.captured import captured_or_none
from ..output.words import kinds_of
from .scenes import weights_of

if TYPE_CHECKING:
    from .choices import Choice, Design
    from .decay import Decay


NEAR = 0.15  # of the critical unbalance: ten per cent off, 58 of 200 starts had not settled


def words(data: Design) -> list[str]:
    """The recommendation as lines of text, its reasons included."""
    required = data.reserve * data.unbalance
    if not data.with_capacity:
        best = max(data.choices, key=lambda c: c.capacity)
        return [
            f"No number of {data.kind} in this space balances {readable_unbalance(required)}: "
            f"{best.count} have the most, {readable_unbalance(best.capacity)}. Take more weights "
            "(--most), a larger race, a wider space or a denser material.",
        ]
    lines = _recommendation(data) + _failed(data)
    if short := ", ".join(str(c.count) for c in data.choices if not c.has_capacity):
        lines.append(
            f"Too little capacity for {readable_unbalance(required)}, not run: n = {short}."
        )
    return [*lines, *_critical(data)]


def _recommendation(data: Design) -> list[str]:
    """The fewest that settle as soon as the fastest, the others, and the fewest of all."""
    good = sorted(rivals(data), key=lambda c: c.count)
    if not good:
        return ["No recommendation: too many starts failed."]
    best, others = good[0], good[1:]
    if math.isinf(best.median):
        return [
            "No recommendation: most starts did not settle within the run's "
            f"{rounded(best.seconds, 3)} s."
        ]
    held = readable_unbalance(best.capacity)
    if data.unbalance:
        held += f", {best.capacity / data.unbalance:.3g} times the largest unbalance"
    lines = [
        f"Take {best.count} {data.kind} of {2e3 * best.radius:.3g} mm diameter and "
        f"{1e3 * best.mass:.4g} g: they hold up to {held}, and settle in "
        f"{rounded(best.median, 3)} s (median, 95 % confidence {rounded(best.low, 3)} to "
        f"{rounded(best.high, 3)} s)."
    ]
    if others:
        named = ", ".join(
            f"{c.count} ({c.count * c.mass:.3g} kg in all, {c.settled} of {len(c.ran)} settled)"
            for c in others
        )
        lines.append(f"As good, within the accuracy of {len(best.ran)} starts: {named}.")
    fewest = data.with_capacity[0]
    if fewest.count < best.count:
        settles = math.isfinite(fewest.median)  # NaN where most of its starts failed
        when = (
            f"and settle in {rounded(fewest.median, 3)} s"
            if settles
            else "but usually do not settle"
        )
        lines.append(f"{fewest.count} have the capacity {when}.")
    return lines


def _failed(data: Design) -> list[str]:
    """Starts that failed, by number of weights and reason."""
    lines = []
    for choice in data.with_capacity:
        for count, reason in kinds_of([text for _, text in choice.failures]):
            number = next(k for k, text in choice.failures if text == reason)
            alike = f" ({count - 1} more like it)" if count > 1 else ""
            lines.append(f"n = {choice.count}, start {number} failed{alike}: {reason}")
    return lines


def left_behind(data: Design) -> str:
    """Whether the weights that are recommended can be left behind; empty without any."""
    timed = rivals(data) if data.with_capacity else []
    if not timed or math.isinf(timed[0].median):
        return ""
    found = captured_or_none(min(timed, key=lambda c: c.count).scene)
    return found.sentence() if found else ""


def by_measure(data: Design) -> list[Choice]:
    """Numbers with enough capacity, the fastest by Goncharov's measure at the largest p first."""
    return sorted(data.with_capacity, key=lambda c: -c.measure)


def by_median(data: Design) -> list[Choice]:
    """The same, the fastest by the co-simulated medians first."""
    return sorted((c for c in data.with_capacity if c.median == c.median), key=lambda c: c.median)


def rivals(data: Design) -> list[Choice]:
    """The fastest one, first, and those whose confidence interval reaches its own."""
    timed = by_median(data)
    return [c for c in timed if c.low <= timed[0].high]  # without those of which too many failed


def contradictions(data: Design) -> list[tuple[int, int]]:
    """Numbers (a, b) that Goncharov's measure at the largest p ranks a before b, settling b first.

    Only where the confidence intervals of the two do not touch.
    """
    ranked = by_measure(data)
    return [
        (a.count, b.count) for i, a in enumerate(ranked) for b in ranked[i + 1 :] if b.high < a.low
    ]


def contradicted(data: Design) -> str:
    """The same in words; empty where there is nothing to say."""
    return "; ".join(f"{b} before {a}" for a, b in contradictions(data))


def order(choices: list[Choice]) -> str:
    """Their numbers of weights in a row."""
    return " ".join(str(c.count) for c in choices)


def _critical(data: Design) -> list[str]:
    """What three weights that touch do where two of them face the third."""
    lines = []
    for choice in data.with_capacity:
        balls = weights_of(choice.scene)
        if choice.count != 3:
            continue
        amount = critical_unbalance(balls.mass, balls.track_radius, balls.weight_radius or 0.0)
        if (1.0 - NEAR) * data.least <= amount <= (1.0 + NEAR) * data.unbalance:
            here = abs(data.unbalance / amount - 1.0) <= NEAR
            lines.append(
                f"{'WARNING: ' if here else ''}n = 3 has a critical case at "
                f"{readable_unbalance(amount)}, S(2) - S(1): there two weights that touch face "
                "the third, nothing drives them, "
                f"and near it they settle slowly{'; this unbalance is near it' if here else ''}. "
                "Goncharov 2017 (13) counts weights that touch as free and does not see it."
            )
    return lines


def excluded(decays: Sequence[Decay]) -> str:
    """Why slow roots were not compared, the most frequent reason first."""
    reasons = Counter(one.excluded for one in decays if not one.dominant)
    return ", ".join(f"{count} {why}" for why, count in reasons.most_common())


def deviations(decays: Sequence[Decay]) -> dict[str, tuple[float, float]]:
    """Median and largest of |a/b - 1| for pairs of fitted rate, exact eigenvalue and slow root."""
    pairs = {
        "fitted rate off the exact eigenvalue": [d.fitted / d.exact for d in decays],
        "fitted rate off the slow root (1)": [d.fitted / d.root for d in decays],
        "exact eigenvalue off the slow root (1)": [d.exact / d.root for d in decays],
    }
    off = {name: np.abs(np.array(ratios) - 1.0) for name, ratios in pairs.items()}
    return {name: (float(np.median(each)), float(each.max())) for name, each in off.items()}
