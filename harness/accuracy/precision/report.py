"""What was measured as table, CSV, JSON, Markdown, and in words."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from ...output.table import Sheet
from .measure import TARGETS, TWO_DECADES, Point, Precision

KEYS = (
    "scene", "method", "order", "steps_per_rev", "corrections", "tolerance",
    "error", "seconds", "status",
)  # fmt: skip


def row(point: Point) -> dict[str, Any]:
    """One point with the keys of the JSON document."""
    name = point.method.name + " in one file" * point.method.one_file
    values = {**vars(point.method), **vars(point), "method": name}
    return {key: values[key] for key in KEYS}


def as_json(study: Precision) -> dict[str, Any]:
    """`{"rows": [...]}`, a row for every method, step and tolerance."""
    return {"rows": [row(point) for point in study.points]}


def rows(study: Precision) -> Sheet:
    """The rows with the error at the end, the error of x and y alone, and the work added."""
    cells = [[*row(p).values(), p.at_end, p.rotor, p.work] for p in study.points]
    columns = (*KEYS, "error_at_end", "error_of_rotor", "work")
    return Sheet(columns, cells, title=study.scene.heading)


def table(study: Precision) -> Sheet:
    """Every point, families apart."""
    rows: list[list[str]] = []
    families: set[str] = set()
    for point in _without_repeats(study.points):
        family, order = point.method.family, study.orders.get(point.method.family)
        head = ["", ""]
        if family not in families:
            head = [family, "-" if order is None else f"{order:.1f}"]
        families.add(family)
        errors = (_number(point.error), _number(point.at_end))
        time = "-" if point.seconds is None else f"{1e3 * point.seconds:#.3g}"
        rows.append([head[0], point.method.setting, *errors, time, head[1], point.status])
    columns = ("method", "step or tolerance", "error", "at the end", "ms", "order", "status")
    title = f"Error against run time: {study.scene.name}"
    return Sheet(columns, rows, "llrrrrl", title, grouped=True)


def _without_repeats(points: Sequence[Point]) -> Iterable[Point]:
    """A family that fails for one and the same reason is said once."""
    said: set[tuple[str, str]] = set()
    for point in points:
        key = (point.method.family, point.status)
        if point.counts or key not in said:
            yield point
        said.add(key)


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.1e}"


def reference_words(study: Precision) -> str:
    """What the errors are measured against, and down to where they mean something."""
    return (
        f"Reference: two independent SciPy methods, which differ by {study.reference_error:.1e} of "
        f"the signals' ranges; errors below {TWO_DECADES * study.reference_error:.0e} are not told "
        f"apart from it. Signals: {', '.join(study.signals)}. Smallest of {study.rounds} runs "
        "after one warm-up."
    )


def cheapest_words(study: Precision) -> str:
    """The last line: the cheapest way to each error."""
    ways = []
    for target in TARGETS:
        coupled, whole = (study.cheapest(target, coupled=kind) for kind in (True, False))
        way = "no way measured" if coupled is None else _way(coupled)
        rival = "" if whole is None else f"; in one piece {_way(whole)}"
        ways.append(f"to {target:g} by {way}{rival}" if coupled else f"to {target:g}: {way}{rival}")
    return f"Cheapest for {study.scene.name}: {'. '.join(ways)}."


def one_file_words(study: Precision) -> str:
    """How many times as fast as SciPy's best the composite is; "" if it did not run."""
    ways = []
    for target in TARGETS:
        one = study.cheapest(target, coupled=True, one_file=True)
        whole = study.cheapest(target, coupled=False)
        if one and whole and one.seconds and whole.seconds:
            ratio = whole.seconds / one.seconds
            ways.append(f"{ratio:.0f} at {target:g} ({_way(one)}; {_way(whole)})")
    if not ways:
        return ""
    return f"In one file, times as fast as SciPy's best in one piece: {', '.join(ways)}."


def _way(point: Point) -> str:
    assert point.seconds is not None
    name = point.method.family.removeprefix("monolith ").removesuffix(" in one file")
    return f"{name}, {point.method.setting} ({1e3 * point.seconds:.3g} ms, {point.error:.1e})"


def markdown(study: Precision) -> str:
    """Everything as Markdown."""
    words = (reference_words(study), table(study).markdown(), one_file_words(study))
    parts = [f"### {study.scene.name}", *filter(None, words), cheapest_words(study)]
    return "\n\n".join(parts) + "\n"
