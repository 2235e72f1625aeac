"""Study: what do the one file's calls cost in a tool?

    python -m tests.studies.fmpy_times [SCENE ...]

Through FMPy: 400 calls of `doStep` over 20 revolutions, each with two outputs read behind it, in a
slave that exists already; and the same motion by model exchange under CVode (relative tolerance
1e-6).  Processor time, the smallest of several runs in turn.
"""

from __future__ import annotations

import math
import sys
import tempfile
import time
import warnings
from pathlib import Path

import fmpy
from fmpy import platform_tuple, simulate_fmu

from autobalancer.harness import load_scene
from tests.native.packaging import Host

SCENES = ["two_balls", "drum", "three_mass_shaft", "balls_and_liquid", "filimonikhina"]
EVENTFUL = ["finite_weights", "contact_order", "run_up"]  # weights that collide, touch; a corner
CALLS, REVOLUTIONS, REPEATS = 400, 20, 5


def stepped(path: Path, length: float, names: list[str]) -> float:
    """Seconds of the calls."""
    host = Host(path).begin()
    begun = time.process_time()
    for _ in range(CALLS):
        host.step(length)
        host.get(*names)
    spent = time.process_time() - begun
    host.free()
    return spent


def exchanged(path: Path, stop: float, names: list[str]) -> float:
    """Seconds of a run under CVode, what FMPy does around it included."""
    begun = time.process_time()
    simulate_fmu(
        str(path), stop_time=stop, output_interval=stop / CALLS, output=names,
        fmi_type="ModelExchange", relative_tolerance=1e-6,
    )  # fmt: skip
    return time.process_time() - begun


def line(name: str, folder: Path) -> str:
    """Both times of a scene."""
    scene = load_scene(name)
    path = scene.build(folder / name, platforms=[platform_tuple], one_file=True).files[0]
    description = fmpy.read_model_description(str(path))
    inside = {v.name for v in description.modelVariables}
    names = [n for n in ("rotor.x", "rotor.y") if n in inside]
    names = names or ["rotor.station[1].x", "rotor.station[1].y"]
    stop = REVOLUTIONS * 2.0 * math.pi / scene.profile().end
    steps = min(stepped(path, stop / CALLS, names) for _ in range(REPEATS))
    found = f"{name:20} {CALLS} doStep {steps * 1e3:7.1f} ms"
    if description.modelExchange is None:
        return f"{found}, no model exchange"
    solver = min(exchanged(path, stop, names) for _ in range(REPEATS))
    return f"{found}, CVode {solver * 1e3:7.1f} ms"


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as where:
        for one in sys.argv[1:] or [*SCENES, *EVENTFUL]:
            print(line(one, Path(where)), flush=True)
