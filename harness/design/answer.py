"""What a design comes to in words: take these weights, or none, and why."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ...models.readable import brief, readable_unbalance, rounded
from ..units import in_both
from .trials import LIKELY, WORSE_PEAK, Trial, preference

if TYPE_CHECKING:
    from .fitting import Fitting

ALTERNATIVES = 3  # named beside the best, at most
NO_RESERVE, SMALL_RESERVE = 0.005, 0.05  # of the largest unbalance: less capacity beyond it
ENOUGH = 35  # starts: so many that all balance show it
MORE = 5  # times as many where their share does not


def words(data: Fitting) -> list[str]:
    """Assumptions, then the recommendation, then what else a reader must know."""
    return [*data.assumed, *_recommendation(data)]


def sure(data: Fitting) -> list[Trial]:
    """Candidates that balance in every corner, as far as the runs can tell; the best first.

    All starts balance, or the interval of the share reaches above `LIKELY` from below; then the
    smaller peak in the run-up counts, as far as it exceeds that without balancers, and the mass.
    """
    good = [one for one in data.trials if one.interval[0] >= LIKELY]
    return sorted(good, key=preference)


def alternatives(data: Fitting) -> list[Trial]:
    """Other numbers and sizes that balance as surely, the best of them first.

    Where the best vibrates no more in the run-up than the rotor without balancers, so do they.
    """
    good = sure(data)
    quiet = bool(good) and good[0].peak_ratio <= WORSE_PEAK
    return [one for one in good[1:] if not quiet or one.peak_ratio <= WORSE_PEAK][:ALTERNATIVES]


def _recommendation(data: Fitting) -> list[str]:
    space = data.space
    if not data.trials:
        return [
            f"None: no number and size of {data.kind} in this space holds "
            f"{in_both(space.required, 'kg m')}: {data.most.count} of "
            f"{2e3 * data.most.radius:.3g} mm hold most, {in_both(data.most.capacity, 'kg m')}. "
            "Use more of them (--most), a larger race, a wider space or a denser material."
        ]
    good = sure(data)
    if not good:
        return _none(data)
    best = good[0]
    lines = [_take(data, best)]
    if best.peak_ratio > WORSE_PEAK:
        rises = data.start == "run-up"
        when, remedy = (
            ("In the run-up", "run up faster, or use none")
            if rises
            else ("Until it balances", "use none")
        )
        lines.append(
            f"{when} the machine vibrates more than without: {brief(1e3 * best.peak)} mm (median "
            f"of the worst corner), without at most {brief(1e3 * best.peak_alone)} mm. If that "
            f"matters, {remedy}."
        )
    lines += [_also(data, one) for one in alternatives(data)]
    failed = [t for t in data.trials if t.failure]
    lines += [f"{_named(t, data)}: a run failed: {t.failure}" for t in failed]
    if data.not_run:
        lines.append(f"{data.not_run} heavier candidates were not run.")
    return lines


def _none(data: Fitting) -> list[str]:
    """Why no balancer is better, and what would help."""
    best = max(data.trials, key=lambda one: (one.interval[0], -one.total))
    low, high = (100.0 * x for x in best.interval)
    if best.worst.balanced == best.worst.of and not best.failure:
        return [
            f"Cannot tell from {best.worst.of} starts: all of {_named(best, data)} balance, which "
            f"shows at least {low:.0f} % only. Give -n {ENOUGH} or more."
        ]
    worst, least = best.worst, f"{100.0 * LIKELY:.0f} % of the starts"
    within = f"within {rounded(worst.seconds, 3)} s at speed, " if worst.seconds else ""
    share = (
        f"in {100.0 * worst.share:.0f} % ({low:.0f} to {high:.0f}) {within}at drag "
        f"{worst.drag:.3g} N s/m and {readable_unbalance(worst.unbalance)}."
    )
    if high >= 100.0 * LIKELY and not best.failure:
        return [
            f"Cannot tell from {worst.of} starts whether a candidate balances in at least {least}. "
            f"The best, {_named(best, data)}, does {share} Give more starts, such as "
            f"-n {MORE * worst.of}."
        ]
    lines = [
        f"None: no candidate balances in at least {least}. The best, {_named(best, data)}, does "
        f"{share}"
    ]
    if best.margin < 1.0:
        lines.append(
            f"Its balls can be left behind: it needs {brief(1.0 / best.margin)} times the drag, or "
            "lighter weights, or more damping of the supports. A quicker run-up may help, but need "
            "not."
        )
    return lines


def _take(data: Fitting, best: Trial) -> str:
    low, _ = best.interval
    settled = f" within {rounded(best.settling, 3)} s at speed (median)" if best.settling else ""
    margin = f"drag is {brief(best.margin)} times the one that excludes weights left behind"
    if math.isinf(best.margin):
        margin = "no natural frequency holds weights back"
    elif math.isnan(best.margin):
        margin = "the closed form cannot tell whether weights slip"
    return (
        f"Take {_named(best, data)}: it balances in {best.worst.balanced} of {best.worst.of} "
        f"starts of the worst corner (at least {100.0 * low:.0f} %, with 95 % confidence)"
        f"{settled}; "
        f"{_capacity(data, best)}; {margin}; {_left(best)}."
    )


def _left(one: Trial) -> str:
    """The vibration that the runs end with, which need not be steady."""
    longest = one.loudest.seconds
    after = f", up to {rounded(longest, 3)} s at speed," if longest else ""
    falls = " and still falls" if one.still_falls else ""
    return (
        f"the vibration at the end of the runs{after} is {brief(100.0 * one.left)} % of that "
        f"without{falls} (median)"
    )


def _also(data: Fitting, one: Trial) -> str:
    settled = f", settled within {rounded(one.settling, 3)} s at speed" if one.settling else ""
    return (
        f"Also good: {_named(one, data)}: {_capacity(data, one)}{settled}, largest vibration "
        f"{brief(100.0 * one.peak_ratio)} % of that without."
    )


def _capacity(data: Fitting, one: Trial) -> str:
    largest = data.space.unbalance
    held = one.candidate.capacity / largest if largest else math.inf
    said = f"capacity {held:.3g} times the largest unbalance"
    if held < 1.0 + NO_RESERVE:
        return f"{said}, without reserve"
    return said if held >= 1.0 + SMALL_RESERVE else f"{said}, hardly any reserve"


def _named(one: Trial, data: Fitting) -> str:
    c = one.candidate
    return (
        f"{c.count} {data.kind} of {2e3 * c.radius:.3g} mm ({1e3 * c.mass:.3g} g each, "
        f"{1e3 * one.total:.3g} g in all)"
    )
