"""Verdicts by what runs show: supports that no formula covers, and rotors without unbalance."""

from __future__ import annotations

import math

import numpy as np
import pytest

from autobalancer.harness import Scene, cosimulate
from autobalancer.harness.master.two_tolerances import TwoTolerances
from autobalancer.harness.result.verdict import Outcome
from autobalancer.harness.result.verdict.lasting import part_sizes, quiet_spells
from autobalancer.harness.result.verdict.verdict import Verdict
from tests.harness.result.verdict.test_verdict import ROTOR, drum, verdict
from tests.studies.verdict_scenes import drawn

FRICTION = {"rotor__friction": [{"support": 1, "limit": 20.0}]}
WEAK = {"rotor__friction": [{"support": 1, "limit": 0.5}]}
RISING = {"operation.run_up": {"from": 60.0, "to": 300.0, "seconds": 20.0},
          "run.revolutions": 100}  # fmt: skip


def vibration_at_the_end(scene: Scene) -> float:
    """Half the way from end to end over the last eighth of a run [m]."""
    run = cosimulate(scene)
    late = run.time > 0.875 * run.time[-1]
    x, y = run["rotor.x"][late], run["rotor.y"][late]
    return float(np.hypot(x - 0.5 * (x.max() + x.min()), y - 0.5 * (y.max() + y.min())).max())


def test_a_run_in_which_the_rotor_alone_has_not_settled_is_judged_by_longer_ones():
    """Rigid friction of 0.5 N in lightly damped supports: the rotor alone needs 100 revolutions."""
    scene = drum(turns=12, rotor__damping=20.0, **WEAK)
    found = verdict(scene)
    longer = scene.replace({"run.revolutions": 2000})
    expected = vibration_at_the_end(longer.without_balancers())
    assert found.alone == pytest.approx(expected, rel=0.02)
    assert found.reason.startswith("not settled yet: set run.revolutions = ")
    followed = verdict(scene.replace({"run.revolutions": found.revolutions}))
    assert followed.balanced
    assert vibration_at_the_end(longer) < 0.05 * expected


def test_the_rotor_alone_is_run_no_more_often_and_no_longer_than_it_needs(monkeypatch):
    """The search for the length after which it is balanced asks at the ends of ever longer runs."""
    from autobalancer.harness.result.verdict import passages

    lengths, run_bare = [], passages.run_bare

    def counted(bare: Scene):
        lengths.append(bare.revolutions)
        return run_bare(bare)

    monkeypatch.setattr("autobalancer.harness.result.verdict.rotor_alone.run_bare", counted)
    found = verdict(drum(turns=12, rotor__damping=20.0, **WEAK))
    assert found.revolutions > 12
    assert len(lengths) <= 6
    assert max(lengths) < 2000


def test_a_motion_that_amplifies_every_error_is_looked_ahead_at_by_two_runs(monkeypatch):
    """Weights left behind on dry friction: however small the errors of steps, runs part.

    Their angles differ by hundreds of revolutions, and both runs show the same.
    """
    lengths, recorded = [], TwoTolerances._recorded

    def counted(runs, share, *others):
        if runs._run.scene.balancer:
            lengths.append(runs._run.scene.revolutions)
        return recorded(runs, share, *others)

    scene = Scene.from_document(drawn("dry friction", 5, 1))
    result = cosimulate(scene)
    monkeypatch.setattr(TwoTolerances, "_recorded", counted)
    monkeypatch.setattr("autobalancer.harness.result.verdict.ahead.MOST_PASSES", 2e4)
    found = result.summary()
    assert found.outcome is Outcome.ANOTHER_MOTION
    assert found.left_behind[0] == pytest.approx(22.85, rel=0.01)
    assert len(lengths) == 2
    assert min(lengths) > 1000.0


def test_a_look_ahead_at_weights_that_collide_is_run_no_more_often_for_its_error(monkeypatch):
    """Runs from neighbouring starts, and with other impacts, tell nothing but the error."""
    changes = {"balls__weight_radius": 0.01, "balls__speeds": [-150.0] * 3}
    result = cosimulate(drum(turns=12, **changes))
    others = []
    for name in ("_compare_with_neighbours", "_compare_with_grains"):
        monkeypatch.setattr(TwoTolerances, name, lambda *_: others.append(1))
    assert "set run.revolutions = " in result.summary().reason
    assert not others


