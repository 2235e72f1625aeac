"""Balls that stick, with and without a dip of the speed: `python -m tests.studies.sticking`.

Prints the rows of the last table in `harness/manual/tutorials/sticking.md`, and a slow run-up:
medians of machines whose balls start anywhere.
"""

from __future__ import annotations

import re
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import autobalancer as ab

PAGE = Path(__file__).parents[2] / "harness/manual/tutorials/sticking.md"
MACHINES, TIMES = 30, (0.8, 1.8, 2.8, 4.4)
MASS, UNBALANCE, SPEED = 5.016, 5e-4, 300.0  # kg with the balls, kg m, rad/s at the end
CREEP = 1e-6  # rad/s: a ball that is slower rests
PROFILES = {
    "plain": [[0, 0], [0.5, 300], [4.4, 300]],
    "with a dip": [[0, 0], [0.5, 300], [0.8, 300], [1.8, 120], [2.8, 300], [4.4, 300]],
    "slow": [[0, 0], [1.67, 300], [4.4, 300]],
}
RECORDED = ["balls.moment_xi", "balls.moment_eta"]
SPEEDS = [f"balls.weight[{k}].speed" for k in (1, 2)]


def main() -> None:
    """Print when the last ball stops, and what is left at some times."""
    text = re.search(r"```toml sticky.toml\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.S)
    assert text is not None
    with TemporaryDirectory() as folder:
        path = Path(folder) / "sticky.toml"
        path.write_text(text[1], encoding="utf-8")
        scene = ab.load(path)
    for resistance in (2e-3, 5e-4):
        for name, profile in PROFILES.items():
            changes = {"balls.rolling_resistance": resistance, "operation.profile": profile}
            stops, left = zip(
                *(_run(scene.replace(changes), k) for k in range(MACHINES)), strict=True
            )
            each = ", ".join(f"{value:.1f}" for value in np.median(left, axis=0))
            print(f"{resistance:g} {name}: last stops at {np.median(stops):.3g} s; {each} mm/s")


def _run(scene: ab.Scene, seed: int) -> tuple[float, np.ndarray]:
    """When the last ball stops [s], and the unbalance left at `TIMES` at full speed [mm/s]."""
    angles = np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi, 2).tolist()
    run = scene.replace({"balls.angles": angles}).run(record=RECORDED + SPEEDS)
    left = abs(UNBALANCE + run["balls.moment_xi"] + 1j * run["balls.moment_eta"])
    fastest = np.max([abs(run[name]) for name in SPEEDS], axis=0)
    grades = 1e3 * SPEED / MASS * np.interp(TIMES, run.time, left)
    return float(run.time[fastest > CREEP][-1]), grades


if __name__ == "__main__":
    main()
