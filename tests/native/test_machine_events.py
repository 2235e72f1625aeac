"""Events of the whole machine in one piece: conservation laws, closed forms, and their location."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import nnls

from autobalancer.fmus.composite.run import Run
from autobalancer.harness import Scene
from autobalancer.harness.master.one_file import composition
from autobalancer.harness.master.one_file_run import OneFileRun
from autobalancer.harness.master.recorder import Recorder
from autobalancer.models.constants import FIRST_DERIVATIVE

EXACT = 1e-6  # share of the tolerance that a step may err: rounding remains
MASS, RADIUS, WEIGHT_RADIUS, KAPPA = 0.3, 0.2, 0.03, 1.4  # of the balls and their track
ROTOR, INERTIA, UNBALANCE = 3.0, 0.05, 0.02  # mass [kg], of the shaft [kg m^2], [kg m]
STIFFNESS = 900.0  # N/m, both axes: the supports leave the angular momentum


def fall(core, coefficients, until):
    """Time at which a polynomial falls below 0; None where it does not."""
    c = np.array(coefficients, float)
    found = core("find_polynomial_fall", c, len(c) - 1, float(until))
    return None if found < 0.0 else found


def from_roots(roots):
    """Positive at 0."""
    c = np.polynomial.polynomial.polyfromroots(roots)
    return c * np.sign(c[0])


@pytest.mark.parametrize("order", [2, 5, 12, 24])
def test_the_first_root_of_a_polynomial_is_found(core, order):
    rng = np.random.default_rng(order)
    for _ in range(60):
        angles, sizes = rng.uniform(0.3, 3.0, order // 2), rng.uniform(0.5, 3.0, order // 2)
        pairs = sizes * np.exp(1j * angles)
        real = rng.uniform(0.05, 0.95, order % 2 + 1)
        roots = np.concatenate([pairs, pairs.conj(), real])
        found = fall(core, from_roots(roots).real, 1.0)
        assert found == pytest.approx(real.min(), abs=1e-11)


@pytest.mark.parametrize("depth", [1e-4, 1e-8, 1e-12])
def test_a_polynomial_that_falls_twice_is_not_missed(core, depth):
    """And one that turns back as far above 0 is left alone."""
    dip = np.array([0.3**2, -0.6, 1.0])  # (t - 0.3)^2
    tail = [1.0, 0.7, -0.2, 0.4]
    for sign in (-1.0, 1.0):
        c = np.polynomial.polynomial.polymul(dip + depth * np.array([sign, 0.0, 0.0]), tail)
        found = fall(core, c, 1.0)
        if sign > 0.0:
            assert found is None
        else:
            assert found == pytest.approx(0.3 - math.sqrt(depth), abs=1e-5 * math.sqrt(depth))


def test_a_polynomial_that_leaves_zero_upwards_falls_later(core):
    assert fall(core, [0.0, 1.0, -2.0], 1.0) == pytest.approx(0.5, abs=1e-15)
    assert fall(core, [0.0, 0.0, 1.0, -4.0], 1.0) == pytest.approx(0.25, abs=1e-14)
    assert fall(core, [0.0, 0.0, 1.0], 1.0) is None
    assert fall(core, [0.0, -1.0, 5.0], 1.0) == 0.0


def machine(changes):
    """Three balls on a rotor whose shaft turns freely; 'no_torque' is all that its motor has."""
    document = {
        "title": "free",
        "rotor": {"kind": "planar", "mass": ROTOR, "stiffness": STIFFNESS, "damping": 0.0,
                  "unbalance": UNBALANCE},
        "balancer": [{"kind": "balls", "name": "balls", "count": 3, "mass": MASS, "drag": 0.0,
                      "track_radius": RADIUS, "weight_radius": WEIGHT_RADIUS, "restitution": 1.0,
                      "angles": [0.3, 1.0, 4.0], "speeds": [5.0, -5.0, 9.0]}],
        "operation": {"motor": {"inertia": INERTIA, "stall_torque": 1e-12, "no_load_speed": 100.0,
                                "from": 30.0}},
        "coupling": {"tolerance": 1e-6},
        "run": {"revolutions": 40},
    }  # fmt: skip
    return Scene.from_document(document).replace(changes)


def recorded(scene):
    """Times and all signals of motion of an exact run in one piece."""
    names = ["rotor.x", "rotor.y", "rotor.vx", "rotor.vy", "rotor.angle"]
    names += ["motor.speed"] if scene.operation.motor else []
    for balancer in scene.balancer:
        for k in range(1, balancer.count + 1):
            names += [f"{balancer.label}.weight[{k}].{v}" for v in ("angle", "speed")]
    with OneFileRun(scene) as run:
        recorder = Recorder(run.units, names)
        run.start(EXACT)
        run.record(recorder, None)
        return recorder.columns()


def balls_of(signals):
    """Of each ball its angle from outside and the rate of that."""
    for k in (1, 2, 3):
        angle, rate = (signals[f"balls.weight[{k}].{v}"] for v in ("angle", "speed"))
        yield angle + signals["rotor.angle"], rate + signals["motor.speed"]


def momentum_and_energy(signals, offset=0.0):
    """Angular momentum about the axis at rest, and energy, of rotor, balls, spin and supports."""
    w, turn = signals["motor.speed"], np.exp(1j * signals["rotor.angle"])
    q = signals["rotor.x"] + 1j * signals["rotor.y"]
    v = signals["rotor.vx"] + 1j * signals["rotor.vy"]
    heavy, moving = UNBALANCE * turn, UNBALANCE * 1j * w * turn
    momentum = (q.conj() * (ROTOR * v + moving) + heavy.conj() * v).imag + INERTIA * w
    energy = 0.5 * (ROTOR * abs(v) ** 2 + INERTIA * w**2 + STIFFNESS * abs(q) ** 2)
    energy = energy + (v.conj() * moving).real
    for phi, rate in balls_of(signals):
        place = q + offset * turn + RADIUS * np.exp(1j * phi)
        velocity = v + 1j * w * offset * turn + 1j * rate * RADIUS * np.exp(1j * phi)
        rolled = RADIUS * rate - (RADIUS + WEIGHT_RADIUS) * w  # without slip on the race
        momentum = momentum + MASS * (place.conj() * velocity).imag
        momentum = momentum - (KAPPA - 1.0) * MASS * rolled * WEIGHT_RADIUS
        energy = energy + 0.5 * MASS * (abs(velocity) ** 2 + (KAPPA - 1.0) * rolled**2)
    return momentum, energy


def impacts_of(signals):
    """How often two balls come so near that they must have met."""
    angles = [signals[f"balls.weight[{k}].angle"] for k in (1, 2, 3)]
    touching = 2.0 * math.asin(WEIGHT_RADIUS / RADIUS)
    gaps = [(angles[(k + 1) % 3] - angles[k]) % (2.0 * math.pi) - touching for k in range(3)]
    assert min(gap.min() for gap in gaps) > -1e-12
    turns = [np.diff(np.sign(np.diff(gap))) for gap in gaps]
    return sum(
        int(((turn > 0.0) & (gap[1:-1] < 0.05)).sum())
        for turn, gap in zip(turns, gaps, strict=True)
    )


def test_impacts_of_a_free_machine_keep_angular_momentum_and_energy():
    """With the shaft's speed, which jumps at every impact."""
    _, signals = recorded(machine({}))
    momentum, energy = momentum_and_energy(signals)
    assert impacts_of(signals) >= 3
    assert np.abs(momentum / momentum[0] - 1.0).max() < 1e-11
    assert np.abs(energy / energy[0] - 1.0).max() < 1e-11