@pytest.mark.parametrize("turns", [0.5, 30.0])
@pytest.mark.parametrize(("unbalance", "offset"), [(0.05, 0.0), (0.02, -5e-3)])
def test_capacity_is_judged_where_rigid_friction_holds_less_than_what_is_missing(
    turns, unbalance, offset
):
    found = verdict(drum(unbalance, turns=turns, balls__track_offset_xi=offset, **FRICTION))
    assert found.outcome is Outcome.OVER_CAPACITY
    assert found.needed > found.capacity


def test_a_run_up_over_the_capacity_on_rigid_friction_says_so_before_it_ends(monkeypatch):
    """It needs no run of the rotor alone."""
    path = "autobalancer.harness.result.verdict.rotor_alone.run_bare"
    monkeypatch.setattr(path, None)
    found = verdict(drum(0.05, **FRICTION).replace(RISING))
    assert found.outcome is Outcome.OVER_CAPACITY
    assert "the speed still rises" in found.reason
    assert found.alone is None


def test_a_track_off_centre_on_rigid_friction_leaves_its_offset():
    """Weights bring the centre of their track to rest; a longer run ends there."""
    scene = drum(turns=600, balls__track_offset_xi=-1e-3, **FRICTION)
    found = verdict(scene)
    assert found.outcome is Outcome.OFF_CENTRE
    assert vibration_at_the_end(scene) == pytest.approx(1e-3, rel=0.1)


def knocking(gap: float) -> Scene:
    """Balls at rest at the start, in a rotor that a stop holds close."""
    return Scene(
        rotor={"kind": "planar", "mass": 8.0, "stiffness": 20e3, "damping": 80.0,
               "unbalance": 0.01,
               "stops": [{"gap": gap, "stiffness": 400e3, "damping": 100.0}]},
        balancer=[{"kind": "balls", "count": 2, "mass": 0.05, "track_radius": 0.2, "drag": 0.03,
                   "angles": [0.3, 2.0], "speeds": [-150.0, -150.0]}],
        operation={"speed": 150.0},
        run={"revolutions": 60},
    )  # fmt: skip


@pytest.mark.parametrize(
    ("gap", "says"),
    [(2e-3, "the weights rest in the rotor"), (3e-3, "another motion, which has lasted for")],
)
def test_weights_that_a_stop_keeps_from_balance_are_not_told_to_wait(gap, says):
    """Without balls, and balanced, the rotor stays off the stop: formulas tell that alone."""
    found = verdict(knocking(gap))
    assert found.alone < gap
    assert found.outcome is Outcome.ANOTHER_MOTION
    assert says in found.reason
    longer = vibration_at_the_end(knocking(gap).replace({"run.revolutions": 2000}))
    assert longer > found.alone


def test_a_run_up_that_is_cut_off_is_told_a_length_at_whose_end_it_is_balanced():
    found = verdict(drum().replace(RISING))
    assert found.outcome is Outcome.SPEED_CHANGES
    assert f"set run.revolutions = {found.revolutions}" in found.reason
    assert verdict(drum().replace({**RISING, "run.revolutions": found.revolutions})).balanced


@pytest.mark.parametrize("share", [1e-6, 1e-9, 1e-12])
def test_weights_that_hold_hardly_more_than_the_unbalance_balance_it(share):
    """The last of their way takes for ever, and hardly changes anything: 0.03 kg m are held."""
    assert verdict(drum(0.03 * (1.0 - share))).balanced
    if share > 1e-10:  # nearer both are the same to a double
        assert verdict(drum(0.03 * (1.0 + share))).outcome is Outcome.OVER_CAPACITY


def unbalance_goes(turns: float, **changes) -> Verdict:
    gone = [{"time": 3.0, "amount": 0.0}]
    return verdict(drum(turns=turns, operation__unbalance_changes=gone, **changes))


def test_weights_that_cancel_each_other_balance_a_rotor_that_has_lost_its_unbalance():
    """What they would cause on one side is 0.03 kg m on the rotor with their mass."""
    found = unbalance_goes(300)
    assert found.balanced
    w, rotor = 150.0, (8.0 + 0.15)
    by_axis = [abs(0.03 * w**2 / complex(k - rotor * w**2, c * w))
               for k, c in ((20e3, 80.0), (30e3, 100.0))]  # fmt: skip
    assert found.on_one_side == pytest.approx(max(by_axis), rel=0.01)
    assert found.vibration < 0.05 * found.on_one_side
    assert "with all balls on one side of a rotor without unbalance" in str(found)
    short = unbalance_goes(75)
    assert short.outcome is Outcome.NOT_SETTLED
    assert unbalance_goes(short.revolutions).balanced


