"""What was measured as tables, and in words."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ....models.readable import rounded
from ...output.table import Sheet
from .measure import TARGETS, TWO_DECADES, Point, Precision


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
        if point.error is not None or key not in said:
            yield point
        said.add(key)


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.1e}"


def reference_words(study: Precision) -> str:
    """What the errors are measured against, and down to where they mean something."""
    return (
        f"Reference: two independent SciPy methods, which differ by {study.reference_error:.1e} of "
        f"the signals' ranges; errors below {TWO_DECADES * study.reference_error:.0e} cannot be "
        f"distinguished from it. Signals: {', '.join(study.signals)}. Smallest of {study.rounds} "
        "runs after one warm-up."
    )


def cheapest(study: Precision) -> Sheet:
    """The cheapest way to each error: one file, separate FMUs, SciPy."""
    rows = []
    for error in TARGETS:
        one = study.cheapest(error, coupled=True, one_file=True)
        apart, whole = (study.cheapest(error, coupled=coupled) for coupled in (True, False))
        fast = "-"
        if one and whole and one.seconds and whole.seconds:
            fast = rounded(whole.seconds / one.seconds, 2)
        rows.append((study.scene.name, f"{error:.0e}", _way(one), _way(apart), _way(whole), fast))
    columns = ("scene", "error", "one file", "separate FMUs", "SciPy in one piece", "times faster")
    return Sheet(columns, rows, "lllllr", "Cheapest way to an error")


def _way(point: Point | None) -> str:
    if point is None or point.seconds is None:
        return "-"
    name = point.method.family.removeprefix("monolith ").removesuffix(" in one file")
    return f"{1e3 * point.seconds:.3g} ms: {name}, {point.method.setting}"


def markdown(study: Precision) -> str:
    """Everything as Markdown."""
    parts = (reference_words(study), table(study).markdown(), cheapest(study).markdown())
    return "\n\n".join([f"### {study.scene.name}", *parts]) + "\n"
