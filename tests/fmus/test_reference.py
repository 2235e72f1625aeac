"""Every unit over a fixed run with given inputs: the CSV files beside the units' equations.

    python tests/fmus/test_reference.py        writes them anew

They are not the units' own output.  The equations are written down here once more, in other
coordinates where there is a choice, and integrated by DOP853 from one communication point to the
next under the cubics that the inputs describe; the liquid is in closed form.  Start values are the
units' defaults.  As in FMI's cross-check: `_in.csv` the inputs set before each step, `_ref.csv` the
outputs read after it, `_ref.opt` time, tolerance (of each output's range) and build options.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from autobalancer.fmus.catalogue import CATALOGUE, sized_unit

FMUS = Path(__file__).resolve().parents[2] / "fmus"
STEP, COUNT = 5e-4, 60
SPEED, RAMP = 300.0, 400.0  # rad/s; rad/s2 in the second half
CONSTANT = {"der(acceleration)": 0.0, "der(acceleration,2)": 0.0, "der(acceleration,3)": 0.0}
DIFFERENCE = 5e-6  # s: error and rounding of a slope are then below 1e-12 of its range


def drive(k: int, ramp: float = RAMP) -> tuple[float, float, float]:
    """Angle, speed and acceleration of the rotor at communication point k."""
    half = COUNT // 2 * STEP
    t, late = k * STEP, max(0.0, (k - COUNT // 2) * STEP)
    speed = SPEED + ramp * late
    angle = SPEED * min(t, half) + late * (SPEED + 0.5 * ramp * late)
    return angle, speed, ramp if k >= COUNT // 2 else 0.0


def signal(size: float, seed: int, t: float) -> list[complex]:
    """A vector signal with two frequencies: value and derivatives 1 to 3 at time t."""
    waves = [(size * (1.0 + 0.3j * seed), 90.0 + 20.0 * seed), (0.4 * size, -170.0 + 10.0 * seed)]
    return [sum(a * (1j * w) ** order * np.exp(1j * w * t) for a, w in waves) for order in range(4)]


def cubic(orders: list[complex], t: float) -> tuple[complex, complex]:
    """Value and slope, t after the start of the step."""
    s0, s1, s2, s3 = orders
    return s0 + t * (s1 + t * (s2 / 2 + t * s3 / 6)), s1 + t * (s2 + t * s3 / 2)


def moved(rate, span, state, k):
    """The state at the end of a span within a step."""
    options = {"rtol": 1e-13, "atol": 1e-18, "max_step": STEP / 40}
    return solve_ivp(rate, span, state, "DOP853", args=(k,), **options).y[:, -1]


def slope_of(value, rate, t, state, k):
    """Derivative of `value(t, state, k)` along the motion, by a difference of order 6."""
    total = 0.0
    for n, weight in ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60)):
        for d in (n * DIFFERENCE, -n * DIFFERENCE):
            end = moved(rate, (t, t + d), state, k)
            total = total + weight * n / d * value(t + d, end, k)
    return total


def run(inputs, rate, outputs, state):
    """Inputs and outputs of every communication point."""
    given, answers = [], [outputs(0, 0.0, state)]
    for k in range(COUNT):
        given.append(inputs(k))
        state = moved(rate, (0.0, STEP), state, k)
        answers.append(outputs(k, STEP, state))
    return given, answers


def names(pattern: str) -> Iterator[str]:
    """Inputs of one vector signal, value and derivatives."""
    for order in ("{}", "der({})", "der({},2)", "der({},3)"):
        for axis in ("xi", "eta"):
            yield order.format(pattern.format(axis))


def parts(values: list[complex]) -> list[float]:
    return [part for z in values for part in (float(np.real(z)), float(np.imag(z)))]


# -- rotors: q'' from q, q', speed, acceleration, forces in fixed axes ----------------------------


def planar(q, v, w, a, unbalance, forces, added):
    """Dubovik 2006 (5): one disc."""
    total = forces[0] + 2e-4 * unbalance - 8e4 * q[0] - 40.0 * v[0]
    return [total / (2.0 + added[0])]


def two_support(q, v, w, a, unbalance, forces, added):
    """Polushkin 2016 (8), (9): Newton and Euler about the centre of mass, supports at -+0.4 m."""
    at, planes = np.array([-0.4, 0.4]), 0.8 * np.array([1, 2]) / 3.0 - 0.4
    pulls = -2e5 * np.array(q) - 150.0 * np.array(v)
    pushes = np.array(forces)
    tilt = (v[1] - v[0]) / 0.8
    force = pulls.sum() + pushes.sum() + 2e-4 * unbalance
    # polar_inertia 0.1: whirling with the rotation stiffens
    moment = at @ pulls + planes @ pushes + planes[0] * 2e-4 * unbalance + 1j * w * 0.1 * tilt
    mass = np.array([
        [12.0 + sum(added), planes @ added],
        [planes @ added, 0.7 + planes**2 @ added],
    ])  # fmt: skip
    centre, turning = np.linalg.solve(mass, [force, moment])
    return [centre - 0.4 * turning, centre + 0.4 * turning]


def flexible(q, v, w, a, unbalance, forces, added):
    """Filimonikhin 2011 (1): the middle disc of three on a beam of 48 E I/l^3, l = 0.2 m."""
    pull = 48.0 * 1.6e3 / 0.2**3 * (q[1] - (q[0] + q[2]) / 2.0)
    ends = [-2e5 * q[k] - 150.0 * v[k] + pull / 2.0 for k in (0, 2)]
    return [
        ends[0],
        (-pull + forces[0] + 2e-4 * unbalance) / (1.0 + added[0]),
        (ends[1] + forces[1]) / (1.0 + added[1]),
    ]


ROTORS: dict[str, tuple[Callable, list[list[float]]]] = {
    # rows: how the planes move with the stations
    "planar": (planar, [[1.0]]),
    "two_support": (two_support, [[2 / 3, 1 / 3], [1 / 3, 2 / 3]]),
    "flexible": (flexible, [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
}
# spring, damper and station of every support
SUPPORTS: dict[str, list[tuple[float, float, int]]] = {
    "planar": [(8e4, 40.0, 0)],
    "two_support": [(2e5, 150.0, 0), (2e5, 150.0, 1)],
    "flexible": [(2e5, 150.0, 0), (2e5, 150.0, 2)],
}


def rotor(kind: str) -> tuple[list[dict], list[dict]]:
    """Inputs and outputs of every communication point."""
    equations, rows = ROTORS[kind]
    rows, n, p = np.array(rows), len(rows[0]), len(rows)
    # stiff at the stations between: a step of 0.5 ms at changing speed has errors to see there
    turning = partial(drive, ramp=0.0) if kind == "flexible" else drive
    added = np.array([0.2, 0.1][:p])

    def rate(t, state, k):
        angle, speed, ramp = turning(k)
        w, turn = speed + ramp * t, np.exp(1j * (angle + speed * t + ramp * t * t / 2))
        forces = [cubic(signal(3.0, i, k * STEP), t)[0] * turn for i in range(p)]
        unbalance = (w * w - 1j * ramp) * turn
        q, v = state[:n], state[n:]
        return np.concatenate([v, equations(q, v, w, ramp, unbalance, forces, added)])

    def outputs(k, t, state):
        angle, speed, ramp = turning(k)
        angle += speed * t + ramp * t * t / 2
        turn, w = np.exp(-1j * angle), speed + ramp * t
        slope = rate(t, state, k)
        a = rows @ slope[n:] * turn
        jerk = slope_of(lambda *now: rows @ rate(*now)[n:], rate, t, state, k)
        jerk = jerk * turn - 1j * w * a
        found = {}
        for i in range(p):
            for order, z in (("{}", a[i]), ("der({})", jerk[i])):
                for axis, value in (("xi", z.real), ("eta", z.imag)):
                    found[order.format(f"plane[{i + 1}].a_{axis}")] = value
        found["angle"] = angle
        for j in range(n):
            prefix = f"station[{j + 1}]." if n > 1 else ""
            for what, z in (("", state[j]), ("v", state[n + j])):
                found[f"{prefix}{what}x"], found[f"{prefix}{what}y"] = z.real, z.imag
        for i, z in enumerate(rows @ state[:n], 1):
            found[f"plane[{i}].x"], found[f"plane[{i}].y"] = z.real, z.imag
        middle = {
            "planar": lambda q: q[0],
            "two_support": lambda q: 0.0,
            "flexible": lambda q: q[1] - (q[0] + q[2]) / 2.0,
        }
        found["bending"] = abs(middle[kind](state[:n]))
        for s, (spring, damper, at) in enumerate(SUPPORTS[kind], 1):
            force = spring * state[at] + damper * state[n + at]
            found[f"support[{s}].force_x"], found[f"support[{s}].force_y"] = force.real, force.imag
        # the unbalance is a mass on the first plane that drags behind
        found["torque"], found["der(torque)"] = -2e-4 * a[0].imag, -2e-4 * jerk[0].imag
        return found

    def inputs(k):
        found = {f"plane[{i + 1}].added_mass": added[i] for i in range(p)}
        _, found["speed"], found["acceleration"] = turning(k)
        found.update(CONSTANT)
        for i in range(p):
            values = parts(signal(3.0, i, k * STEP))
            found.update(zip(names(f"plane[{i + 1}].F_{{}}"), values, strict=True))
        return found

    return run(inputs, rate, outputs, np.zeros(2 * n, complex))


# -- balancers ------------------------------------------------------------------------------------


def liquid() -> tuple[list[dict], list[dict]]:
    """Dubovik 2006 (4), (5): added mass and liquid mass in closed form."""
    given, answers = [], []
    added = 1000.0 * math.pi * 0.05**2 * 0.02
    mass = 1000.0 * math.pi * (0.05**2 - 0.04**2) * 0.02
    for k in range(COUNT):
        place = 4e-3 * np.exp(0.2j * k)
        inputs = dict(zip(names("a_{}"), parts(signal(5.0, 0, k * STEP)), strict=True))
        given.append({**inputs, "x": place.real, "y": place.imag})
        # the inertia leaves by the port: no force
        answers.append({
            "F_xi": 0.0, "F_eta": 0.0, "der(F_xi)": 0.0, "der(F_eta)": 0.0, "added_mass": added,
            "liquid_mass": mass, "clearance": 0.01 - abs(place),
        })  # fmt: skip
    return given, [answers[0], *answers]


def weights() -> tuple[list[dict], list[dict]]:
    """Filimonikhina 2017 (4) with absolute angles, the force as d^2/dt^2 of the moment."""
    m, r, kappa, b = 0.01, 0.05, 1.4, 0.05

    def centre(t, k):
        angle, speed, ramp = drive(k)
        return cubic(signal(5.0, 0, k * STEP), t)[0] * np.exp(
            1j * (angle + speed * t + ramp * t * t / 2)
        )

    def rate(t, state, k):
        _, speed, ramp = drive(k)
        phi, velocity = state[:2], state[2:]
        pull = -b * r * (velocity - speed - ramp * t) - m * (centre(t, k) * np.exp(-1j * phi)).imag
        pull += (kappa - 1.0) * m * r * ramp  # points that roll in a track that spins up
        return np.concatenate([velocity, pull / (kappa * m * r)])

    def force(t, state, k):
        """In the rotor's axes, without N m a, which leaves by the port."""
        angle, speed, ramp = drive(k)
        bend = rate(t, state, k)[2:]
        total = (m * r * (state[2:] ** 2 - 1j * bend) * np.exp(1j * state[:2])).sum()
        return total * np.exp(-1j * (angle + speed * t + ramp * t * t / 2))

    def torque(t, state, k):
        """Of drag, and of what turns points that roll, all of it on the way there."""
        _, speed, ramp = drive(k)
        lag, turn = state[2:] - speed - ramp * t, rate(t, state, k)[2:] - ramp
        return b * r * r * lag.sum() + (kappa - 1.0) * m * r * r * turn.sum()

    def outputs(k, t, state):
        angle, speed, ramp = drive(k)
        angle += speed * t + ramp * t * t / 2
        value, slope = force(t, state, k), slope_of(force, rate, t, state, k)
        torque_slope = slope_of(torque, rate, t, state, k)
        theta = state[:2] - angle
        moment = m * r * np.exp(1j * theta).sum()
        found = {"F_xi": value.real, "F_eta": value.imag}
        found |= {"der(F_xi)": slope.real, "der(F_eta)": slope.imag, "added_mass": 2 * m}
        for i in (0, 1):
            found[f"weight[{i + 1}].angle"] = theta[i]
            found[f"weight[{i + 1}].speed"] = state[2 + i] - speed - ramp * t
        found |= {"moment_xi": moment.real, "moment_eta": moment.imag}
        found |= {"torque": torque(t, state, k), "der(torque)": torque_slope}
        return {**found, "spread": abs(np.exp(2j * theta).sum()) / 2}

    def inputs(k):
        found = dict(zip(names("a_{}"), parts(signal(5.0, 0, k * STEP)), strict=True))
        found["angle"], found["speed"], found["acceleration"] = drive(k)
        return {**found, **CONSTANT}

    return run(inputs, rate, outputs, np.array([0.0, math.pi, SPEED, SPEED]))


