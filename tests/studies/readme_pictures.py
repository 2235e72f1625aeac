"""The two pictures at the top of README: `python -m tests.studies.readme_pictures`.

`balls_balance.png` is README's drum, whose balls move to the light side.  `bristol_one.png` is the
measured rig with three washers of unbalance and without balls.
"""

from __future__ import annotations

import re
import tempfile
import warnings
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import autobalancer as ab
from autobalancer.harness.checks.rig import BANDS
from autobalancer.harness.checks.rig_data import response, steady
from autobalancer.harness.output.ticks import logarithmic

ROOT = Path(__file__).resolve().parents[2]
IMAGES = ROOT / "harness" / "manual" / "images"
RED, BLUE, GREY = "#c03a2b", "#1f5fa8", "0.6"
SHARES = (0.0, 0.1, 0.6)  # of the time that the lower panel shows, at which the drum is drawn
WASHERS = 3


def drum() -> ab.Scene:
    """The scene that README prints."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    found = re.search(r"```toml my_drum\.toml\n(.*?)```", text, re.DOTALL)
    assert found is not None
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "my_drum.toml"
        path.write_text(found[1], encoding="utf-8")
        return ab.load(path)


def draw_balls(path: Path) -> None:
    """Balls at three times, seen turning with the drum, above the vibration with and without."""
    scene, shown = drum(), 2.5
    run, alone = scene.run(), scene.without_balancers().run()
    figure = Figure(figsize=(9.0, 5.4), layout="constrained")
    grid = figure.add_gridspec(2, 3, height_ratios=(1.25, 1.0))
    below = figure.add_subplot(grid[1, :])
    for column, share in enumerate(SHARES):
        time = share * shown
        k = int(np.searchsorted(run.time, time))
        axes = figure.add_subplot(grid[0, column])
        turn = np.linspace(0.0, 2.0 * np.pi, 181)
        axes.plot(np.cos(turn), np.sin(turn), color=GREY, lw=5.0, solid_capstyle="butt")
        axes.plot([1.0], [0.0], marker="s", ms=15, color=RED, ls="")
        angles = [run[f"balls.weight[{n}].angle"][k] for n in (1, 2, 3)]
        axes.plot(np.cos(angles), np.sin(angles), "o", ms=15, color=BLUE)
        axes.set(
            xlim=(-1.35, 1.35), ylim=(-1.35, 1.35), aspect="equal", title=f"after {time:.2g} s"
        )
        axes.set_axis_off()
        below.axvline(time, color=GREY, lw=0.8, ls=":")
        if not column:
            axes.annotate("unbalance", (0.8, 0.0), color=RED, ha="right", va="center")
            axes.annotate("balls", (-0.38, 0.62), color=BLUE, ha="left", va="center")
    for one, colour, label in ((alone, RED, "without balls"), (run, BLUE, "with balls")):
        size = 1e3 * np.hypot(one["rotor.x"], one["rotor.y"])
        inside = one.time <= shown
        below.plot(one.time[inside], size[inside], color=colour, lw=1.2, label=label)
    below.set(xlabel="time [s]", ylabel="vibration [mm]", xlim=(0.0, shown))
    below.set_ylim(bottom=0.0)
    below.legend(loc="upper right")
    below.grid(alpha=0.3)
    figure.savefig(path, dpi=110)


def draw_rig(path: Path) -> None:
    """Measured and co-simulated amplitude of the rig without balls."""
    speeds = np.arange(1000.0, 5001.0, 20.0)
    x, y = response(WASHERS, 0)
    figure = Figure(figsize=(7.0, 3.2), layout="constrained")
    axes = figure.subplots()
    axes.plot(x, y, ".", ms=3, color=GREY, label="measured (Rodrigues et al. 2010)")
    curve = steady(ab.load("bristol_friction").without_balancers(), WASHERS, speeds)
    for low, high in BANDS.values():
        there = (speeds >= low) & (speeds <= high)
        print(f"co-simulated resonance at {speeds[there][np.argmax(curve[there])]:g} rpm")
    axes.plot(speeds, curve, color=BLUE, lw=1.5, label="co-simulated")
    axes.set(xlabel="speed [rpm]", ylabel="amplitude [mm]", xlim=(1000.0, 5000.0))
    logarithmic(axes.yaxis)
    axes.legend(loc="upper right")
    axes.grid(alpha=0.3)
    figure.savefig(path, dpi=110)


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    draw_balls(IMAGES / "balls_balance.png")
    draw_rig(IMAGES / "bristol_one.png")
