"""Why some rows of the rig's checks do not hold: the same quantities with one value changed.

`python -m tests.studies.rig` prints them as a table in Markdown.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import minimize

from autobalancer.harness import Scene, load_scene
from autobalancer.harness.checks.rig import BANDS, GROUPS
from autobalancer.harness.checks.rig_data import (
    WASHER,
    at,
    response,
    steady,
    swept,
    with_washers,
)
from autobalancer.harness.checks.rig_sweeps import FITTED_DRAG, SWEPT, first_peak
from autobalancer.harness.checks.row import Rows
from autobalancer.harness.scene.balancer import WeightBalancer
from autobalancer.harness.units import RPM
from autobalancer.models.arrays import Array
from autobalancer.models.harmonic_balance import largest_displacement, unbalance_response
from tests.studies.rig.quantities import (
    CURVE,
    FITTED,
    GRID,
    MOTOR,
    OTHERS,
    PROMINENT,
    SETTLING,
    STEPS,
    WASHERS,
    WITH_BALLS,
    Quantity,
    peak,
    with_balls,
    with_fitted_balls,
)

Line = tuple[str, str, str]  # what, of which scene, found

CLOSER = 0.1373  # m: washers 2.5 mm nearer the disk; the tables know lengths to 5 mm
LEFT = 0.25  # washers: half of the static unbalance that balancing left at most
HOLDING = {  # supports along x whose sliders stick up to some 0.1 mm
    "rotor.support_stiffness[1][1]": 19740.0,
    "rotor.support_stiffness[2][1]": 19740.0,
    "rotor.support_damping[1][1]": 2.6,
    "rotor.support_damping[2][1]": 2.6,
    "rotor.friction[1].limit[1]": 0.7,
    "rotor.friction[2].limit[1]": 0.42,
    "rotor.friction[1].stiffness[1]": 8000.0,
    "rotor.friction[2].stiffness[1]": 8000.0,
}
AS_TABLED = {"rotor.unbalances[1].position": 0.1398}  # m: 9.8 mm beyond the balls
CLOSE = sorted({*CURVE, *range(CURVE[0], 2601, 20)})  # rpm, of which the check has every third
ECCENTRIC, TOWARDS = 5e-6, (0, 90, 180, 270)  # m, as measured; deg: nobody knows
RESISTANCES = (0.0, 1e-4, 1.5e-4, 2e-4, 3e-4)  # of the balls; the third one is fitted
STARTS = ((-0.7, -0.3), (0.3, 0.7))  # rad


def authors_curve() -> Iterator[Line]:
    """Their curve without balls, washers where the tables have them and a little beside."""
    rig = load_scene("bristol")
    for place in (rig.rotor.unbalances[0].position, CLOSER):
        scene = rig.replace({"rotor.unbalances[1].position": place})
        for row in GROUPS["simulated"](scene, Rows(scene.name, "rig")):
            yield row.quantity, f"washers at {1e3 * place:g} mm", f"{row.error:.1%}"


def run_down_without_washers() -> Iterator[Line]:
    """With half of the static unbalance that balancing may have left, either way."""
    rig = load_scene("bristol").replace(FITTED_DRAG)
    for angle in (0.0, np.pi):
        scene = rig.replace({"rotor.unbalances[1].angle": angle})
        (curve,) = swept(scene, [LEFT], *SWEPT, falling=True).values()
        said = f"{1e6 * LEFT * WASHER:.1f} g mm at {np.degrees(angle):.0f} deg"
        label = "first resonance with balls on the way down, washers: 0 [mm]"
        yield label, said, f"{first_peak(curve):.3f}"


def stiffer_while_small() -> Iterator[Line]:
    """Peaks along x with sliders as fitted, and with such as move the first with the amplitude."""
    friction = load_scene("bristol_friction")
    for said, scene in (("as fitted", friction), ("0.7 N, 8000 N/m", friction.replace(HOLDING))):
        curves = [_curve(scene, washers) for washers in range(1, 5)]
        for mode in ("cylindrical x", "conical x"):
            low, high = BANDS[mode]
            inside = (low < GRID) & (high > GRID)
            found = [
                f"{peak((GRID, one), BANDS[mode], PROMINENT):.0f} ({one[inside].max():.2f})"
                for one in curves
            ]
            yield f"critical speed, {mode}, 1 to 4 washers [rpm] (mm)", said, ", ".join(found)


def curves_without_balls() -> Iterator[Line]:
    """At more speeds than the check has, without those at which the motor shakes the rig, and with
    washers where the tables have them; by harmonic balance."""
    speeds = np.array(CLOSE, float)
    measured = np.array([at(response(n, 0), speeds, 12.5) for n in WASHERS])
    first = f"no balls, {speeds[0]:g} rpm, 0 to 4 washers [mm]"
    yield first, "measured", _listed(measured[:, 0])
    which = {
        "of the check": np.isin(speeds, CURVE),
        "20 rpm apart": np.full(len(speeds), True),
        f"20 rpm apart from {MOTOR:g} rpm": speeds >= MOTOR,
    }
    for place, scene in _by_place_of_washers():
        found = np.array([balanced(with_washers(scene, n), speeds) for n in WASHERS])
        yield first, f"washers {place}", _listed(found[:, 0])
        for said, here in which.items():
            curve = Quantity("curve", "", measured[:, here], found[:, here])
            fitted, others = (curve.rms(washers) for washers in (FITTED, OTHERS))
            label = "no balls, rms of the logarithms: 1 and 3 washers; 0, 2 and 4"
            times = f"{fitted:.2f}; {others:.2f}, {others / fitted:.2f} times"
            yield label, f"washers {place}, speeds {said}", times


def _by_place_of_washers() -> Iterator[tuple[str, Scene]]:
    friction = load_scene("bristol_friction")
    yield "at the disk", friction
    yield "at 139.8 mm", friction.replace(AS_TABLED)


def balanced(scene: Scene, speeds: ArrayLike) -> Array:
    """Amplitudes (k,) of a rotor alone [mm], by harmonic balance."""
    motion = unbalance_response(scene.assembly().rotor, RPM * np.asarray(speeds))
    supports = [number - 1 for number in scene.rotor.supports]
    return 1e3 * largest_displacement(motion)[:, supports].mean(axis=1)


def wherever_balls_stand() -> Iterator[Line]:
    """What balls could leave of three washers at best, by harmonic balance, and the rig's."""
    label = "balls, 3 washers, 3000, 4000, 4500, 5000 rpm [mm]"
    yield label, "measured", _listed(at(response(3, 2), WITH_BALLS))
    for place, scene in _by_place_of_washers():
        least = least_with_balls(with_fitted_balls(scene), 3)
        yield label, f"least of all positions, washers {place}", _listed(least)