def motor() -> tuple[list[dict], list[dict]]:
    """I w' = L(w) + tau with the start values of a motor of two points, 10 N m to 300 rad/s."""

    def pull(t, speed, k):
        orders = [z.real for z in signal(6.0, 0, k * STEP)]
        torque, slope = cubic(orders, t)
        rate = (10.0 - speed / 30.0 + torque) / 0.1
        return rate, (slope - rate / 30.0) / 0.1

    def outputs(k, t, state):
        angle, speed = state
        rate, change = pull(t, speed, k)
        own = 10.0 - speed / 30.0
        return {
            "acceleration": rate, "der(acceleration)": change, "speed": speed, "angle": angle,
            "drive_torque": own, "power": own * speed,
        }  # fmt: skip

    def inputs(k):
        orders = (z.real for z in signal(6.0, 0, k * STEP))
        torques = ("torque", "der(torque)", "der(torque,2)", "der(torque,3)")
        return dict(zip(torques, orders, strict=True))

    def rate(t, state, k):
        return np.array([state[1], pull(t, state[1], k)[0]])

    return run(inputs, rate, outputs, np.zeros(2))


# name -> unit, its folder, build options, computation, and how near the unit comes, in parts of an
# output's range: at constant speed, where a rotor's step is exact (what is left is DOP853's error
# and rounding), and over the whole run, with the errors of Radau IIA and of the weights' steps
CASES = {
    "planar": ("RotorOnSupports", "rotor", {}, lambda: rotor("planar"), 1e-12, 2e-8),
    "two_support": (
        "RotorOnSupports", "rotor", {"kind": "two_support", "stations": 2, "planes": 2},
        lambda: rotor("two_support"), 1e-12, 5e-8,
    ),
    "flexible": (
        "RotorOnSupports", "rotor", {"kind": "flexible", "stations": 3, "planes": 2},
        lambda: rotor("flexible"), 1e-12, 1e-12,
    ),
    "liquid": ("LiquidBalancer", "liquid", {}, liquid, 1e-14, 1e-14),
    "motor": ("Motor", "motor", {}, motor, 1e-12, 1e-12),
    "point_weights": ("BallBalancer", "weights", {"weights": 2}, weights, 2e-10, 5e-9),
}  # fmt: skip


