"""How often the intervals of `fit` cover the truth, on clean data and under a constant run-out.

    python -m tests.studies.fit_intervals [COUNT] [--seed 1] [--row SPEEDS SCATTER RUNOUT]...

A Jeffcott rotor in closed form is measured at 24 or 48 speeds with scatter of 0.5 or 3 %; a run-out
of 0 to 40 % of the amplitude far above resonance is added as a vector.  Stiffness and damping are
fitted by `fit` with `--harmonic`.  A value is silently excluded where an interval is given without
a warning and does not cover the truth.
"""

from __future__ import annotations

import argparse
import itertools
import tempfile
from pathlib import Path

import numpy as np

from autobalancer.harness import load_scene
from autobalancer.harness.fit.measured import read_measured
from autobalancer.harness.fit.parameters import parse_free
from autobalancer.harness.fit.study import fit

MASS, STIFFNESS, DAMPING, UNBALANCE = 2.0, 800.0, 6.0, 0.01
POINTS, SCATTERS = (8, 24, 48), (0.005, 0.03)
RUNOUTS = (0.0, 0.01, 0.02, 0.05, 0.1, 0.4)
ROW = ("SPEEDS", "SCATTER", "RUNOUT")
FREE = ["rotor.stiffness[1]=rotor.stiffness[2]", "rotor.damping"]


def response(speed):
    """Complex amplitude of a Jeffcott rotor [m]."""
    return UNBALANCE * speed**2 / (STIFFNESS - MASS * speed**2 + 1j * DAMPING * speed)


def rotor():
    """The scene that is fitted; it starts off the truth."""
    start = {"rotor.mass": MASS, "rotor.stiffness": 900.0, "rotor.damping": 5.0}
    run = {"rotor.unbalance": UNBALANCE, "run.revolutions": 50, "coupling.steps_per_rev": 20}
    return load_scene("two_balls").without_balancers().replace(start | run)


def one(scene, free, folder, speeds, scatter, runout, random):
    """Whether intervals are given, whether they cover the truth (2,), and no warning is."""
    vector = runout * UNBALANCE / MASS * np.exp(2j * np.pi * random.uniform())
    seen = np.abs(response(speeds) + vector) * np.exp(scatter * random.standard_normal(len(speeds)))
    path = folder / "measured.csv"
    rows = "".join(f"{w},{a}\n" for w, a in zip(speeds, seen, strict=True))
    path.write_text(f"speed,amplitude [m]\n{rows}")
    found = fit(scene, read_measured(path, scene), free, harmonic=True)
    off = np.abs(found.values - (STIFFNESS, DAMPING))
    given = np.isfinite(found.uncertainty)
    return given, off <= np.where(given, found.uncertainty, np.inf), not found.warnings()


def coverage(count, speeds, scatter, runout, seed=1):
    """Shares: intervals given, of these with a warning, of these that cover (2,), silent misses.

    A silent miss is a truth (2,) outside of an interval without a warning, over all files.
    """
    scene, random = rotor(), np.random.default_rng(seed)
    free = parse_free(FREE, scene)
    with tempfile.TemporaryDirectory() as folder:
        rest = (Path(folder), speeds, scatter, runout, random)
        outcomes = [one(scene, free, *rest) for _ in range(count)]
    given, covers, silent = (np.array(column) for column in zip(*outcomes, strict=True))
    given = given.all(axis=1)
    share = covers[given].mean(axis=0) if given.any() else np.full(2, np.nan)
    warned = np.mean(~silent[given]) if given.any() else np.nan
    return given.mean(), warned, share, (~covers & silent[:, None]).mean(axis=0)


def main():
    """Print a row for every number of speeds, scatter and run-out."""
    parser = argparse.ArgumentParser(description="coverage of the intervals of fit")
    parser.add_argument("count", type=int, nargs="?", default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--row", type=float, nargs=3, action="append", metavar=ROW)
    given = parser.parse_args()
    print(
        "speeds scatter run-out | given, of these warned | cover where given (k, d) | silent (k, d)"
    )
    for points, scatter, runout in given.row or itertools.product(POINTS, SCATTERS, RUNOUTS):
        speeds = np.linspace(8.0, 45.0, int(points))
        told, warned, covers, missed = coverage(given.count, speeds, scatter, runout, given.seed)
        cells = [f"{100.0 * v:5.1f} %" for v in (told, warned, *covers, *missed)]
        print(f"{points:4g} {scatter:7.3f} {runout:7.2f} |", *cells, flush=True)


if __name__ == "__main__":
    main()
