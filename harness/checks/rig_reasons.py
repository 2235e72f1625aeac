"""Why some rows of the rig's checks do not hold: the same quantities with one value changed.

`python -m autobalancer.harness.checks.rig_reasons` prints them as a table in Markdown.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..scene import Scene, load_scene
from ..scene.check import RigCheck
from .rig import BANDS, GROUPS
from .rig_data import WASHER, steady, swept
from .rig_quantities import GRID, PROMINENT, SETTLED, STEPS, peak
from .rig_sweeps import FITTED_DRAG, SWEPT, first_peak
from .row import Rows

Line = tuple[str, str, str]  # what, of which scene, found

CHECK = RigCheck(kind="rig", flexible="bristol_flexible")
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


def authors_curve() -> Iterator[Line]:
    """Their curve without balls, washers where the tables have them and a little beside."""
    rig = load_scene("bristol")
    for place in (rig.rotor.unbalances[0].position, CLOSER):
        scene = rig.replace({"rotor.unbalances[1].position": place})
        for row in GROUPS["simulated"](scene, CHECK, Rows(scene.name, CHECK.kind)):
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


def _curve(scene: Scene, washers: int) -> np.ndarray:
    return steady(scene.replace(STEPS), washers, GRID, SETTLED)


if __name__ == "__main__":
    print("| row | of | co-simulated |\n|---|---|---:|")
    for part in (authors_curve, run_down_without_washers, stiffer_while_small):
        for line in part():
            print(f"| {' | '.join(line)} |", flush=True)