def least_with_balls(scene: Scene, washers: float) -> Array:
    """Amplitudes (k,) at `WITH_BALLS` [mm], each with the balls where it is least."""
    (balls,) = scene.balancer
    assert isinstance(balls, WeightBalancer)  # the rig's
    alone = with_washers(scene.without_balancers(), washers)
    others = [one.model_dump() for one in alone.rotor.unbalances]
    disk, reach = scene.rotor.stations[balls.at - 1], balls.count * balls.device.moment

    def amplitude(place: ArrayLike, speed: float) -> float:
        size, angle = np.asarray(place).tolist()  # two balls reach any moment up to theirs
        both = {"position": disk, "amount": size * reach, "angle": angle}
        scene = alone.replace({"rotor.unbalances": [*others, both]})
        return float(balanced(scene, [speed])[0])

    search: dict[str, Any] = {"x0": (0.9, math.pi), "bounds": ((0.0, 1.0), (0.0, math.tau))}
    return np.array([minimize(amplitude, args=(speed,), **search).fun for speed in WITH_BALLS])


def balls_after_the_run_up() -> Iterator[Line]:
    """By rolling resistance, with the race off centre as measured, and from elsewhere."""
    scene = with_fitted_balls(load_scene("bristol_friction"))
    run_ups: dict[str, dict[str, Any]] = {
        f"rolling resistance {value:g}": {"balls.rolling_resistance": value}
        for value in RESISTANCES
    }
    for angle in TOWARDS:
        place = cmath.rect(ECCENTRIC, math.radians(angle))
        offset = {"track_offset_xi": place.real, "track_offset_eta": place.imag}
        said = f"race {1e6 * ECCENTRIC:g} um off centre, at {angle} deg"
        run_ups[said] = {f"balls.{key}": value for key, value in offset.items()}
    for first, second in STARTS:
        run_ups[f"balls from {first:+g} and {second:+g} rad"] = {"balls.angles": [first, second]}
    run_ups["washers at 139.8 mm"] = AS_TABLED
    for said, changes in run_ups.items():
        found, _ = with_balls(scene.replace(changes))
        errors = f"{_listed(found.errors, 2)}; {found.rms():.2f}"
        yield f"{found.label}: 0 to 4 washers; all", said, errors


def _listed(values: Array, digits: int = 4) -> str:
    return ", ".join(f"{value:.{digits}f}" for value in values)


def _curve(scene: Scene, washers: int) -> np.ndarray:
    return steady(scene.replace(STEPS), washers, GRID, SETTLING)


if __name__ == "__main__":
    print("| row | of | co-simulated |\n|---|---|---:|")
    for part in (
        authors_curve,
        run_down_without_washers,
        stiffer_while_small,
        curves_without_balls,
        wherever_balls_stand,
        balls_after_the_run_up,
    ):
        for line in part():
            print(f"| {' | '.join(line)} |", flush=True)
