"""Extreme cases: those that are quick, and that the rows can fail."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from autobalancer.harness import load_scene
from autobalancer.harness.accuracy.stress.case import (
    Outcome,
    deviation,
    monolith,
    refusal,
)
from autobalancer.harness.accuracy.stress.cases_weights import two_pendulums
from autobalancer.harness.accuracy.stress.run import run_case, stress
from autobalancer.harness.errors import SimulationError
from autobalancer.harness.master import facts
from autobalancer.harness.master.cosimulation import CoSimulation
from autobalancer.harness.master.first_steps import divided_doubling, steep_halvings
from autobalancer.harness.master.recorder import recorded
from autobalancer.harness.result.run import cosimulate
from autobalancer.models.monolith import reference
from autobalancer.models.reference.oscillator import forced_motion
from autobalancer.models.steps.weights import advance
from autobalancer.models.weights import Weights

pytestmark = pytest.mark.slow

GROSS = 0.3  # of the motion: no estimate that is right within three times tells anything of it

QUICK = [
    "stiffness 1e2 and 1e14 N/m in one rotor", "damping ratio 1", "damping ratio 10000",
    "speed 1e5 rad/s, rotor alone", "exactly at a natural frequency, undamped",
    "liquid mu = 1 + 9999, gap 1e-05 of the radius, as added mass",
    "liquid mu = 1 + 9999, gap 1e-05 of the radius, as force", "drag 1e-06 m w", "drag 10000 m w",
    "weights of 10 of the rotor's mass", "weights that spin twenty times as fast as the rotor",
    "4 steps per revolution", "shaft a hundred times as soft",
    "rigid rotor with the polar inertia of a disc", "balancer on a rotor of 1e12 kg",
    "dry supports that hold 10 of the pull", "weights that start 1e7 revolutions on",
    "angle after 1e7 revolutions in steps of a thousand",
]  # fmt: skip


@pytest.mark.parametrize("name", QUICK)
def test_extreme_case_is_right_or_clearly_refused(name):
    row = run_case(name)
    assert row.holds, row.outcome


def test_heavy_weights_part_from_their_neighbours_in_the_fifth_revolution():
    # why that stress case ends after four: no tolerance can be kept where errors grow fiftyfold
    case = two_pendulums({"weights.mass": 9.5, "weights.drag": 4.75, "rotor.unbalance": 0.025})
    first = case.balancer[0].angles[0]
    time = 2.0 * np.pi / 3.0 * np.linspace(0.0, 5.0, 51)
    moved = 1e-7
    motions = [
        reference(one.assembly(), one.profile(), time, rtol=1e-12, signals=["rotor.x"])[0]
        for one in (case, case.replace({"weights.angles[1]": first + moved}))
    ]
    parted = np.zeros(51)
    for name in ("rotor.x", "rotor.y", "weights.moment_xi", "weights.moment_eta"):
        here, there = (motion.signal(name) for motion in motions)
        parted = np.maximum(parted, np.abs(here - there) / np.ptp(here) / moved)
    assert parted[:41].max() < 10.0
    assert parted.max() > 30.0


def test_first_step_is_divided_only_where_forces_start_steeply():
    for factor, divided in ((1.0, False), (1e4, True)):
        build = load_scene("two_balls").replace({"weights.drag": factor * 0.0125})
        with CoSimulation(build) as cosim:
            cosim.start()
            assert (steep_halvings(cosim.system, 0.1) > 0) is divided


@pytest.mark.parametrize("parts", [1, 2, 3, 7])
def test_finer_run_divides_every_one_of_the_first_steps(parts):
    halvings = 5
    shares = divided_doubling(halvings, parts)
    assert [sum(each) for each in shares] == [1.0] * parts
    ends = np.cumsum([share for each in shares for share in each]) / parts
    coarse = np.cumsum([0.0, *divided_doubling(halvings, 1)[0]])
    expected = [np.linspace(a, b, parts + 1)[1:] for a, b in pairwise(coarse)]
    np.testing.assert_allclose(ends, np.concatenate(expected), rtol=1e-14)


def test_given_steps_of_separate_units_are_noted_to_have_no_estimate():
    """Twelve are too few for weights that spin; in one piece they are rows alone."""
    scene = load_scene("two_plane_rodrigues")
    speed = scene.profile().end
    changes = {f"{b.label}.speeds": [5.0 * speed, -4.5 * speed] for b in scene.balancer}
    free = dict.fromkeys(f"coupling.{key}" for key in ("scheme", "order", "corrections"))
    given = {"coupling.tolerance": None, "coupling.steps_per_rev": 12, "run.revolutions": 3}
    scene = scene.replace({**changes, **free, **given})
    names = [n for n in recorded(scene) if "angle" not in n]
    errors = []
    for separate in (False, True):
        result = cosimulate(scene, record=names, separate=separate)
        right, _ = monolith(rtol=1e-10)(scene, result, 0.1)
        errors.append(deviation(result, right))
        assert (facts.NOT_ESTIMATED in result.events) == separate
    assert errors[0] < 1e-4
    assert errors[1] > GROSS


def test_turns_behind_a_weight_do_not_loosen_its_step():
    weights = Weights(1, 0.1, 1.0)
    turns = 2.0 * np.pi * 10_000_000
    signal = (3.0 + 1.0j, -2.0 + 0.5j, 0.3j, 0j)
    (near,), (rate,) = advance(weights, [0.25], [0.5], signal, 0.0, 0.2)
    (far,), (far_rate,) = advance(weights, [0.25 + turns], [0.5], signal, 0.0, 0.2)
    assert far - turns == pytest.approx(near, abs=3e-8)  # the angle itself is rounded to 7e-9
    assert far_rate == pytest.approx(rate, abs=3e-8)


def test_closed_form_satisfies_the_equation_at_resonance_and_critical_damping():
    t = np.linspace(0.0, 5.0, 100_001)
    for mass, damping, stiffness, speed in ((1, 0, 9, 3), (1, 6, 9, 3), (2, 1, 9 - 2j, 1)):
        z = forced_motion(mass, damping, stiffness, 1.5, speed, t, 0.2, -0.1)
        v, a = np.gradient(z, t), np.gradient(np.gradient(z, t), t)
        left = mass * a + damping * v + stiffness * z - 1.5 * np.exp(1j * speed * t)
        assert np.max(np.abs(left[5:-5])) < 1e-6
        assert z[0] == pytest.approx(0.2)
        assert v[1] == pytest.approx(-0.1, abs=1e-3)


def test_a_wrong_answer_does_not_hold(monkeypatch):
    from autobalancer.harness.accuracy.stress import case

    right = case.forced_motion
    monkeypatch.setattr(case, "forced_motion", lambda m, *rest: right(1.001 * m, *rest))
    assert not run_case("damping ratio 0.1").holds


def test_nan_never_holds_and_an_unforeseen_error_is_an_outcome(monkeypatch):
    from autobalancer.harness.accuracy.stress import run as module
    from autobalancer.harness.accuracy.stress.case import Case

    def crash() -> Outcome:
        raise ZeroDivisionError("seen")

    cases = {
        "nan": Case("nan", "a number", lambda: Outcome("error nan", True)),
        "crash": Case("crash", "no crash", crash),
    }
    monkeypatch.setattr(module, "all_cases", lambda: cases)
    assert not run_case("nan").holds
    row = run_case("crash")
    assert not row.holds
    assert "ZeroDivisionError: seen" in row.outcome


def test_refusal_needs_all_its_words():
    def fail() -> None:
        raise SimulationError("liquid.F diverges at t = 1 s")

    assert refusal(fail, "t = ", "liquid.F").holds
    assert not refusal(fail, "gain").holds
    assert not refusal(lambda: None, "t = ").holds


def test_cases_run_in_parallel_and_give_the_pinned_rows():
    names = ["damping ratio 1", "speed 1e0 rad/s, rotor alone"]
    seen: list[float] = []
    rows = stress(names, seen.append)
    assert [row.case for row in rows] == names
    assert seen == [0.5, 1.0]
    assert all(row.holds for row in rows)


def test_command_exits_with_one_when_a_case_does_not_hold(invoke, monkeypatch):
    done = invoke("stress", "damping ratio 0.1")
    assert done.exit_code == 0, done.output
    assert invoke("stress", "no such case").exit_code == 2
    from autobalancer.harness.accuracy.stress import case

    monkeypatch.setattr(case, "forced_motion", lambda *_a: np.zeros(2001, complex))
    assert invoke("stress", "damping ratio 0.1").exit_code == 1
