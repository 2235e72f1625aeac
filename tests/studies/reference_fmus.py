"""The Reference-FMUs of the Modelica Association, run by our master and compared.

`python -m tests.studies.reference_fmus FOLDER` prints the table of `results/masters.md`.  FOLDER
holds the FMUs of https://github.com/modelica/Reference-FMUs, version 2 or 3, built by

    cmake -S Reference-FMUs -B build -DFMI_VERSION=3 && cmake --build build

in `build/fmus`.  Each runs at the steps of its solver.  It is compared with FMPy's `simulate_fmu`,
which makes the same calls and must give the same numbers, and with the exact motion: what is left
there is the error of the solver inside the FMU.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
from fmpy import simulate_fmu
from scipy.integrate import solve_ivp

import autobalancer as ab

Exact = Callable[[np.ndarray], np.ndarray]


class Case(NamedTuple):
    """A signal of an FMU, how it is run, and what is right.

    Attributes:
        step, stop: of communication, and the end [s].
        about: where the exact motion is from.
    """

    fmu: str
    signal: str
    step: float
    stop: float
    exact: Exact
    about: str


def _ball(time: np.ndarray) -> np.ndarray:
    """Height of a ball that falls 1 m and keeps 0.7 of its speed, by its parabolas."""
    g, height, begin, speed = 9.81, np.zeros(len(time)), 0.0, 0.0
    start, end = 1.0, np.sqrt(2.0 / 9.81)
    while begin < time[-1] and end - begin > 1e-9:
        here = (time >= begin) & (time < end)
        t = time[here] - begin
        height[here] = start + speed * t - 0.5 * g * t**2
        speed = 0.7 * (g * (end - begin) - speed)
        start, begin, end = 0.0, end, end + 2.0 * speed / g
    return height


def _oscillator(time: np.ndarray) -> np.ndarray:
    """x'' = mu (1 - x^2) x' - x from 2, mu = 1."""
    solved = solve_ivp(
        lambda _t, y: [y[1], (1.0 - y[0] ** 2) * y[1] - y[0]],
        (0.0, time[-1]), [2.0, 0.0], "DOP853", time, rtol=1e-11, atol=1e-12,
    )  # fmt: skip
    return np.asarray(solved.y[0])


CASES = (
    Case("BouncingBall", "h", 1e-2, 3.0, _ball, "parabolas"),
    Case("Dahlquist", "x", 0.1, 10.0, lambda t: np.exp(-t), "exp(-t)"),
    Case("VanDerPol", "x0", 1e-2, 20.0, _oscillator, "SciPy, DOP853"),
    Case("Stair", "counter", 0.2, 10.0, lambda t: np.floor(t + 1.0 + 1e-9), "floor(t) + 1"),
    Case("Feedthrough", "Float64_continuous_output", 0.1, 2.0, np.zeros_like, "its input, 0"),
)


def judged(case: Case, folder: Path) -> list[str]:
    """Cells of a line: until when it ran, differences from FMPy and from the exact motion."""
    path = folder / f"{case.fmu}.fmu"
    system = ab.load_system(path).replace({"coupling.step": case.step, "run.duration": case.stop})
    name = f"{system.unit[0].name}.{case.signal}"
    result = system.run(record=[name])
    theirs = simulate_fmu(
        path, stop_time=float(result.time[-1]), step_size=case.step, output_interval=case.step,
        output=[case.signal], fmi_type="CoSimulation",
    )  # fmt: skip
    count = min(len(theirs), len(result.time))
    apart = np.abs(result[name][:count] - theirs[case.signal][:count]).max()
    right = case.exact(result.time)
    error = np.abs(result[name] - right).max() / (np.abs(right).max() or 1.0)
    said = "asks to end" if any("asks to end" in event for event in result.events) else ""
    cells = [case.fmu, case.signal, f"{case.step:g}", f"{result.time[-1]:g}", f"{apart:.1e}"]
    return [*cells, f"{error:.1e}", case.about, said]


def main() -> None:
    """Print the table."""
    folder = Path(sys.argv[1])
    print("| FMU | signal | step, s | end, s | from FMPy | from exact | exact by | |")
    print("|---|---|---|---|---|---|---|---|")
    for case in CASES:
        print(f"| {' | '.join(judged(case, folder))} |")


if __name__ == "__main__":
    main()
