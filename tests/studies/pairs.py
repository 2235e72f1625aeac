"""How often the stated error is right: random pairs of linear oscillators, against exact solutions.

`python -m tests.studies.pairs [COUNT] [--seed N] [--stateless] [--picture FILE]` couples a mass
with a bracket that carries an oscillator, both of pythonfmu, at tolerances of 1e-2 to 1e-4.  The
force of the bracket answers the acceleration of the mass at once: the loop gain is 0.1 to 3.  The
exact motion is a matrix exponential.  Printed is how stated over true error is distributed.  FMUs
that are stateless cannot restore a state: each step is taken once.  A picture shows both kinds.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from scipy.linalg import expm

import autobalancer as ab

GUESTS = Path(__file__).parents[1] / "guests"
DURATION = 2.0  # s
WITHIN = 3.0  # stated over true error, and its inverse
EVERY = 20  # pairs between two reports
SIGNALS = ("mass.x", "mass.v", "mass.a", "bracket.F")
WIRES = {"mass.x": "bracket.x", "mass.v": "bracket.v", "mass.a": "bracket.a", "bracket.F": "mass.F"}


@dataclass(frozen=True)
class Pair:
    """A mass (m, c, k) with a bracket (gain times m), and on it an oscillator (m2, c2, k2)."""

    m: float
    c: float
    k: float
    gain: float
    m2: float
    c2: float
    k2: float
    tolerance: float

    def system(self, mass: Path, bracket: Path) -> ab.System:
        """The pair as FMUs that start displaced."""
        own = {"m": self.m, "c": self.c, "k": self.k, "x0": 1.0}
        other = {"mb": self.gain * self.m, "m": self.m2, "c": self.c2, "k": self.k2, "z0": -0.5}
        return ab.System(
            unit=[
                {"name": "mass", "fmu": str(mass), "start": own},
                {"name": "bracket", "fmu": str(bracket), "start": other},
            ],
            connection=[{"from": source, "to": target} for source, target in WIRES.items()],
            coupling={"tolerance": self.tolerance},
            run={"duration": DURATION, "record": list(SIGNALS)},
        )

    def exact(self, time: np.ndarray) -> dict[str, np.ndarray]:
        """The signals at times, by the matrix exponential of both in one piece."""
        whole = self.m * (1.0 + self.gain)
        rows = np.array([
            [0.0, 1.0, 0.0, 0.0],
            np.array([-(self.k + self.k2), -(self.c + self.c2), self.k2, self.c2]) / whole,
            [0.0, 0.0, 0.0, 1.0],
            np.array([self.k2, self.c2, -self.k2, -self.c2]) / self.m2,
        ])  # fmt: skip
        states = np.array([expm(rows * t) @ [1.0, 0.0, -0.5, 0.0] for t in time]).T
        x, v, a = states[0], states[1], rows[1] @ states
        return {"mass.x": x, "mass.v": v, "mass.a": a,
                "bracket.F": self.m * a + self.c * v + self.k * x}  # fmt: skip


def drawn(count: int, seed: int, tolerances: tuple[float, ...] = (1e-2, 1e-3, 1e-4)) -> list[Pair]:
    """Random pairs; gains spread evenly on a logarithmic scale."""
    generator = np.random.default_rng(seed)

    def log(low: float, high: float) -> float:
        return float(np.exp(generator.uniform(np.log(low), np.log(high))))

    pairs = []
    for _ in range(count):
        m, m2 = log(0.2, 5.0), log(0.2, 5.0)
        k, k2 = m * log(2.0, 60.0), m2 * log(2.0, 60.0)
        c, c2 = (2.0 * log(1e-3, 0.3) * np.sqrt(a * b) for a, b in ((m, k), (m2, k2)))
        gain, tolerance = log(0.1, 3.0), float(generator.choice(tolerances))
        pairs.append(Pair(m, float(c), k, gain, m2, float(c2), k2, tolerance))
    return pairs


def judged(pair: Pair, mass: Path, bracket: Path) -> tuple[float, float]:
    """Stated error of a pair's run, and the true one."""
    result = pair.system(mass, bracket).run()
    exact = pair.exact(result.time)
    true = max(np.abs(result[n] - exact[n]).max() / np.abs(exact[n]).max() for n in SIGNALS)
    return result.estimated_error, float(true)


