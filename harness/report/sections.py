"""What a page says about a scene, a section a question; each is a list of the page's parts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ...models.linear.critical import speeds_of_interest
from ...models.readable import readable_unbalance
from ..capture.captured import captured, captured_or_none
from ..errors import SceneError, UserError
from ..motions.starts import run_up_begins
from ..output.outcome import Outcome
from ..output.report import Part
from ..output.table import GOOD, Sheet
from ..output.workers import Workers
from ..result.compared import draw_both
from ..result.result import Result
from ..result.verdict.words import millimetres, velocity
from ..scatter.report import grade_table, lines
from ..scatter.study import scatter
from ..scatter.vary import Variation
from ..scene import Scene
from ..scene.balancer import WeightBalancer
from ..stability.boundaries import speeds
from ..units import in_both, in_words
from .answers import distances, largest
from .parts import Heading, Image, Note
from .runs import SwitchedOn

Parts = list[str | Part]
METHODS = ("criterion", "floquet")
ABSENT = "(none in the scene)"  # nothing that was left out of this machine


def picture_of(outcome: Outcome, shows: str) -> Image:
    """The picture of an outcome, as part of the page."""
    return Image(outcome.plot()._repr_png_(), shows)  # type: ignore[union-attr]


def where(scene: Scene) -> Parts:
    """Speeds at which the balancers balance, by the closed form and by exact stability."""
    parts: Parts = [Heading("At which speeds does it balance, and how sure is that?")]
    low, high = speeds_of_interest(scene.assembly().rotor, scene.profile().end)
    try:
        found = speeds(scene, (low, high), list(METHODS))
    except UserError as error:
        return [*parts, f"Not known: {error}"]
    for name, reason in found.refused.items():
        parts.append(Note(f"{name}: no answer: {reason}"))
    if found.methods:
        sheet = found.table()
        rows = [[method, f"{speed:.6g}", *rest] for method, speed, *rest in sheet.rows]
        parts.append(replace(sheet, rows=rows, title="").in_units())
        parts.append(picture_of(found, "Speeds at which balancing begins or ends."))
    parts.append(
        Note(
            "floquet: linear stability of the equations of motion. criterion: a rule, fast and "
            "approximate. A band that is proved needs `autobalancer speeds --method proved`."
        )
    )
    return parts


def switching_on(scene: Scene, started: SwitchedOn) -> Parts:
    """The run from standstill, and whether weights are left behind on the way."""
    parts: Parts = [Heading("Will it balance when it is switched on?")]
    if started.run is not None and started.bare is not None:
        parts.append(Image(compared(started), "Vibration in the run-up, with and without."))
    if started.reason:
        parts.append(f"No run-up: {started.reason}")
    found = captured_or_none(scene)
    if found is None:
        return [*parts, _why_not_judged(scene)]
    parts += _shares(started)  # the closed form's sentence stands among the verdicts
    if found.found.natural:
        parts.append(picture_of(found, "Brake and drag over the weights' speed."))
    return [*parts, *(Note(line) for line in found.limits())]


def _why_not_judged(scene: Scene) -> str:
    """Why the closed form does not tell whether weights are left behind."""
    if not scene.assembly().weights:
        return "No balls, rollers or pendulums: nothing can be left behind."
    try:
        captured(scene)
    except (SceneError, ValueError) as error:
        return f"Whether weights are left behind is not known in closed form: {error}"
    return ""


def _shares(started: SwitchedOn) -> Parts:
    """How many of many starts balance, from the real start and from the friendliest."""
    if started.motions is None:
        return [Note(f"Shares of starts: not known: {started.unknown}")]
    return [started.motions.readable(), *(in_words(one) for one in started.motions.sentences())]


def vibration(scene: Scene, own: Result, started: SwitchedOn, limit: float | None) -> Parts:
    """Vibration and its velocity beside a limit that the user gives."""
    parts: Parts = [Heading("How much does it vibrate?")]
    rows = []
    runs = {"the scene as it is": own, "switched on": started.run, "without": started.bare}
    for name, run in runs.items():
        summary = run.summary() if run else None
        if run is None or summary is None or summary.vibration is None:
            continue
        speed, over = "not known", "not known"
        if summary.velocity is not None:
            speed = velocity(summary.velocity)
            over = "within" if limit is None or summary.velocity <= limit else "above"
        sizes = [millimetres(summary.vibration), speed, millimetres(largest(run))]
        rows.append([name, *sizes, over])
    columns = ["", "at the end", "velocity", "largest of the run", "limit"]
    if limit is None:
        parts.append(Note("No limit of the vibration velocity was given (--limit 4.5mm/s)."))
        columns, rows = columns[:-1], [row[:-1] for row in rows]
    else:
        parts.append(f"Limit of the vibration velocity, as given: {1e3 * limit:.3g} mm/s rms.")
    colours = {"limit": {"within": GOOD, "above": "red"}}
    return [*parts, Sheet(columns, rows, "l" + "r" * (len(columns) - 1), "", colours)]


def capacity(scene: Scene) -> Parts:
    """What the balancers hold, beside what there is."""
    parts: Parts = [Heading("How much unbalance can it take?")]
    weights = [one for one in scene.balancer if isinstance(one, WeightBalancer)]
    rows = [
        [one.label, f"{one.count} {one.kind}", f"{1e3 * one.count * float(one.device.mass):.4g}",
         readable_unbalance(one.capacity)]
        for one in weights
    ]  # fmt: skip
    if rows:
        parts.append(Sheet(["balancer", "weights", "mass of all [g]", "capacity"], rows, "llrr"))
    for name, amount in unbalances(scene):
        parts.append(f"{name}: {in_both(amount, 'kg m')}")
    return parts


def unbalances(scene: Scene) -> list[tuple[str, float]]:
    """The rotor's, by name [kg m]."""
    rotor = scene.rotor
    if rotor.kind == "planar":
        return [("Unbalance of the rotor", rotor.unbalance)]
    return [(f"Unbalance at z = {1e3 * u.position:.4g} mm", u.amount) for u in rotor.unbalances]