@pytest.mark.parametrize(
    "changes",
    [
        {"balls.restitution": 0.0},
        {"balls.rolling_resistance": 0.02},
        {"balls.rolling_resistance": 0.3, "balls.restitution": 0.0},
        {"balls.rolling_resistance": 0.02, "balls.drag": 0.5, "balls.restitution": 0.3},
        {"balls.rolling_resistance": 0.02, "balls.track_offset_xi": 0.01},
    ],
)
def test_whatever_happens_inside_a_free_machine_keeps_its_angular_momentum(changes):
    """Contacts, resistance, sticking: each acts on the shaft as on the weights; energy is lost."""
    _, signals = recorded(machine(changes))
    momentum, energy = momentum_and_energy(signals, changes.get("balls.track_offset_xi", 0.0))
    assert np.abs(momentum / momentum[0] - 1.0).max() < 1e-11
    if "balls.track_offset_xi" not in changes:  # it would take part in the shaft's inertia
        assert np.diff(energy).max() < 1e-11 * energy[0]
        assert energy[-1] < energy[0] * (1.0 - 1e-6)


def row(restitution, speeds, gaps):
    """Three balls in a row on a rotor so heavy that nothing moves it."""
    touching = 2.0 * math.asin(WEIGHT_RADIUS / RADIUS)
    angles = [1.0, 1.0 + touching + gaps[0], 1.0 + 2.0 * touching + gaps[0] + gaps[1]]
    return Scene.from_document(
        {
            "title": "row",
            "rotor": {"kind": "planar", "mass": 1e9, "stiffness": 1e9, "damping": 0.0,
                      "unbalance": 0.0},
            "balancer": [{"kind": "balls", "name": "balls", "count": 3, "mass": 0.1, "drag": 0.0,
                          "track_radius": RADIUS, "weight_radius": WEIGHT_RADIUS,
                          "restitution": restitution, "angles": angles, "speeds": speeds}],
            "operation": {"speed": 1.0},
            "coupling": {"tolerance": 1e-6},
            "run": {"revolutions": 0.05},
        }
    )  # fmt: skip


