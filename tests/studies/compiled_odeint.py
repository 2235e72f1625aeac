"""Study: how much faster is the one file than SciPy's fastest with a compiled right-hand side?

    pip install numba
    python -m tests.studies.compiled_odeint [CASE ...]

The one file and `odeint`, with the equations below compiled by numba, run with many tolerances.
Both are read at the same 20 points per revolution.  Prints the least processor time for
an error of 1e-3, 1e-5, 1e-7 and 1e-9 [ms], and the ratio of the two.  The error is the largest
difference from DOP853 with a tolerance of 1e-13, of displacements over the largest, of angles over
1 rad.  Both are one run of a machine that is set up; what sets up the one file is printed beside
it, numba compiles for some seconds.  `ends`: the one file read at the ends of its steps instead.
"""

from __future__ import annotations

import math
import sys
import time
import warnings
from collections.abc import Callable, Sequence
from functools import lru_cache
from types import SimpleNamespace

import numpy as np

from autobalancer.fmus.composite.batch import BatchRuns
from autobalancer.harness import Scene, load_scene
from autobalancer.harness.master.compared import motion_signals
from autobalancer.harness.master.one_file import composition
from autobalancer.harness.master.schedule import end_time
from autobalancer.models.monolith import integrate
from autobalancer.models.reference.coupled import Monolith

HEAVY = {"rotor.mass": 0.5, "weights.mass": 0.25, "rotor.unbalance": 0.25, "weights.drag": 0.125}
STIFF = {"rotor.stiffness": [1.0, 1e4], "rotor.damping": [0.5, 14.0]}
SCENES = ("two_balls", "drum", "three_mass_shaft", "two_plane_rodrigues", "balls_and_liquid")
CASES = {name: (name, {}) for name in (*SCENES, "run_up", "filimonikhina")}
CASES |= {"ky = 1e4 kx": ("two_balls", STIFF), "half the mass in balls": ("two_balls", HEAVY)}
ERRORS = (1e-3, 1e-5, 1e-7, 1e-9)
PER_REVOLUTION, MOST_ROWS, ROUNDS, AT_ONCE = 20, 30, 5, 10
FINEST = 1e-13


def compiled(system: Monolith, begin: float, stop: float) -> Callable:
    """The right-hand side between two corners of the speed: M less what the weights take."""
    import numba  # a package that the tests do without

    n, count, profile = system.stations, system.weights, system.profile
    loaded, mounted = system.assembly.loaded_rotor, system.assembly.weights
    u = loaded.unbalance
    swirl, gyro = loaded.internal_damping, loaded.gyroscopic
    zero = np.zeros((n, n))
    mass = np.kron(np.eye(2), loaded.mass)
    pull = np.block([[loaded.stiffness_x, zero], [zero, loaded.stiffness_y]])
    damp = np.block([[loaded.damping_x + swirl, zero], [zero, loaded.damping_y + swirl]])
    pull_by_speed = np.block([[zero, swirl], [-swirl, zero]])
    damp_by_speed = np.block([[zero, gyro], [-gyro, zero]])
    ur, ui = u.real.copy(), u.imag.copy()
    each = [(m.plane, one) for m in mounted for one in m.device.each]
    rows = np.array([loaded.planes[plane] for plane, _ in each]).reshape(count, n)
    moment = np.array([one.mass * one.track_radius for _, one in each])
    share = np.array([one.mass / one.kappa for _, one in each])
    drag = np.array([one.damping_rate for _, one in each])
    lever = np.array([1.0 / (one.kappa * one.track_radius) for _, one in each])
    follow = np.array([1.0 - one.spin_share for _, one in each])
    middle = 0.5 * (begin + stop)
    w1, w0, a0 = profile.acceleration(middle), profile.speed(begin), profile.angle(begin)
    size = 2 * n

    @numba.njit
    def rhs(t, y):
        since = t - begin
        w, turned = w0 + w1 * since, a0 + (w0 + 0.5 * w1 * since) * since
        c, s = math.cos(turned), math.sin(turned)
        of_cos, of_sin = w * w * c + w1 * s, w * w * s - w1 * c
        a, b, made = mass.copy(), np.empty(size), np.empty(y.size)
        waves = np.empty((count, 3))
        for i in range(size):
            force = 0.0
            for j in range(size):
                force -= (pull[i, j] + w * pull_by_speed[i, j]) * y[j]
                force -= (damp[i, j] + w * damp_by_speed[i, j]) * y[size + j]
            b[i] = force
        for i in range(n):
            b[i] += ur[i] * of_cos - ui[i] * of_sin
            b[n + i] += ur[i] * of_sin + ui[i] * of_cos
        for k in range(count):
            c, s = math.cos(y[2 * size + k]), math.sin(y[2 * size + k])
            rate = y[2 * size + count + k]
            slip = drag[k] * (rate - w) - follow[k] * w1
            waves[k, 0], waves[k, 1], waves[k, 2] = s, c, slip
            for i in range(n):
                b[i] += rows[k, i] * moment[k] * (rate * rate * c - slip * s)
                b[n + i] += rows[k, i] * moment[k] * (rate * rate * s + slip * c)
                for j in range(n):
                    part = share[k] * rows[k, i] * rows[k, j]
                    a[i, j] -= part * s * s
                    a[n + i, n + j] -= part * c * c
                    a[i, n + j] += part * s * c
                    a[n + i, j] += part * s * c
        for k in range(size):  # without exchange of rows: a mass matrix
            for i in range(k + 1, size):
                part = a[i, k] / a[k, k]
                b[i] -= part * b[k]
                for j in range(k + 1, size):
                    a[i, j] -= part * a[k, j]
        for i in range(size - 1, -1, -1):
            for j in range(i + 1, size):
                b[i] -= a[i, j] * b[j]
            b[i] /= a[i, i]
        for i in range(size):
            made[i], made[size + i] = y[size + i], b[i]
        for k in range(count):
            s, c, slip = waves[k]
            felt = 0.0
            for i in range(n):
                felt += rows[k, i] * (b[i] * s - b[n + i] * c)
            made[2 * size + k] = y[2 * size + count + k]
            made[2 * size + count + k] = lever[k] * felt - slip
        return made

    return rhs