def tolerances(
    scene: Scene, varied: Sequence[Variation], machines: int, workers: Workers = 1
) -> Parts:
    """Machines as they leave the factory, if tolerances are given."""
    parts: Parts = [Heading("What do tolerances do?")]
    if not varied:
        return [
            *parts,
            Note('Not judged: no tolerances were given (--vary "balls.drag=normal(0.2,10%)").'),
        ]
    found = scatter(scene, varied, machines, workers=workers)
    said = found.as_json()
    parts += lines(said)
    if said["grades"]:
        parts.append(grade_table(said))
    return [*parts, picture_of(found, f"{machines} machines drawn from the tolerances.")]


def assumptions(scene: Scene, own: Result, started: SwitchedOn) -> Parts:
    """What was assumed, and what the runs did without."""
    parts: Parts = [Heading("What was assumed?")]
    if started.assumed:
        parts.append(started.assumed[0].upper() + started.assumed[1:] + ".")
    where = "at the angles of the scene"
    if started.motions is not None:
        where = f"at random angles: of {started.motions.n} starts the one with the median peak"
    parts.append(f"The run-up begins with {run_up_begins(started.scene)}, {where}.")
    if not scene.operation.gravity:
        parts.append("The axis is vertical: gravity is left out.")
    for one in scene.balancer:
        if isinstance(one, WeightBalancer) and not one.rolling_resistance:
            parts.append(f"{one.label}: no rolling resistance, so no weight sticks.")
    error = own.estimated_error
    parts.append(
        f"Error of the motion, estimated by the run: {error:.1g} of itself." if error else ""
    )
    parts += [Note(f"Left out: {line}") for line in own.left_out if not line.endswith(ABSENT)]
    return [part for part in parts if part]


def compared(started: SwitchedOn) -> bytes:
    """Picture of the vibration over time, with and without balancers."""
    assert started.run is not None
    assert started.bare is not None
    runs = [(run.time, distances(run)) for run in (started.run, started.bare)]
    return draw_both(started.scene, runs[0], runs[1])._repr_png_()
