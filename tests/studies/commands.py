"""Study: every command on every scene of a machine as it is built.

    python -m tests.studies.commands [SCENE ...] [--only COMMAND,...] [--at-most SECONDS]

Each command runs in a process of its own, in a folder of the scene.  Prints what came of it: "ok",
"refused" (exit code 2, with the message), "no" (exit code 1: an answer that is no success), "FAULT"
(a traceback or another exit code), or "slow" (more than the seconds allowed).  The answers are not
judged here: a message must be read.
"""

from __future__ import annotations

import csv
import math
import resource
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

import autobalancer as ab
from autobalancer.harness.master.names import station_residuals
from autobalancer.harness.result.many import cosimulate_many

# scene: what is varied and fitted with its value, and what is drawn over
VALUES = {
    "overhung_fan": ("rotor.support_stiffness[1][1]", "2 MN/m", "balls.drag"),
    "washing_machine_tub": ("tub.feet[1].stiffness[x]", "4 kN/m", "back.drag"),
    "angle_grinder": ("housing.mass", "2 kg", "balls.drag"),
    "small_turbine": ("rotor.bending_stiffness", "967 N m^2", "balls.drag"),
    "rubber_drive": ("frame.feet[1].loss_factor", "0.15", "fan_end.drag"),
    "washing_machine_stops": ("rotor.stops[1].gap", "10 mm", "ring.wave_damping"),
    "oval_fan": ("fairing.race[1].amplitude", "2 um", "fairing.drag"),
    "washing_machine_ring": ("ring.fill", "0.5", "ring.wave_damping"),
}
AT_MOST = 100.0  # s of each command
READINGS = (0.9, 0.95, 1.0)  # of the speed: where amplitudes for `fit` are taken


def measured(scene: ab.Scene, folder: Path) -> Path:
    """Amplitudes of the scene itself, as a file that `fit` reads."""
    path = folder / "measured.csv"
    with path.open("w", newline="") as out:
        table = csv.writer(out)
        table.writerow(["speed [rpm]", "amplitude [mm]"])
        top = scene.profile().end
        for ratio in READINGS:
            changed = scene.replace({"operation.run_up": None, "operation.speed": ratio * top})
            names = station_residuals(len(scene.rotor.points))
            at = [names[number - 1] for number in scene.rotor.supports]
            found = cosimulate_many(changed, {"speed": [ratio * top]}, results=at)
            size = float(np.mean([found[name][0] for name in at]))
            table.writerow([ratio * top * 30.0 / math.pi, 1e3 * size])
    return path