def case_of(name: str) -> Scene:
    """A scene that keeps a tolerance in steps of its own."""
    scene, changes = CASES[name]
    own = {"coupling.scheme": "auto", "coupling.steps_per_rev": None, "coupling.corrections": None}
    return load_scene(scene).replace({**own, "coupling.tolerance": 1e-3, **changes})


class Compiled:
    """A machine's equations as `integrate` asks for them."""

    dry = False

    def __init__(self, scene: Scene) -> None:
        self.system = Monolith(scene.assembly(), scene.profile())
        self.start = scene.run.initial.motion()
        self.stops, self.scales = self.system.stops, self.system.scales
        self.initial = self.system.initial
        self._made = lru_cache(lambda begin, stop: compiled(self.system, begin, stop))

    def between(self, begin: float, stop: float) -> SimpleNamespace:
        return SimpleNamespace(rhs=self._made(begin, stop))

    def motion(self, times: np.ndarray, method: str, rtol: float) -> np.ndarray:
        """Displacements and angles in the rotor (T, 2 n + N)."""
        _, states, _ = integrate(self, times, self.start, method=method, rtol=rtol)
        return self.shown(times, states)

    def shown(self, times: np.ndarray, states: np.ndarray) -> np.ndarray:
        n, count = self.system.stations, self.system.weights
        turned = np.array([self.system.profile.angle(t) for t in times])
        angles = states[:, 4 * n : 4 * n + count] - turned[:, None]
        return np.hstack([states[:, : 2 * n], angles])


def error(found: np.ndarray, right: np.ndarray, lateral: int) -> float:
    off = np.abs(found - right).max(axis=0)
    return float(max(off[:lateral].max() / np.abs(right[:, :lateral]).max(), *off[lateral:]))


def timed(runs: BatchRuns, end: float, count: int) -> float:
    """Least processor time of so many runs, one after the other [s]; infinite where one fails."""
    spent = []
    for _ in range(ROUNDS):
        begun = time.process_time()
        _, why = runs(np.empty((count, 0)), np.full(count, end))
        spent.append(time.process_time() - begun)
        if why[0]:
            return math.inf
    return min(spent)


def by_one_file(scene: Scene, machine: Compiled, at_ends: bool) -> list[tuple[float, float, float]]:
    """Error, processor time of a run and what sets up the unit [s], of runs with many tolerances.

    A call instantiates the unit once, for all its runs.
    """
    lateral, made = 2 * machine.system.stations, []
    signals = motion_signals(scene)
    names = [n for end in (".x", ".y", "angle") for n in signals if n.endswith(end)]
    end, points = end_time(scene), round(PER_REVOLUTION * scene.revolutions)
    right = machine.motion(np.linspace(0.0, end, points + 1), "DOP853", FINEST)
    for exponent in range(2, 19):
        own = composition(scene.replace({"coupling.tolerance": 10.0 ** (-exponent / 2)}))
        most = MOST_ROWS * points if at_ends else points
        runs = BatchRuns(own, [], names, most, at_ends, side_by_side=1)
        found, why = runs(np.empty((1, 0)), np.array([end]))
        if why[0]:
            continue
        one, exact = found[0], right
        if at_ends:
            one = one[~np.isnan(one[:, 0])]
            # no row without a step
            runs = BatchRuns(own, [], names, len(one), at_ends, side_by_side=1)
            one, exact = one[:, 1:], machine.motion(one[:, 0], "DOP853", FINEST)
        single, many = timed(runs, end, 1), timed(runs, end, 1 + AT_ONCE)
        each = (many - single) / AT_ONCE
        made.append((error(one, exact, lateral), each, single - each))
    return made


def by_odeint(scene: Scene, machine: Compiled) -> list[tuple[float, float]]:
    """The same of `odeint`, without what makes signals of its states."""
    lateral, made = 2 * machine.system.stations, []
    times = np.linspace(0.0, end_time(scene), round(PER_REVOLUTION * scene.revolutions) + 1)
    right = machine.motion(times, "DOP853", FINEST)
    for exponent in range(3, 13):
        spent = []
        for _ in range(ROUNDS):
            begun = time.process_time()
            _, states, _ = integrate(
                machine, times, machine.start, method="odeint", rtol=10.0**-exponent
            )
            spent.append(time.process_time() - begun)
        made.append((error(machine.shown(times, states), right, lateral), min(spent)))
    return made


def least(runs: Sequence[tuple[float, ...]]) -> np.ndarray:
    """Least time for each error [ms]."""
    return 1e3 * np.array(
        [min([run[1] for run in runs if run[0] <= e], default=math.nan) for e in ERRORS]
    )


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    at_ends = "ends" in sys.argv
    for name in [given for given in sys.argv[1:] if given != "ends"] or CASES:
        scene = case_of(name)
        machine = Compiled(scene)
        runs, odeint = by_one_file(scene, machine, at_ends), least(by_odeint(scene, machine))
        own = least(runs)
        columns = (" ".join(f"{x:8.3f}" for x in row) for row in (own, odeint))
        print(f"{name:24}", *columns, " ratio", " ".join(f"{x:6.1f}" for x in odeint / own), end="")
        print(f"  set-up {1e3 * np.median([run[2] for run in runs]):.3f} ms", flush=True)
