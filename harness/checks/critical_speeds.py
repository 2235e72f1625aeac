"""Critical speeds of the coupled units against Floquet, and runs from rest."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ...models.linear.regions import Crossing, Side
from ...models.stability import growth_rates
from ..errors import SceneError
from ..result.run import cosimulate
from ..scene import Scene
from ..scene.check import CriticalSpeedsCheck
from ..stability.boundaries import speeds
from ..stability.crossings import NEAR, side
from ..stability.main_motion import MainMotion
from ..stability.speeds import Speeds
from .report import text
from .row import Row, Rows

SPEED_TOLERANCE = 1e-3  # relative, co-simulated against Floquet: the coupling's error
BALANCED_SHARE = 0.01  # residual moment over that at the start
IN_BALANCE = 1e-9  # of the weights' capacity: rounding of a sum of moments that is 0
LATE = 10  # last part of a run in which it is judged: one tenth
SETTLING = 9.0  # times 1/growth rate: e^-9 = 1e-4 of the distance to the main motion is left
TRANSIENT = 60.0  # revolutions before that: the weights find their places
LONGEST = 3000.0  # revolutions of a run: what settles later, e^-0.003 per revolution, is a boundary
FLOQUET = "Floquet multipliers about the main motion"
OTHER_SIDE: dict[Side, Side] = {"stable": "unstable", "unstable": "stable"}


def check_critical_speeds(scene: Scene, check: CriticalSpeedsCheck) -> Iterator[Row]:
    """One row for each critical speed and each run from rest.

    Raises:
        SceneError: the weights cannot balance the scene's unbalance, or a replaced value is wrong.
    """
    scene = scene.replace(check.set)
    rows = Rows(scene.name, check.kind)
    prefix = f"{check.case}: " if check.case else ""
    result = confirmed(scene, speeds(scene, check.range))
    for method in ("floquet", "cosim"):
        if method in result.refused:
            raise SceneError(f"{scene.label}: check critical_speeds: {result.refused[method]}")
    yield from speed_rows(rows, result, prefix)
    boundaries = [row["cosim"].speed for row in result.rows() if "cosim" in row]
    for speed in check.published:
        pairs = ((abs(boundary - speed), boundary) for boundary in boundaries)
        _, nearest = min(pairs, default=(math.inf, math.nan))
        quantity = f"{prefix}published critical speed [rad/s]"
        yield rows.number(quantity, speed, nearest, check.published_within, scene.source)
    for speed in check.runs_from_rest:
        yield rest_row(rows, scene, speed, prefix)


def confirmed(scene: Scene, found: Speeds) -> Speeds:
    """The speeds less those that separate FMUs do not confirm.

    The one file locates a critical speed.  Separate FMUs, coupled in Python, must find the same
    side of it below and above: what they do not is left out, and its row does not hold.
    """
    cosim = found.methods.get("cosim")
    if cosim is None:
        return found
    bounds = [found.range[0], *(crossing.speed for crossing in cosim), found.range[1]]
    with MainMotion(scene, separate=True) as motion:

        def is_seen(crossing: Crossing, before: float, after: float) -> bool:
            if crossing.above not in OTHER_SIDE:
                return True
            at = crossing.speed
            reach = min(NEAR * at, (at - before) / 3.0, (after - at) / 3.0)
            sides = {at - reach: OTHER_SIDE[crossing.above], at + reach: crossing.above}
            return all(side(motion.growth(w)) == expected for w, expected in sides.items())

        kept = tuple(map(is_seen, cosim, bounds, bounds[2:]))
    seen = tuple(crossing for crossing, is_kept in zip(cosim, kept, strict=True) if is_kept)
    return replace(found, methods={**found.methods, "cosim": seen})


def speed_rows(rows: Rows, result: Speeds, prefix: str, scale: float = 1.0) -> Iterator[Row]:
    """Co-simulation against Floquet for every critical speed, `scale` rad/s being 1.

    A speed that only one of them found is a row that does not hold.
    """
    unit = " [rad/s]" if scale == 1.0 else " / w_x"
    span = f"{result.range[0] / scale:.4g} to {result.range[1] / scale:.4g}{unit}"
    shown = [row for row in result.rows() if row.keys() & {"floquet", "cosim"}]
    for number, row in enumerate(shown, start=1):
        floquet, cosim = row.get("floquet"), row.get("cosim")
        above = next(iter(row.values())).above
        beside = f", criterion {row['criterion'].speed / scale:.5g}" if "criterion" in row else ""
        quantity = f"{prefix}critical speed {number}, {above} above{beside}{unit}"
        if floquet and cosim:
            pair = floquet.speed / scale, cosim.speed / scale
            yield rows.number(quantity, *pair, SPEED_TOLERANCE, FLOQUET)
        else:
            exact, measured = (text(c.speed / scale) if c else "none" for c in (floquet, cosim))
            yield rows.statement(quantity, exact, measured, False, FLOQUET)
    if not shown:
        exact, measured = (f"{result.lowest[m]} throughout" for m in ("floquet", "cosim"))
        yield rows.statement(f"{prefix}{span}", exact, measured, exact == measured, FLOQUET)


def rest_row(rows: Rows, scene: Scene, speed: float, prefix: str) -> Row:
    """Whether a run from rest ends balanced or not, as Floquet's growth rate predicts.

    Raises what `run_from_rest` raises.
    """
    growth = float(growth_rates(scene.assembly(), speed)[0])
    revolutions = needed_revolutions(growth, speed)
    residual, share = run_from_rest(scene, speed, revolutions)
    words = {True: "balanced", False: "not balanced"}
    balanced, stable = share <= BALANCED_SHARE, growth < 0.0
    expected = f"{words[stable]}: growth rate {growth:.3g} 1/s"
    measured = (
        f"{words[balanced]}: residual moment {residual:.3g} kg m ({share:.2g} of the first) "
        f"after {revolutions:.0f} revolutions"
    )
    quantity = f"{prefix}run from rest at {speed:g} rad/s"
    return rows.statement(quantity, expected, measured, balanced == stable, FLOQUET)


def needed_revolutions(growth: float, speed: float) -> float:
    """Length of a run that shows whether a motion of this growth rate [1/s] comes to balance."""
    per_revolution = abs(growth) * 2.0 * math.pi / speed  # change of a deviation's logarithm
    if per_revolution * (LONGEST - TRANSIENT) <= SETTLING:
        return LONGEST
    return math.ceil(TRANSIENT + SETTLING / per_revolution)


def run_from_rest(scene: Scene, speed: float, revolutions: float) -> tuple[float, float]:
    """Run a scene at a speed, rotor at rest in the middle, weights where the scene puts them.

    Returns:
        Largest unbalance left at any station in the last tenth of the run [kg m], and that over the
        unbalance at the start, weights included.

    Raises:
        SceneError: nothing is unbalanced at the start, so that there is nothing to compare with.
        SimulationError: the run cannot be completed correctly.
    """
    scene = scene.replace({"operation.speed": speed, "run.revolutions": revolutions})
    rotor, weights = scene.assembly().rotor, scene.assembly().weights
    moments = [[f"{w.name}.moment_{axis}" for axis in ("xi", "eta")] for w in weights]
    result = cosimulate(scene, record=[name for pair in moments for name in pair])
    unbalance = np.tile(rotor.unbalance, (len(result.time), 1)).astype(complex)
    for mounted, (xi, eta) in zip(weights, moments, strict=True):
        unbalance += (result[xi] + 1j * result[eta])[:, None] * rotor.planes[mounted.plane]
    size = np.abs(unbalance).max(axis=1)
    first, residual = float(size[0]), float(size[-(len(result.time) // LATE) :].max())
    if first <= IN_BALANCE * scene.assembly().capacity:
        raise SceneError(
            f"{scene.label}: check critical_speeds: runs_from_rest: rotor and weights are in "
            f"balance at the start: set other angles, such as {weights[0].name}.angles"
        )
    return residual, residual / first
