"""A scatter in words and tables, and as a document for JSON."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...models.shares import wilson
from ..master.merged import SHORT
from ..output.table import Sheet
from ..result.verdict.words import is_nothing
from ..scene.grade import GRADES
from .study import Scatter

_SAME = 1e-3  # relative: so near amplitudes are one
MOST_REASONS = 5  # said; the table has all


def document(scatter: Scatter) -> dict[str, Any]:
    """Everything that the command says."""
    paths = [one.path for one in scatter.variations]
    return scatter.about() | {
        "failures": [
            {
                "machine": int(k) + 1,
                "values": dict(zip(paths, scatter.values[k].tolist(), strict=True)),
                "reason": scatter.failure[k],
            }
            for k in np.flatnonzero(~scatter.ran)
        ],
        "settled": float(scatter.settled[scatter.ran].mean()),
        "merged": int(scatter.merged[scatter.ran].sum()),
        "left_behind": int((scatter.behind[scatter.ran] > 0).sum()),
        "other_motion": int(scatter.unbalanced.sum()),
        "without_balancers": _without(scatter),
        "residual": scatter.quantiles(scatter.residual),
        "grades": [] if scatter.left_out else _grades(scatter),
        "no_grades": scatter.left_out,
        "importance": scatter.importance(scatter.residual),
    }


def _without(scatter: Scatter) -> dict[str, Any]:
    """How many machines vibrate more with balancers than without: at the end, and at most."""
    pairs = {
        "vibrate_more": (scatter.residual, scatter.alone),
        "larger_peak": (scatter.largest, scatter.largest_alone),
    }
    found: dict[str, Any] = {}
    for name, (own, other) in pairs.items():
        known = scatter.ran & ~np.isnan(other) & ~np.isnan(own)
        found[name] = int((own[known] > other[known] * (1.0 + _SAME)).sum())
        found[f"{name}_of"] = int(known.sum())
    more = scatter.residual > scatter.alone * (1.0 + _SAME)
    found["vibrate_more_unsettled"] = int((scatter.ran & more & (scatter.settled == 0.0)).sum())
    return found


def _grades(scatter: Scatter) -> list[dict[str, Any]]:
    """Share of the machines that ran within each grade, and its interval."""
    rows, ran = [], int(scatter.ran.sum())
    for grade in GRADES:
        within = int((scatter.grade <= grade).sum())
        low, high = wilson(within, ran)
        rows.append(
            {
                "grade": f"G{grade:g}",
                "share": within / ran,
                "low": low,
                "high": high,
            }
        )
    return rows


def grade_table(said: Mapping[str, Any]) -> Sheet:
    """Grades between the last that no machine meets and the first that all meet."""
    shares = [row["share"] for row in said["grades"]]
    begin = sum(share == 0.0 for share in shares) - 1
    end = max(begin, shares.index(max(shares))) + 1
    rows = [
        [row["grade"], *map(_per_cent, (row["share"], row["low"], row["high"]))]
        for row in said["grades"][max(0, begin) : end]
    ]
    return Sheet(("ISO 21940-11", "machines within", "95 % from", "to"), rows, "lrrr")


def importance_table(said: Mapping[str, Any]) -> Sheet:
    """Most important first."""
    rows = [[one["path"], f"{one['rank_correlation']:+.3f}"] for one in said["importance"]]
    return Sheet(("value", "rank correlation with the residual amplitude"), rows, "lr")


def lines(said: Mapping[str, Any]) -> list[str]:
    """What the tables do not say."""
    q = {name: _millimetres(value) for name, value in said["residual"].items()}
    lines = [
        f"{said['machines']} machines, seed {said['seed']}: {said['failed']} failed, "
        f"{_per_cent(said['settled'])} of the others have settled",
        f"Residual amplitude [mm]: median {q['0.5']}, 5 % {q['0.05']}, 95 % {q['0.95']}, "
        f"99 % {q['0.99']}",
    ]
    compared = said["without_balancers"]
    if compared["vibrate_more_of"]:
        early = compared["vibrate_more_unsettled"]
        unsettled = f" at the end, {early} of them before they have settled" * bool(early)
        lines.append(
            f"{compared['vibrate_more']} of {compared['vibrate_more_of']} machines vibrate more "
            f"with balancers than without{unsettled}; in {compared['larger_peak']} of "
            f"{compared['larger_peak_of']} the run's largest amplitude is larger with them"
        )
    if said["left_behind"]:
        lines.append(
            f"In {said['left_behind']} machines weights turn slower than the rotor: they are left "
            "behind at a natural frequency, or are not yet up to its speed, and have not settled "
            "(see `autobalancer motions`)"
        )
    if said["other_motion"]:
        lines.append(
            f"In {said['other_motion']} machines the weights turn with the rotor, which vibrates "
            "no less than without them: they are not in the balanced motion, or not yet"
        )
    if said["merged"]:
        lines.append(
            f"In {said['merged']} machines {SHORT}: they are not balanced in the run alone; give "
            "weight_radius, or a [[balancer]] table to each weight with drags that differ by 1e-9"
        )
    if said["no_grades"]:
        lines.append(f"No grades: {said['no_grades']}")
    if said["failed"]:
        ran = said["machines"] - said["failed"]
        lines.append(
            f"All figures and shares are of the {ran} machines that ran; those that failed:"
        )
    for one in said["reasons"][:MOST_REASONS]:
        named = next(each for each in said["failures"] if each["reason"] == one["such_as"])
        values = ", ".join(f"{path} = {value:.10g}" for path, value in named["values"].items())
        alike = f" ({one['machines'] - 1} more like it)" if one["machines"] > 1 else ""
        lines.append(f"machine {named['machine']}, {values}{alike}: {one['such_as']}")
    return lines


def _per_cent(share: float) -> str:
    return f"{100.0 * share:.4g} %"


def _millimetres(size: float) -> str:
    """An amplitude [m] in mm; what is as good as nothing is no number."""
    return "below 0.0001" if is_nothing(size) else f"{1e3 * size:.4g}"