@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
def test_three_balls_that_meet_at_once_are_one_impact(restitution):
    """The outer ones come from both sides: each pair opens at e times its speed of closing."""
    _, signals = recorded(row(restitution, [2.0, 0.0, -2.0], [0.1, 0.1]))
    ends = [signals[f"balls.weight[{k}].speed"][-1] for k in (1, 2, 3)]
    assert ends == pytest.approx([-2.0 * restitution, 0.0, 2.0 * restitution], abs=1e-7)


def test_a_ball_hits_two_that_touch_as_a_complementarity_problem():
    """Moreau's law: both pairs at once; the front ball alone does not take the whole push."""
    _, signals = recorded(row(0.0, [3.0, 0.0, 0.0], [0.1, 0.0]))
    ends = [signals[f"balls.weight[{k}].speed"][-1] for k in (1, 2, 3)]
    assert ends == pytest.approx([1.0, 1.0, 1.0], abs=1e-7)  # together, with their momentum


def test_a_ball_that_grazes_another_is_told_from_one_that_hits_it():
    """Both are slowed by drag; the one behind would stop just before, or just beyond the other."""
    drag, mass, speed = 0.28, 0.1, 2.0
    reach = speed * KAPPA * mass / drag  # how far a ball goes by drag alone
    for short, hits in ((1e-7, False), (-1e-7, True)):
        scene = row(1.0, [speed, 0.0, 0.0], [reach + short, 1.0]).replace(
            {"balls.drag": drag, "run.revolutions": 4.0}
        )
        _, signals = recorded(scene)
        moved = np.abs(signals["balls.weight[2].angle"] - signals["balls.weight[2].angle"][0]).max()
        assert (moved > 2e-8) == hits