@pytest.mark.parametrize(
    ("changes", "outcome"),
    [({"speed": 40.0}, Outcome.BELOW_CRITICAL), ({"balls__count": 1}, Outcome.TOO_HEAVY)],
)
def test_weights_that_cannot_cancel_each_other_shake_a_rotor_without_unbalance(changes, outcome):
    spread = {"balls__angles": [math.tau * k / 3 for k in range(3)]}  # an exact balance, unstable
    found = verdict(drum(0.0, turns=60, **{**({} if "balls__count" in changes else spread),
                                           **changes}))  # fmt: skip
    assert found.outcome is outcome


def test_a_rotor_without_unbalance_and_weights_is_not_judged():
    scene = drum(0.0, turns=2).without_balancers()
    assert verdict(scene).balanced is None
    liquid = {"kind": "liquid", "chamber_radius": 0.1, "float_radius": 0.05, "height": 0.05,
              "density": 1000.0}  # fmt: skip
    found = verdict(Scene(rotor=ROTOR, balancer=[liquid], speed=150.0, run={"revolutions": 2}))
    assert found.balanced is None
    assert "not judged: the rotor has no unbalance" in str(found)


def test_distances_in_parts_of_a_run_are_from_its_mean_however_it_is_recorded():
    """A circle of 1 about 3, with many points on one side, and none in one part."""
    angle = np.sort(np.concatenate([np.linspace(0, 200, 4000), 200 * np.random.default_rng(1).beta(
        1.0, 1.0, 2000)]))  # fmt: skip
    crowded = np.concatenate([angle, np.arange(0.0, 200.0, math.tau) + 0.01 * np.ones(32)])
    time = np.sort(crowded)
    assert part_sizes(time, 3.0 + np.exp(1j * time)[None]) == pytest.approx([1.0] * 8, rel=0.02)


def test_a_motion_that_is_quiet_now_and_then_on_rigid_friction_is_named_so():
    """Balls that swing in the rotor balance it for a moment, again and again."""
    scene = Scene(
        rotor={"kind": "planar", "mass": 0.7268, "stiffness": 1912.0, "damping": 7.933,
               "unbalance": 0.001051, "unbalance_angle": 1.973,
               "friction": [{"support": 1, "limit": 1.173}]},
        balancer=[{"kind": "balls", "count": 2, "mass": 0.005524, "track_radius": 0.1924,
                   "drag": 0.005972, "angles": [2.054, 2.725], "speeds": [-167.2, -167.2]}],
        operation={"speed": 167.2},
        run={"revolutions": 1500},
    )  # fmt: skip
    run = cosimulate(scene)
    found = run.summary()
    late = run.time > 0.5 * run.time[-1]
    x, y = run["rotor.x"][late], run["rotor.y"][late]
    turn = (run.time[late] * 167.2 // math.tau).astype(int)
    largest = np.zeros(turn.max() + 1)
    np.maximum.at(largest, turn, np.hypot(x - x.mean(), y - y.mean()))
    quiet = largest[turn.min() :] < 0.05 * found.alone
    falls = int((np.diff(quiet.astype(int)) == 1).sum())  # whole turns of the rotor that are quiet
    assert falls > 10
    assert found.outcome is Outcome.ANOTHER_MOTION
    assert "another motion, which has lasted for 750 revolutions" in found.reason
    counted = int(found.reason.partition("without ")[2].partition(" times")[0])
    assert falls <= counted < 3 * falls
    assert "and rose again" in found.reason


def test_spells_below_a_limit_are_counted_where_the_vibration_rises_again():
    angle = np.arange(400) * math.tau / 4.0  # 100 revolutions
    vibration = np.where(np.arange(400) % 80 < 25, 0.5, 2.0)
    assert quiet_spells(angle, vibration, 1.0) == pytest.approx([6.5, 6.5])
    assert quiet_spells(angle, np.full(400, 0.5), 1.0) == []