def commands(name: str) -> Iterator[tuple[str, list[str]]]:
    """Every command, its label first."""
    scene = ab.load(name)
    value, center, other = VALUES[name]
    top = scene.profile().end
    varied = f"{value}=lognormal({center},2%)"
    span = ["--range", repr(0.8 * top), repr(top)]
    yield "run", ["run", name, "-o", "run.csv", "--json", "run.json", "--plot", "run.png"]
    yield "pictures", ["run", name, "--orbits", "o.png", "--polar", "p.png", "--weights", "w.png",
                       "--compare", "c.png", "--waterfall", "f.png"]  # fmt: skip
    yield "movie", ["run", name, "--movie", "movie.gif", "--movie-seconds", "2"]
    yield "run --report", ["run", name, "--report", "report"]
    yield "run --separate", ["run", name, "--separate"]
    yield "speeds, default", ["speeds", name]
    yield "speeds", ["speeds", name, *span, "--method", "criterion,floquet", "--json", "s.json"]
    yield "speeds cosim", ["speeds", name, *span, "--method", "cosim"]
    yield "speeds proved", ["speeds", name, *span, "--method", "proved", "--narrowest",
                            repr(0.05 * top)]  # fmt: skip
    yield "map", ["map", name, "--x", f"speed={0.8 * top}:{top}:4", "--y", f"{other}=0.5:1:3",
                  "-o", "map.png", "--csv", "map.csv"]  # fmt: skip
    yield "map cosim-run", ["map", name, "--x", f"speed={0.8 * top}:{top}:3", "--y",
                            f"{other}=0.5:1:2", "--method", "cosim-run", "-o", "m.png"]  # fmt: skip
    yield "rotor", ["rotor", name, "--campbell", "c.png", "--response", "r.png", "--modes", "m.png",
                    "--run-up", "u.png", "--json", "rotor.json"]  # fmt: skip
    yield "design", ["design", name, "-n", "4", "--most", "4"]
    yield "scatter", ["scatter", name, "-n", "8", "--vary", varied, "-o", "s.csv", "-o", "s.png"]
    yield "fit", ["fit", name, "--measured", "measured.csv", "--free", value, "-o", "fit.png"]
    yield "fit --harmonic", ["fit", name, "--measured", "measured.csv", "--free", value,
                             "--harmonic"]  # fmt: skip
    yield "capture", ["capture", name, "-o", "c.png", "--json", "c.json"]
    yield "motions", ["motions", name, "-n", "3", "--plot", "m.png", "--json", "m.json"]
    yield "race", ["race", name, "--lobes", "2=5 um@30 deg"]
    yield "balance", ["balance", name, "--set", 'balancing.grade="G16"']
    yield "show", ["show", name, "-o", "show.html"]
    yield "report", ["report", name, "-o", "r.html", "--vary", varied, "-n", "4"]
    yield "cite", ["cite", name]
    yield "new", ["new", name, "-o", "new.toml"]
    yield "check", ["check", name]
    for fmi in ("2", "3"):
        one = ["--platform", "x86_64-linux", "--fmi", fmi]
        yield f"build {fmi}", ["build", name, "-o", f"separate{fmi}", *one]
        yield f"one file {fmi}", ["build", name, "-o", f"one{fmi}", "--one-file", *one]
        yield f"run one file {fmi}", ["run", f"one{fmi}/{name}.fmu"]
        yield f"ssp {fmi}", ["build", name, "-o", f"ssp{fmi}", "--ssp", *one]
        yield f"run ssp {fmi}", ["run", f"ssp{fmi}/{name}.ssp"]
    yield "one file ssp", ["build", name, "-o", "sspone", "--ssp", "--one-file", *one[:2]]
    yield "run one file ssp", ["run", f"sspone/{name}.ssp"]
    yield "python units", ["build", name, "-o", "python", "--python"]
    yield "run python", ["run", name, "--set", 'coupling.units="python"', "--set",
                         "coupling.steps_per_rev=40"]  # fmt: skip
    yield "reference", ["build", name, "-o", "ref", "--one-file", "--reference", *one[:2]]


def tried(arguments: Sequence[str], folder: Path, at_most: float) -> tuple[str, float, str]:
    """What came of a command: a word, its processor seconds, and the last line it said."""
    program = [sys.executable, "-m", "autobalancer.harness", *arguments]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    try:
        done = subprocess.run(
            program, cwd=folder, capture_output=True, text=True, timeout=at_most, check=False
        )
    except subprocess.TimeoutExpired:
        return "slow", at_most, " ".join(arguments)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
    said = [line for line in (done.stdout + "\n" + done.stderr).splitlines() if line.strip()]
    last = said[-1] if said else ""
    if "Traceback" in done.stderr or done.returncode not in (0, 1, 2):
        return "FAULT", spent, last
    return {0: "ok", 1: "no", 2: "refused"}[done.returncode], spent, last


def main(arguments: Sequence[str]) -> None:
    """Print the table."""
    left, only, at_most = list(arguments), None, AT_MOST
    for key in ("--only", "--at-most"):
        if key in left:
            at = left.index(key)
            text = left[at + 1]
            del left[at : at + 2]
            only, at_most = (text.split(","), at_most) if key == "--only" else (only, float(text))
    with tempfile.TemporaryDirectory(prefix="autobalancer-") as root:
        for name in left or VALUES:
            folder = Path(root) / name
            folder.mkdir()
            if only is None or any(word.startswith("fit") for word in only):
                measured(ab.load(name), folder)
            for label, words in commands(name):
                if only is None or any(label.startswith(word) for word in only):
                    word, spent, last = tried(words, folder, at_most)
                    print(f"{name:22} {label:18} {word:8} {spent:6.1f}  {last[:400]}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