def test_bounces_end_in_a_contact_that_lasts():
    """A rotor that whirls pushes two balls together; they bounce ever lower, and then touch."""
    scene = Scene.from_document(
        {
            "title": "bounces",
            "rotor": {"kind": "planar", "mass": 5.0, "stiffness": 500.0, "damping": 20.0,
                      "unbalance": 0.3},
            "balancer": [{"kind": "balls", "name": "balls", "count": 2, "mass": 0.01, "drag": 0.1,
                          "track_radius": RADIUS, "weight_radius": WEIGHT_RADIUS,
                          "restitution": 0.5, "angles": [1.0, 4.0]}],
            "operation": {"speed": 30.0},
            "coupling": {"tolerance": 1e-6},
            "run": {"revolutions": 60},
        }
    )  # fmt: skip
    _, signals = recorded(scene)
    first, second = (signals[f"balls.weight[{k}].angle"] for k in (1, 2))
    touching = 2.0 * math.asin(WEIGHT_RADIUS / RADIUS)
    gap = (second - first) % (2.0 * math.pi) - touching
    other = (first - second) % (2.0 * math.pi) - touching
    least = np.minimum(gap, other)
    assert least.min() > -1e-11
    assert np.abs(least[len(least) // 2 :]).max() < 1e-11


def touching(angles):
    """A light rotor with five balls in a row, all of which touch at the start."""
    return Scene.from_document(
        {
            "title": "touching",
            "rotor": {"kind": "planar", "mass": 0.4, "stiffness": 100.0, "damping": 0.0,
                      "unbalance": 0.03},
            "balancer": [{"kind": "balls", "name": "balls", "count": 5, "mass": MASS, "drag": 0.0,
                          "track_radius": RADIUS, "weight_radius": WEIGHT_RADIUS,
                          "restitution": 0.0, "angles": list(angles)}],
            "operation": {"speed": 10.0},
            "coupling": {"tolerance": 1e-6},
            "run": {"revolutions": 1},
        }
    )  # fmt: skip


def test_contacts_at_rest_are_a_complementarity_problem_of_the_whole_machine():
    """Which of them open, and with what accelerations: by least squares, Gauss's principle."""
    rng, opened = np.random.default_rng(8), 0
    rows = np.hstack([np.zeros((4, 2)), np.diff(np.eye(5), axis=0)])
    for start in rng.uniform(0.0, 2.0 * math.pi, 40):
        angles = start + 2.0 * math.asin(WEIGHT_RADIUS / RADIUS) * np.arange(5)
        made = composition(touching(angles))
        names = ["der(rotor.vx)", "der(rotor.vy)"]
        names += [f"der(balls.weight[{k}].speed)" for k in range(1, 6)]
        states = [f"der({p.name}.{state})" for p in made.parts for state in p.states]
        run = Run(made)
        run.start()
        found = np.empty(7)
        run.read(np.array([states.index(n) for n in names], np.uintc) + FIRST_DERIVATIVE, found)
        run.close()
        matrix = np.zeros((7, 7))
        matrix[:2, :2] = (0.4 + 5.0 * MASS) * np.eye(2)
        matrix[2:, 2:] = KAPPA * MASS * RADIUS**2 * np.eye(5)
        matrix[0, 2:] = matrix[2:, 0] = -MASS * RADIUS * np.sin(angles)
        matrix[1, 2:] = matrix[2:, 1] = MASS * RADIUS * np.cos(angles)
        pull = 100.0 * (0.03 + MASS * RADIUS * np.exp(1j * angles).sum())
        free = np.linalg.solve(matrix, [pull.real, pull.imag, 0.0, 0.0, 0.0, 0.0, 0.0])
        factor = np.linalg.cholesky(rows @ np.linalg.solve(matrix, rows.T)).T
        forces = nnls(factor, -np.linalg.solve(factor.T, rows @ free))[0]
        expected = free + np.linalg.solve(matrix, rows.T @ forces)
        assert found == pytest.approx(expected, abs=1e-9 * np.abs(expected).max())
        opened += int((forces == 0.0).sum())
    assert opened > 20  # some contacts last, others do not
