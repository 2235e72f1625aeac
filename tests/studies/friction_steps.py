"""How far given steps are off where supports stick: the table of `explanation/events.md`.

    python -m tests.studies.friction_steps

README's drum for 30 revolutions, with separate FMUs, against many more steps.
"""

from __future__ import annotations

import re
import warnings
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from autobalancer.harness import Scene, cosimulate, load_scene

README = Path(__file__).parents[2] / "README.md"
SIGNALS = ["rotor.x", "rotor.y"]
STEPS, FINEST = (20, 40, 80), 1280  # per revolution
SLIDERS = {
    "with springs": [{"support": 1, "limit": [15, 18], "stiffness": 1e4}],
    "rigid": [{"support": 1, "limit": [5, 8]}],
}


def drum() -> Scene:
    """The scene `my_drum.toml` of README, for 30 revolutions."""
    text = re.search(r"```toml my_drum.toml\n(.*?)```", README.read_text("utf-8"), re.DOTALL)
    assert text
    with TemporaryDirectory() as folder:
        path = Path(folder) / "my_drum.toml"
        path.write_text(text[1], "utf-8")
        return load_scene(path).replace({"run.revolutions": 30})


def errors(scene: Scene) -> list[float]:
    """Largest error of x and y over the largest amplitude, by the number of steps."""

    def run(steps: int) -> np.ndarray:
        given = scene.replace({"coupling.steps_per_rev": steps})
        found = cosimulate(given, record=SIGNALS, separate=True)
        return np.array([found[name] for name in SIGNALS])

    right = run(FINEST)
    size = abs(right).max()
    return [float(abs(run(n) - right[:, :: FINEST // n]).max() / size) for n in STEPS]


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    print("sliders: errors at", *STEPS, "steps per revolution")
    for name, sliders in SLIDERS.items():
        scene = drum().replace({"rotor.friction": sliders})
        print(name, *(f"{error:.1e}" for error in errors(scene)))
