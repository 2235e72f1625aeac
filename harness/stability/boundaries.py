"""Boundaries of balancing: speeds at which it begins or ends, by four methods side by side.

A boundary is where the largest growth rate of a small deviation crosses 0 (a `Crossing`); the
critical speeds of the rotor alone, its resonances, are another matter (`models.linear.critical`).

criterion: the closed formula of Filimonikhina 2017 for planar rotors, a rule: fast, approximate.
floquet: exact linear stability of the equations.
cosim: largest multiplier of the coupled units' one-revolution map, without their equations of
    motion.
proved: bands of speeds in which stability or instability is proved, for all machines within
    tolerances (`proved`).

floquet and cosim know the error of their growth rates, and state a limit only where the growth on
both sides exceeds it (`models.linear.regions`).
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from importlib.util import find_spec

import numpy as np
from numpy.typing import NDArray

from ...models.assembly import Assembly, weights_of
from ...models.boundaries import balancing_regions, unknown_word
from ...models.criteria import Criterion
from ...models.linear.balanced import CannotBalance, balanced_angles
from ...models.linear.on_race import has_lobes, main_motion
from ...models.linear.regions import NARROW
from ..capture.captured import captured_or_none
from ..errors import SimulationError, UserError
from ..output.workers import Progress
from ..result.verdict import vibration_alone
from ..scene import Scene
from ..scene.at_rest import about_restraints
from ..scene.plausible import natural_frequencies
from ..scene.quantities import LARGEST
from ..units import si_number
from .crossings import FINE, measured_regions, nodes_around, side
from .growth_search import GrowthSearch
from .main_motion import MainMotion, NoMainMotion
from .methods import DEFAULT_METHODS, METHODS
from .speeds import Speeds, add_regions
from .whirl import CANNOT, IN_PART, UNKNOWN, whirls

MOST_SPEEDS = 100_000  # of one scan: more is a slip of the keyboard
BEYOND = 1.25  # times the highest speed of the operation: end of the default range
SCAN = 60  # intervals of a co-simulated scan without `narrowest`


def default_range(scene: Scene) -> tuple[float, float]:
    """Speeds [rad/s] from half the lowest natural frequency to beyond those of the operation.

    Below: half the highest speed of the operation where that is lower.  Above: 1.25 times that
    speed, or twice the lowest natural frequency, whichever is higher; within the tables of
    bearings.

    Raises:
        UserError: nothing holds the rotor, and it does not turn.
    """
    found = [w for w in natural_frequencies(scene) if w > 0.0]
    top = max(map(abs, scene.profile().speeds), default=0.0)
    if not found and not top:
        raise UserError("range: the rotor has no natural frequency: give --range LOW HIGH")
    lowest = found[0] if found else top / BEYOND
    low, high = 0.5 * min(lowest, top or lowest), max(BEYOND * top, 2.0 * lowest)
    least, most = scene.assembly().rotor.table_speeds
    low, high = max(low, least), min(high, most)
    return (low, high) if low < high else (least, most)


def speeds(
    scene: Scene,
    range: tuple[float | str, float | str] | None,
    methods: Iterable[str] = DEFAULT_METHODS,
    *,
    narrowest: float | None = None,
    progress: Progress | None = None,
    whirl: bool = True,
    within: str = "",
    separate: bool = False,
) -> Speeds:
    """Every speed within a range at which balancing begins or ends, by each method.

    The co-simulation looks on both sides of every speed that Floquet found, between them, and at
    both ends of the range; without Floquet it scans the range itself.

    Args:
        range: ends [rad/s]; None: `default_range`.
        methods, narrowest, progress: as `Scene.speeds`, which says what is raised.
        whirl: whether to run the scene for what remains where weights do not balance fully.
        within: tolerances for the method proved: "rotor.stiffness=5%, rotor.damping=10 N s/m".
        separate: co-simulate separate FMUs coupled in Python even where one file can run in C.

    Raises:
        UserError: the range is empty or beyond the bearings' tables, a method is unknown,
            tolerances are wrong, or python-flint is missing.
        SceneError: gravity swings the weights.
        SimulationError: a co-simulation cannot be completed correctly, and no other method answers.
    """
    scene.refuse_unrest("speeds")
    scene.refuse_friction("boundaries of balancing are those")
    range = default_range(scene) if range is None else range
    low, high = (si_number(end, "rad/s", "range:") for end in range)
    if not 0.0 < low < high <= LARGEST:
        raise UserError(
            f"range {low:g} to {high:g} rad/s: must be positive and rising, to {LARGEST:g} at most"
        )
    rotor = scene.assembly().rotor
    if not rotor.holds(low, high):
        least, most = rotor.table_speeds
        raise UserError(
            f"range {low:g} to {high:g} rad/s: must be within {least:g} to {most:g} rad/s, the "
            "speeds of the bearings' tables; give such a range, or give the tables more rows"
        )
    wanted = list(dict.fromkeys(methods))
    for method in wanted:
        if method not in METHODS:
            raise UserError(f"method {method!r}: must be one of {', '.join(METHODS)}")
    if within and "proved" not in wanted:
        raise UserError(f"within {within!r}: belongs to the method proved: ask for it")
    width = (high - low) / MOST_SPEEDS
    if narrowest is not None:
        narrowest = si_number(narrowest, "rad/s", "narrowest =")
        if not 0.0 < narrowest < math.inf:
            raise UserError(f"narrowest = {narrowest:g} rad/s: must be above 0")
    if narrowest is not None and narrowest < width and set(wanted) - {"proved"}:
        raise UserError(
            f"narrowest = {narrowest:g} rad/s: requires {(high - low) / narrowest:.3g} speeds from "
            f"{low:g} to {high:g} rad/s; must be {width:.3g} rad/s or more: at most {MOST_SPEEDS}"
        )
    captured, supports = captured_or_none(scene), about_restraints(scene)
    result = Speeds(scene.name, (low, high), captured=captured, supports=supports)
    if "criterion" in wanted:
        _by_criterion(scene, result)
    if "floquet" in wanted:
        _by_floquet(scene, result, narrowest)
    if "proved" in wanted:
        result = _by_proof(scene, result, narrowest, within, progress)
    finding, why = _why_no_rest(scene) if "floquet" in wanted else ("", "")
    if "cosim" in wanted:
        refused = "" if has_lobes(scene.assembly()) else why  # there weights rest on lobes
        _by_units(scene, result, refused, narrowest, separate, progress)
    if not (why and whirl):
        return result
    return replace(result, whirl=whirls(scene, result.range, why, finding))


def criterion_of(assembly: Assembly) -> Criterion:
    """The criterion of a scene's assembly.

    Raises:
        ValueError: it does not apply; the message says why.
    """
    if not assembly.weights:
        raise ValueError("the criterion is for weights, and the scene has none")
    if has_lobes(assembly):
        raise ValueError("the criterion is for round races, and this one has lobes")
    return Criterion.of(assembly)


def _by_criterion(scene: Scene, result: Speeds) -> None:
    low, high = result.range
    try:
        criterion = criterion_of(scene.assembly())
    except ValueError as error:
        result.refused["criterion"] = str(error)
        return
    result.methods["criterion"] = tuple(c for c in criterion.crossings if low <= c.speed <= high)
    result.lowest["criterion"] = side(float(criterion.value(low)))


def _by_floquet(scene: Scene, result: Speeds, narrowest: float | None) -> None:
    try:
        found = balancing_regions(scene.assembly(), *result.range, narrowest=narrowest)
    except (CannotBalance, ArithmeticError) as error:
        result.refused["floquet"] = str(error)
        return
    add_regions(result, "floquet", found)


def _by_proof(
    scene: Scene, result: Speeds, narrowest: float | None, within: str, progress: Progress | None
) -> Speeds:
    refuse_missing()
    from ...models.proof.arrays import Unproved
    from .proved import prove

    try:
        proof = prove(scene, *result.range, narrowest=narrowest, within=within, progress=progress)
    except Unproved as error:
        result.refused["proved"] = str(error)
        return result
    return replace(result, proof=proof)


def refuse_missing() -> None:
    """Raise UserError where python-flint is missing: with how to install it."""
    if not is_provable():
        raise UserError('a proof needs python-flint: pip install "autobalancer[proof]"')


def is_provable() -> bool:
    """Whether python-flint, which proofs need, is installed."""
    return find_spec("flint") is not None


def _why_no_rest(scene: Scene) -> tuple[str, str]:
    """What `Whirls` finds, and why the rotor cannot rest whatever the speed; empty where it can."""
    assembly = scene.assembly()
    try:
        balanced_angles(assembly)
    except CannotBalance as error:
        return CANNOT, str(error)
    except ArithmeticError:
        return "", ""
    if has_lobes(assembly):
        return _left_by_lobes(scene)
    off = [f"{m.name} by {1e3 * abs(m.offset):.3g} mm" for m in assembly.weights if m.offset]
    return IN_PART, f"tracks are off centre: {', '.join(off)}" if off else ""


def _left_by_lobes(scene: Scene) -> tuple[str, str]:
    """The same of races that are not round: what weights leave at the last speed."""
    speed = scene.profile().end
    assembly = scene.assembly().at_speed(speed)
    try:
        machine, angles = main_motion(assembly, speed)
    except ArithmeticError as error:
        return UNKNOWN, str(error)
    left = 1e3 * float(np.abs(machine.whirl(angles)).max())
    names = ", ".join(m.name for m in assembly.weights if weights_of(m).race)
    rates = np.linalg.eigvals(machine.linearised(angles).at_speed(speed)).real
    words = "are left" if rates.max() < 0.0 else "would be left by a rest that is unstable"
    of = f"{left:.3g} mm of {1e3 * vibration_alone(scene, speed, 0.0):.3g} mm"
    return IN_PART, f"the race is not round ({names}): {of} {words} at {speed:g} rad/s"


def _by_units(
    scene: Scene,
    result: Speeds,
    why: str,
    narrowest: float | None,
    separate: bool,
    progress: Progress | None,
) -> None:
    """Boundaries by the units, unless there is a reason `why` the rotor cannot rest."""
    if why:
        result.refused["cosim"] = why
        return
    try:
        with MainMotion(scene, separate=separate) as motion:
            nodes = _nodes(result, narrowest).tolist()
            word = unknown_word(scene.assembly())
            fine = NARROW if motion.units.is_separate else FINE
            search = GrowthSearch(motion)
            found = measured_regions(search.find, search.rate, nodes, progress, word, fine)
    except SimulationError as error:
        if not (result.methods or isinstance(error, NoMainMotion)):
            raise
        result.refused["cosim"] = str(error)
        return
    add_regions(result, "cosim", found)


def _nodes(result: Speeds, narrowest: float | None) -> NDArray[np.float64]:
    """Speeds at which the units are judged: both sides of every boundary of Floquet, or a scan."""
    if "floquet" in result.methods:
        guesses = [c.speed for c in result.methods["floquet"]]
        return nodes_around(guesses, *result.range)
    return np.linspace(*result.range, 1 + intervals_of_scan(result.range, narrowest))


def intervals_of_scan(span: tuple[float, float], narrowest: float | None) -> int:
    """Intervals in which the co-simulation looks where Floquet does not say where."""
    return SCAN if narrowest is None else math.ceil((span[1] - span[0]) / narrowest)