def write(name: str) -> None:
    """Compute the run of a case and write its three files."""
    unit, folder, options, compute, _, tolerance = CASES[name]
    given, answers = compute()
    for suffix, rows in (("in", given), ("ref", answers)):
        with (FMUS / folder / f"{name}_{suffix}.csv").open("w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(["time", *rows[0]])
            for k, row in enumerate(rows):
                writer.writerow([f"{value:.16g}" for value in (k * STEP, *row.values())])
    lines = {"unit": unit, **options, "StartTime": 0.0, "StopTime": COUNT * STEP,
             "StepSize": STEP, "RelTol": tolerance}  # fmt: skip
    text = "".join(f"{key}, {value}\n" for key, value in lines.items())
    (FMUS / folder / f"{name}_ref.opt").write_text(text)


def read(path: Path) -> dict[str, np.ndarray]:
    with path.open(newline="") as file:
        header, *rows = csv.reader(file)
    return dict(zip(header, np.array(rows, float).T, strict=True))


@pytest.mark.parametrize("name", CASES)
def test_unit_follows_its_reference(name, host_of, backend):
    unit, folder, options, _, steady, whole = CASES[name]
    if backend == "python" and CATALOGUE[unit].native:
        pytest.skip("exists as a native unit only")
    given = read(FMUS / folder / f"{name}_in.csv")
    expected = read(FMUS / folder / f"{name}_ref.csv")
    host = host_of(unit, backend, **options)
    outputs = [v.name for v in host.description.modelVariables if v.causality == "output"]
    inputs = [v.name for v in host.description.modelVariables if v.causality == "input"]
    declared = {v.name: v for v in sized_unit(unit, **options).layout.variables}
    left = {name for name, v in declared.items() if v.native and backend == "python"}
    assert set(outputs) == expected.keys() - {"time"} - left
    assert set(inputs) == given.keys() - {"time"}
    assert len(given["time"]) == COUNT
    host.begin({name: given[name][0] for name in inputs})
    found = [host.outputs()]
    for k, host.time in enumerate(given["time"]):
        host.set({each: given[each][k] for each in inputs})
        found.append(host.run(1, STEP))
    host.free()
    for each, column in zip(outputs, np.array(found).T, strict=True):
        size = np.ptp(expected[each]) or np.abs(expected[each]).max()
        error = np.abs(column - expected[each])
        assert error[: COUNT // 2 + 1].max() <= steady * size, each
        assert error.max() <= whole * size, each


@pytest.mark.slow
@pytest.mark.parametrize("name", ["liquid", "motor", "planar"])
def test_reference_files_are_what_the_equations_give(name):
    """Those that compute in no time; the digits lost are those of the file and of SciPy."""
    _, folder, _, compute, _, _ = CASES[name]
    for suffix, rows in zip(("in", "ref"), compute(), strict=True):
        stored = read(FMUS / folder / f"{name}_{suffix}.csv")
        for each in rows[0]:
            column = np.array([row[each] for row in rows])
            assert stored[each] == pytest.approx(column, rel=1e-9, abs=1e-11)


if __name__ == "__main__":
    for case in CASES:
        write(case)
