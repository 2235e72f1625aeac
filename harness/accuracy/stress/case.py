"""What a stress case is, and how its run is compared with a reference that is right there."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....models.monolith import reference
from ....models.reference.oscillator import forced_motion
from ...errors import SimulationError
from ...master.limits import STATED_ERROR
from ...result.result import Result
from ...result.run import cosimulate
from ...scene import Scene, load_scene

UNEVEN = (2, 4, 6, 8, 10, 12, 14)  # powers of ten of the stiffness along y, 1e2 N/m along x
LEFT_ALONE = 1e-2  # of the range: a picture would not show it; asked of the default coupling
TOLERANCE = 1e-5  # asked of the runs with a tolerance
FACTOR = 10.0  # by which the error that a run states of itself may be too small
PROMISED = 3.0 * TOLERANCE  # what the error may be then
REFERENCE_SHARE = 0.1  # of the error allowed: a reference less certain proves nothing
STATES = ("x", "y", "vx", "vy", "angle", "speed")  # for which the reference states its error
XY = ("rotor.x", "rotor.y")
ROTOR_AND_MOMENT = (*XY, "weights.moment_xi", "weights.moment_eta")

_ADVICE = re.compile(r"\buse\b")  # in a refusal: what to do

Series = Mapping[str, NDArray[np.float64]]


@dataclass(frozen=True)
class Outcome:
    """What came of a case, in words, and whether that is a right answer or a clear refusal."""

    text: str
    holds: bool


@dataclass(frozen=True)
class Case:
    """One extreme: its name, what is expected in words, and how to find out."""

    name: str
    expected: str
    run: Callable[[], Outcome]


def planar_scene(
    rotor: Mapping[str, Any],
    *balancers: Mapping[str, Any],
    speed: float = 3.0,
    run_up: Mapping[str, float] | None = None,
    revolutions: float = 5.0,
    initial: Mapping[str, float] | None = None,
    record: Sequence[str] | None = None,
    **coupling: Any,
) -> Scene:
    """A planar scene from its tables."""
    run: dict[str, Any] = {"revolutions": revolutions, "initial": dict(initial or {})}
    if record is not None:
        run["record"] = list(record)
    return Scene.from_document(
        {
            "rotor": {"kind": "planar", **rotor},
            "balancer": [dict(b) for b in balancers],
            "operation": {"run_up": dict(run_up)} if run_up else {"speed": speed},
            "coupling": coupling,
            "run": run,
        },
        label="stress",
    )


def left_to_the_master(name: str, changes: Mapping[str, Any]) -> Scene:
    """A bundled scene over five revolutions, changed, with the default coupling."""
    free = dict.fromkeys(("scheme", "order", "corrections", "steps_per_rev"))
    default = {f"coupling.{key}": value for key, value in free.items()}
    return load_scene(name).replace({**default, "run.revolutions": 5, **changes})


def uneven(power: int, damping: float, unbalance: float) -> dict[str, Any]:
    """Rotor of 1 kg on 1e2 N/m along x and 1e`power` N/m along y.

    Args:
        damping: along y, over the root of the stiffness there.
    """
    stiff = 10.0**power
    return {
        "mass": 1.0,
        "stiffness": [1e2, stiff],
        "damping": [2.0, damping * math.sqrt(stiff)],
        "unbalance": unbalance,
    }


def deviation(result: Result, expected: Series, together: bool = False) -> float:
    """Largest difference over time and signals, relative to each signal's range; NaN if any is.

    Args:
        together: relative to the largest range of all.
    """
    scales = {n: np.ptp(right) or np.max(np.abs(right)) or 1.0 for n, right in expected.items()}
    if together:
        scales = dict.fromkeys(scales, max(scales.values()))
    off = [np.max(np.abs(result[n] - right)) / scales[n] for n, right in expected.items()]
    return float(np.max([0.0, *off]))


def linear_motion(scene: Scene, times: NDArray[np.float64]) -> Series:
    """x and y of a planar rotor at constant speed whose balancers, if any, only add mass."""
    rotor, w = scene.rotor.build(), scene.profile().end
    loaded = scene.assembly().loaded_rotor
    mass = float(loaded.mass[0, 0])
    pull = complex(rotor.unbalance[0]) * w * w * np.exp(1j * scene.run.initial.angle)
    start, inner = scene.run.initial, float(rotor.internal_damping[0, 0])
    z0, v0 = complex(start.x, start.y), complex(start.vx, start.vy)
    c_x, c_y = float(rotor.damping_x[0, 0]), float(rotor.damping_y[0, 0])
    k_x, k_y = float(rotor.stiffness_x[0, 0]), float(rotor.stiffness_y[0, 0])
    if rotor.isotropic:
        z = forced_motion(mass, c_x + inner, k_x - 1j * inner * w, pull, w, times, z0, v0)
        return {"rotor.x": z.real, "rotor.y": z.imag}
    if inner:
        raise ValueError("internal damping couples the axes of an anisotropic rotor")
    x = forced_motion(mass, c_x, k_x, pull, w, times, z0.real, v0.real)
    y = forced_motion(mass, c_y, k_y, pull, w, times, 1j * z0.imag, 1j * v0.imag)
    return {"rotor.x": x.real, "rotor.y": y.imag}


def stated_error(result: Result) -> float:
    """Error that a run states for too coarse steps, of its motion; 0 if it states none."""
    return result.estimated_error if result.estimated_error >= STATED_ERROR else 0.0


# (scene, its run, error allowed) -> right motion, and its own error
Right = Callable[[Scene, Result, float], tuple[Series, float]]


def closed_form(scene: Scene, result: Result, _allowed: float) -> tuple[Series, float]:
    """The motion without weights."""
    return linear_motion(scene, result.time), 0.0


def monolith(**options: Any) -> Right:
    """The motion by the monolith's reference, whose own error is below a tenth of that allowed.

    Args:
        options: of `models.monolith.reference`.
    """

    def right(scene: Scene, result: Result, allowed: float) -> tuple[Series, float]:
        motion, own = reference(
            scene.assembly(),
            scene.profile(),
            result.time,
            initial=scene.run.initial.motion(),
            signals=[name for name in result.signals if name.rpartition(".")[2] in STATES],
            bound=REFERENCE_SHARE * allowed,
            **options,
        )
        return {name: motion.signal(name) for name in result.signals}, own

    return right


def compare(
    scene: Scene,
    signals: Sequence[str],
    right: Right,
    allowed: float,
    separate: bool = False,
    together: bool = False,
) -> tuple[float, float, Result]:
    """Error of a scene's run in `signals`, as `deviation`, that of the right motion, and the run.

    Raises:
        ReferenceDisagreement: nobody knows what is right.
    """
    result = cosimulate(scene, record=signals, separate=separate)
    motion, own = right(scene, result, allowed)
    return deviation(result, motion, together), own, result


def against_closed_form(scene: Scene, allowed: float) -> Outcome:
    """Run a scene without weights by both engines and compare with its closed form.

    In one piece the error is that of the displacement: of its larger component.
    """
    found = [
        compare(scene, XY, closed_form, allowed, separate, together=not separate)
        for separate in (False, True)
    ]
    error, steps = max(error for error, *_ in found), found[0][-1].steps
    return Outcome(f"error {error:.1e} over {steps} steps", error <= allowed)


BOTH_WAYS = (
    f"as it is error below {LEFT_ALONE:g} of the range or reported as too coarse, "
    f"below {PROMISED:g} with tolerance {TOLERANCE:g}"
)


def both_ways(scene: Scene, signals: Sequence[str], right: Right) -> Outcome:
    """A scene left alone, by both engines where it has no events, and with a tolerance."""
    text, holds, worst = _left_alone(scene, signals, right, False)
    if not scene.has_events:
        words, also, own = _left_alone(scene, signals, right, True)
        text, holds, worst = f"{text}; separate {words}", holds and also, max(worst, own)
    kept = scene.replace({"coupling.tolerance": TOLERANCE})
    try:
        error, own, result = compare(kept, signals, right, PROMISED)
    except SimulationError as refusal:
        return Outcome(f"{text}; tolerance {TOLERANCE:g} refused ({refusal})", False)
    text += f"; tolerance {TOLERANCE:g}: {error:.1e} in {result.steps} steps"
    worst = max(worst, own)
    text += f"; reference {worst:.0e}" * bool(worst)
    return Outcome(text, holds and error <= PROMISED)


def _left_alone(
    scene: Scene, signals: Sequence[str], right: Right, separate: bool
) -> tuple[str, bool, float]:
    """A run of a scene as it is, which may be refused, or state that its steps are too long."""
    try:
        error, own, result = compare(scene, signals, right, LEFT_ALONE, separate)
    except SimulationError as refusal:
        return f"as it is refused ({refusal})", bool(_ADVICE.search(str(refusal))), 0.0
    text = f"as it is {error:.1e} in {result.steps} steps"
    if stated := stated_error(result):
        text = f"{text} and reported as too coarse ({stated:.1g})"
    return text, error <= max(LEFT_ALONE, FACTOR * stated), own


def against_monolith(
    scene: Scene, signals: Sequence[str] = ROTOR_AND_MOMENT, **options: Any
) -> Outcome:
    """Run a scene with weights and compare `signals` with the monolith's reference."""
    return both_ways(scene, signals, monolith(**options))


def refusal(run: Callable[[], object], *words: str) -> Outcome:
    """Expect a `SimulationError` whose message has all of `words`."""
    try:
        run()
    except SimulationError as error:
        missing = [word for word in words if word not in str(error)]
        return Outcome(f"refused: {error}", not missing)
    return Outcome("no refusal", False)