def built(folder: Path, state: bool = True) -> tuple[Path, Path]:
    """The FMUs of both; `state`: they restore their states."""
    from pythonfmu.builder import FmuBuilder

    options = {"canGetAndSetFMUstate": True} if state else {}
    made = [
        FmuBuilder.build_FMU(GUESTS / f"{name}.py", dest=folder, **options)
        for name in ("mass", "bracket")
    ]
    return Path(made[0]), Path(made[1])


def main() -> None:
    """Judge random pairs, and print the distribution."""
    parser = argparse.ArgumentParser(prog="python -m tests.studies.pairs")
    parser.add_argument("count", nargs="?", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--stateless", action="store_true")
    parser.add_argument("--picture", type=Path)
    asked = parser.parse_args()
    pairs, ratios = drawn(asked.count, asked.seed), []
    for stateless in (False, True) if asked.picture else (asked.stateless,):
        print("FMUs that cannot roll back" if stateless else "FMUs that roll back")
        ratios += judge(pairs, stateless)
    if asked.picture:
        draw(2 * pairs, ratios, asked.picture)


def judge(pairs: list[Pair], stateless: bool) -> list[float]:
    """Stated over true errors of pairs; prints their distribution."""
    ratios: list[float] = []
    kept = 0
    with TemporaryDirectory() as folder:
        files = built(Path(folder), not stateless)
        for number, pair in enumerate(pairs, start=1):
            stated, true = judged(pair, *files)
            ratios.append(stated / true)
            kept += true <= pair.tolerance
            if not 1.0 / WITHIN <= ratios[-1] <= WITHIN:
                print(f"{number}: stated {stated:.2g}, true {true:.2g}, {pair}", flush=True)
            if number % EVERY == 0:
                tell(ratios, kept)
    tell(ratios, kept)
    return ratios


def draw(pairs: list[Pair], ratios: list[float], path: Path) -> None:
    """Stated over true error, over the loop gain and as a distribution."""
    from matplotlib.figure import Figure

    from autobalancer.harness.output.ticks import logarithmic

    figure = Figure(figsize=(9.0, 3.6), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True, width_ratios=(3, 1))
    for tolerance, style in ((1e-2, "C0o"), (1e-3, "C1s"), (1e-4, "C2^")):
        own = [(p.gain, r) for p, r in zip(pairs, ratios, strict=True) if p.tolerance == tolerance]
        if own:
            left.plot(*zip(*own, strict=True), style, ms=4, label=f"tolerance {tolerance:g}")
    for axis in (left.xaxis, left.yaxis):
        logarithmic(axis)
    left.set(xlabel="loop gain", ylabel="stated over true error")
    left.legend(fontsize="small")
    right.hist(ratios, bins=np.geomspace(0.2, 5.0, 41), orientation="horizontal", color="0.5")
    right.set(xlabel="pairs", ylim=(0.2, 5.0))
    for axes in (left, right):
        for limit in (1.0 / WITHIN, 1.0, WITHIN):
            axes.axhline(limit, color="0.7" if limit != 1.0 else "0.3", lw=0.8)
    figure.savefig(path, dpi=150)


def tell(ratios: list[float], kept: int) -> None:
    """Print how stated over true error is distributed so far."""
    count = len(ratios)
    shares = np.percentile(ratios, [0, 5, 25, 50, 75, 95, 100])
    print(f"{count} pairs: {kept} within their tolerance")
    print("stated over true error, 0, 5, 25, 50, 75, 95, 100 %:", *(f"{s:.3g}" for s in shares))
    inside = sum(1.0 / WITHIN <= ratio <= WITHIN for ratio in ratios)
    below = sum(ratio < 1.0 for ratio in ratios)
    print(f"within {WITHIN:g}: {inside} of {count}; below true: {below}", flush=True)


if __name__ == "__main__":
    main()
