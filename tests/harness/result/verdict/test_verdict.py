"""What a run comes to: outcomes on machines of which a longer run or a formula knows them."""

from __future__ import annotations

import json
import math
import re

import pytest

from autobalancer.harness import Scene, cosimulate, load_scene
from autobalancer.harness.result.verdict import Outcome
from autobalancer.harness.result.verdict.sentence import sentences
from autobalancer.harness.result.verdict.verdict import Verdict

BALLS = {"kind": "balls", "count": 3, "mass": 0.05, "track_radius": 0.2, "drag": 0.2}
ROTOR = {"kind": "planar", "mass": 8.0, "stiffness": [20e3, 30e3], "damping": [80.0, 100.0]}


def drum(unbalance: float = 0.02, speed: float = 150.0, turns: float = 150.0, **changes) -> Scene:
    scene = Scene(
        rotor=ROTOR | {"unbalance": unbalance},
        balancer=[BALLS],
        operation={"speed": speed},
        run={"revolutions": turns},
    )
    return scene.replace({path.replace("__", "."): value for path, value in changes.items()})


def verdict(scene: Scene) -> Verdict:
    return cosimulate(scene).summary()


@pytest.mark.parametrize(
    ("scene", "outcome"),
    [
        (drum(0.2, turns=0.05), Outcome.OVER_CAPACITY),
        (drum(speed=40.0, turns=0.05), Outcome.BELOW_CRITICAL),
        (drum(0.06, operation__gravity=1e-6), Outcome.OVER_CAPACITY),
        (drum(turns=20, operation__gravity=1e-6), Outcome.NOT_SETTLED),
    ],
    ids=["capacity", "critical speed", "capacity in weak gravity", "settling in weak gravity"],
)
def test_a_vibration_that_has_not_grown_and_weak_gravity_hide_no_reason(scene, outcome):
    found = verdict(scene)
    assert found.outcome is outcome
    assert found.balanced is False
    assert "gravity" not in found.reason


def test_over_capacity_at_resonance_is_not_balanced_however_large_the_rotor_alone_would_shake():
    """Undamped but for 0.02 N s/m, at its natural frequency: 50 m without balls."""
    scene = Scene(
        rotor={"kind": "planar", "mass": 8.0, "stiffness": 20e3, "damping": 0.02,
               "unbalance": 0.02},
        balancer=[BALLS | {"count": 2, "mass": 0.01, "drag": 0.05, "angles": [0.0, 3.1]}],
        speed=50.0,
        run={"revolutions": 20},
    )  # fmt: skip
    found = verdict(scene)
    assert found.vibration < 0.05 * found.alone
    assert found.outcome is Outcome.OVER_CAPACITY
    assert found.needed == pytest.approx(0.02)
    assert found.capacity == pytest.approx(2 * 0.01 * 0.2)


@pytest.mark.parametrize(("mass", "outcome"), [(0.3, Outcome.TOO_HEAVY), (0.101, Outcome.BALANCED)])
def test_one_ball_that_holds_more_than_the_unbalance_leaves_the_difference(mass, outcome):
    """One ball at rest opposite an unbalance of 0.02 kg m: z = (m R - U) w^2 / (k - M w^2)."""
    speed, rotor = 150.0, {"kind": "planar", "mass": 8.0, "stiffness": 20e3, "damping": 80.0}
    scene = Scene(
        rotor=rotor | {"unbalance": 0.02},
        balancer=[BALLS | {"count": 1, "mass": mass, "angles": [2.0]}],
        speed=speed,
        run={"revolutions": 200},
    )
    found = verdict(scene)
    assert found.outcome is outcome
    pull = complex(20e3 - (8.0 + mass) * speed**2, 80.0 * speed)
    left = abs((mass * 0.2 - 0.02) * speed**2 / pull)
    assert found.vibration == pytest.approx(left, rel=0.02)


def test_a_look_ahead_that_would_show_next_to_nothing_is_not_taken(monkeypatch):
    """An unbalance of 1 mg mm leaves the balls where they are for 5e12 s."""
    alike = {"rotor.stiffness": 20e3, "rotor.damping": 80.0, "balls.count": 2}
    scene = drum(1e-9, turns=50).replace(alike)
    monkeypatch.setattr("autobalancer.harness.result.verdict.ahead.run_again", None)
    found = verdict(scene)
    assert found.outcome is Outcome.NOT_SETTLED
    assert "more than a million revolutions" in found.remedy


def test_advice_suffices_when_it_is_followed():
    for turns in (5.0, 20.0, 40.0):
        found = verdict(drum(turns=turns))
        assert found.outcome is Outcome.NOT_SETTLED
        assert found.reason.endswith(f"set run.revolutions = {found.revolutions}")
        assert verdict(drum(turns=found.revolutions)).balanced


def test_a_change_of_unbalance_starts_the_transient_anew():
    change = [{"time": 5.0, "amount": 0.01, "angle": 2.0}]
    late = drum(turns=125, operation__unbalance_changes=change)
    found = verdict(late)
    assert found.outcome is Outcome.NOT_SETTLED
    assert found.reason.startswith("not settled yet since the change at 5 s")
    assert verdict(late.replace({"run.revolutions": found.revolutions})).balanced


def test_an_undamped_machine_is_neutral():
    found = verdict(drum(turns=20, rotor__damping=0.0, rotor__stiffness=20e3, balls__drag=0.0))
    assert found.outcome is Outcome.NEUTRAL
    assert abs(found.growth) <= found.growth_error < 1e-9
    assert "unstable" not in str(found)


def test_an_unbalance_too_small_to_move_the_weights_of_a_damped_machine_is_undecided():
    found = verdict(
        drum(turns=20, rotor__stiffness=[20e3, 30e3], rotor__unbalance=1e-13, balls__count=2)
    )
    assert found.outcome is Outcome.UNDECIDED
    assert found.balanced is None
    assert abs(found.growth) <= found.growth_error
    assert "stability undecided" in str(found)
    assert "damping" not in str(found)


LIQUID = {
    "kind": "liquid", "chamber_radius": 0.1, "float_radius": 0.05, "height": 0.05,
    "density": 1000.0,
}  # fmt: skip


@pytest.mark.parametrize(("speed", "outcome"), [(22.0, "RAISED"), (24.0, "LOWERED")])
def test_a_liquid_lowers_the_vibration_above_its_speed(speed, outcome):
    """Dubovik 2006 (11): less bending above w_* = sqrt(2c/(m1 + m))."""
    rotor = {"kind": "planar", "mass": 1.0, "stiffness": 1000.0, "damping": 10.0,
             "internal_damping": 1.0, "unbalance": 1e-5}  # fmt: skip
    found = verdict(Scene(rotor=rotor, balancer=[LIQUID], speed=speed, run={"revolutions": 100}))
    assert found.outcome.name == outcome
    above = math.sqrt(2.0 * 1000.0 / (1.0 + 1.0 + 1000.0 * math.pi * 0.1**2 * 0.05))
    assert above == pytest.approx(23.67, abs=0.01)
    if outcome == "RAISED":
        assert f"below w_* = {above:.4g} rad/s" in found.reason


def test_balls_left_behind_have_their_speed_and_the_natural_frequency_and_no_advice_to_wait():
    """Closed form of the locked motion: h (W - w) = k m^2 w^4 g(w) gives 0.9127 rad/s."""
    scene = Scene(
        rotor={"kind": "planar", "mass": 1.0, "stiffness": 1.0, "damping": 0.02,
               "unbalance": 0.01},
        balancer=[{"kind": "balls", "count": 2, "mass": 0.03267, "track_radius": 1.0,
                   "drag": 0.001, "angles": [0.3, 2.1], "speeds": [-3.0, -3.0]}],
        speed=3.0,
        run={"revolutions": 573},
    )  # fmt: skip
    found = verdict(scene)
    assert found.outcome is Outcome.ANOTHER_MOTION
    assert found.left_behind == pytest.approx((0.9127, (1.0 / 1.06534) ** 0.5), rel=2e-3)
    assert not found.used  # what turns in the rotor holds no unbalance there
    assert found.left is None
    assert found.revolutions is None
    assert "left behind" in found.reason
    assert found.other == pytest.approx((0.9127, 0.488), rel=0.05)


def test_weights_left_behind_are_named_beside_an_unstable_balance():
    """Both planes locked in antiphase on the tilting mode: the closed form gives 3.0285 rad/s."""
    ball = {"kind": "balls", "count": 2, "mass": 0.02, "track_radius": 1.0, "drag": 0.02,
            "speeds": [-4.0, -4.0]}  # fmt: skip
    scene = Scene(
        rotor={"kind": "two_support", "mass": 1.0, "inertia": 0.04, "polar_inertia": 0.02,
               "span": 1.0, "stiffness": [0.5, 0.5], "damping": [0.01, 0.01],
               "planes": [0.25, 0.75],
               "unbalances": [{"position": 0.0, "amount": 0.004},
                              {"position": 1.0, "amount": 0.002}]},
        balancer=[ball | {"name": "a", "at": 1, "angles": [0.3, 2.1]},
                  ball | {"name": "b", "at": 2, "angles": [1.0, 4.4]}],
        speed=4.0,
        run={"revolutions": 600},
    )  # fmt: skip
    found = verdict(scene)
    assert found.outcome is Outcome.UNSTABLE
    assert found.left_behind[0] == pytest.approx(3.0285, rel=2e-3)
    assert "left behind, all balls of a and all balls of b turn at 3.0" in found.reason


def test_no_capacity_in_use_is_stated_where_weights_turn_in_an_unstable_machine():
    """Pendulums with a tenth of the drag turn in the rotor, and none is left behind steadily."""
    found = verdict(
        load_scene("two_balls").replace(
            {"operation.speed": 5.5, "weights.drag": 0.001, "run.revolutions": 200}
        )
    )
    assert found.outcome is Outcome.UNSTABLE
    assert found.left_behind is None
    assert found.used == ()
    assert found.left is None
    assert "capacity" not in str(found)


def test_balls_left_behind_that_swing_about_one_speed_are_not_told_to_wait():
    """Supports that are not alike swing the balls between 45 and 53 rad/s; an integration of its
    own has them there after 1,500 s too."""
    found = verdict(
        Scene(
            rotor={"kind": "planar", "mass": 5.0, "stiffness": [8e3, 12.8e3],
                   "damping": [4.0, 5.06], "unbalance": 1e-3, "unbalance_angle": 0.4},
            balancer=[BALLS | {"count": 2, "mass": 1 / 120, "track_radius": 0.1, "drag": 0.002,
                               "angles": [0.3, 1.0], "speeds": [-71.0, -71.0]}],
            speed=120.0,
            run={"revolutions": 300},
        )
    )  # fmt: skip
    assert found.outcome is Outcome.ANOTHER_MOTION
    assert found.left_behind[0] == pytest.approx(49.0, abs=3.0)
    assert found.revolutions is None
    assert "It takes at least" not in str(found)


def passing(torque: float, revolutions: float) -> Scene:
    """Two pendulums on a lightly damped rotor, and a motor that has to pass 30 rad/s."""
    weights = {"kind": "pendulums", "count": 2, "mass": 1 / 6, "track_radius": 0.1, "drag": 1.25}
    return Scene(
        rotor={"kind": "planar", "mass": 10.0, "stiffness": 9e3, "damping": 12.0,
               "unbalance": 0.02, "unbalance_angle": 0.4},
        balancer=[weights | {"angles": [0.3, 3.127]}],
        operation={"motor": {"inertia": 0.2, "stall_torque": torque, "no_load_speed": 100.0}},
        run={"revolutions": revolutions},
    )  # fmt: skip


def test_weights_that_share_one_angle_and_are_left_behind_say_both_and_hold_nothing():
    """An integration of its own has both pendulums turn at 20 to 35 rad/s under a rotor at 50."""
    found = verdict(passing(1.2, 400.0))
    assert found.outcome is Outcome.TOGETHER
    assert "left behind, all pendulums turn at 28.7" in found.reason
    assert found.left_behind == pytest.approx((28.7, math.sqrt(9e3 / (10.0 + 1 / 3))), abs=0.3)
    assert (found.used, found.left) == ((), None)


def test_nothing_is_held_by_weights_that_turn_in_the_rotor_whatever_the_reason():
    """Pendulums without drag turn over in a rotor that stays below its resonance."""
    found = verdict(
        passing(0.8, 400.0).replace(
            {"pendulums.drag": 0.0, "rotor.damping": 6.0, "rotor.unbalance": 0.03,
             "pendulums.mass": 0.25}
        )
    )  # fmt: skip
    assert found.outcome is Outcome.BELOW_CRITICAL
    assert (found.used, found.left) == ((), None)


def test_an_unbalance_just_beyond_the_capacity_is_told_from_it():
    """Three balls hold 0.03 kg m."""
    said = str(verdict(drum(0.030003)))
    assert "30.003 g m to balance, the weights hold at most 30 g m" in said


def test_a_part_of_next_to_nothing_is_not_stated():
    """The load is gone, and what is left of its transient dies out."""
    changes = [{"time": 3.0, "amount": 0.0}]
    scene = drum(turns=150, operation__unbalance_changes=changes)
    assert "below 0.0001 mm at" not in str(verdict(scene))


def test_a_transient_of_unknown_length_has_the_least_that_it_takes():
    slow = verdict(drum(turns=40, balls__drag=1e4))
    assert slow.outcome is Outcome.NOT_SETTLED
    assert slow.revolutions is None
    assert re.search(r"It takes (at least \d+|more than a million) revolutions", str(slow))


def pushed(damping):
    """A push of 1 mm starts a slow precession; balls start balanced."""
    places = [math.pi - math.acos(0.5), math.pi + math.acos(0.5)]
    return Scene(
        rotor={"kind": "planar", "mass": 5.0, "stiffness": 2e3, "damping": damping,
               "unbalance": 0.002},
        balancer=[BALLS | {"count": 2, "mass": 0.02, "track_radius": 0.1, "angles": places}],
        speed=300.0,
        run={"revolutions": 60, "initial": {"x": 1e-3}},
    )  # fmt: skip


def test_vibration_is_compared_at_the_rotors_frequency_and_a_precession_is_stated_apart():
    """Light damping keeps the precession."""
    found = verdict(pushed(0.2))
    assert found.vibration > found.alone
    assert found.synchronous < 0.05 * found.alone
    frequency, size = found.other
    assert frequency == pytest.approx(math.sqrt(2e3 / 5.04), rel=1e-3)
    assert size == pytest.approx(1e-3, rel=0.1)
    assert "a slow precession of" in str(found)


@pytest.mark.parametrize(("damping", "decays"), [(0.2, False), (5.0, True)])
def test_a_vibration_beside_that_decays_is_said_to_decay(damping, decays):
    """The precession decays by c/(2 m), in half a run by 1 % or by 27 %."""
    found = verdict(pushed(damping))
    expected = math.exp(-damping / (2.0 * 5.04) * 30.0 * math.tau / 300.0)
    assert found.other_change == pytest.approx(expected, rel=0.03)
    assert (", which decays." in str(found)) is decays


def profile(*corners: tuple[float, float]) -> Scene:
    return Scene(
        rotor=ROTOR | {"unbalance": 0.02},
        balancer=[BALLS],
        operation={"profile": [*corners]},
    )


def test_a_profile_is_judged_on_its_plateaus_and_a_standstill_is_not():
    found = verdict(profile((0, 0), (3, 150), (9, 150), (12, 0)))
    assert found.balanced
    assert found.speed == 150.0
    assert [(begin, end) for begin, end, _ in found.plateaus] == [(3.0, 9.0)]
    assert 3.0 <= found.after <= 9.0
    up, down = found.passages
    assert (up.start, up.speed, down.start, down.speed) == (0.0, 150.0, 150.0, 0.0)
    assert up.largest > up.alone > 0.0
    said = str(found)
    assert "From 0 to 150 rad/s within 3 s: largest vibration" in said
    assert "without balancers" in said
    assert "stands still" not in said


@pytest.mark.filterwarnings("error")
def test_balls_without_drag_that_turn_in_an_undamped_rotor_are_neutral():
    undamped = {"rotor__damping": 0.0, "balls__drag": 0.0}
    found = verdict(drum(turns=20, balls__speeds=[-100.0] * 3, **undamped))
    assert found.outcome is Outcome.NEUTRAL


@pytest.mark.parametrize(
    ("share", "outcome"), [(0.01, Outcome.BALANCED), (0.1, Outcome.OFF_CENTRE)]
)
def test_a_track_off_centre_leaves_the_vibration_of_its_offset(share, outcome):
    alone = verdict(drum(turns=600)).alone
    found = verdict(drum(turns=600, balls__track_offset_xi=share * alone))
    assert found.outcome is outcome
    if outcome is Outcome.OFF_CENTRE:
        assert f"in balance {100 * share:.0f} % of the vibration is left" in found.reason
        assert found.vibration == pytest.approx(share * alone, rel=0.1)


def test_a_track_far_off_centre_takes_more_than_the_weights_hold():
    """Opposite to the unbalance: far above the critical speed, the mass times the offset more."""
    found = verdict(drum(turns=30, balls__track_offset_xi=-5e-3))
    assert found.outcome is Outcome.OVER_CAPACITY
    assert "to balance with the track off centre by 5 mm, the weights hold" in found.reason
    assert found.needed == pytest.approx(0.02 + 8.0 * 5e-3, rel=0.15)


def test_weights_on_a_track_off_centre_use_their_capacity_and_no_more():
    """The mass on the offset, 0.75 g m, is not what their places hold."""
    scene = drum(0.06, turns=150, balls__track_offset_xi=5e-3)
    run = cosimulate(scene)
    ((_, used, capacity),) = run.summary().used
    angles = [run[f"balls.weight[{k}].angle"][-1] for k in (1, 2, 3)]
    assert capacity == pytest.approx(0.03)
    assert used == pytest.approx(abs(sum(math.e ** (1j * a) for a in angles)) / 3.0, rel=0.02)
    assert used <= 1.0


def test_unbalance_left_under_gravity_is_what_shakes_at_the_frequency_of_the_rotor():
    """Balls that swing once per revolution hold 7 % more or less at a moment, on average 0.2 %."""
    scene = Scene(
        rotor={"kind": "planar", "mass": 25.0, "stiffness": [4e4, 6e4], "damping": [400.0, 450.0],
               "unbalance": 2e-3},
        balancer=[BALLS | {"count": 4, "track_radius": 0.08, "drag": 0.3}],
        operation={"speed": "700 rpm", "gravity": 9.81},
        run={"revolutions": 300},
    )  # fmt: skip
    found = verdict(scene)
    assert found.balanced
    assert found.left[0] / 2e-3 == pytest.approx(found.synchronous / found.alone, rel=0.1)


def test_every_plateau_has_its_verdict():
    found = verdict(profile((0, 40), (5, 40), (8, 150), (14, 150)))
    assert [one.outcome for *_, one in found.plateaus] == [
        Outcome.BELOW_CRITICAL, Outcome.BALANCED,
    ]  # fmt: skip
    assert "From 0 to 5 s at 40 rad/s = 382 rpm: below the critical speed" in str(found)


def test_a_motor_is_judged_at_its_own_speed():
    """The grade is the unbalance left times that speed over the mass."""
    motor = {"inertia": 0.2, "stall_torque": 1.2, "no_load_speed": 300.0}
    scene = Scene(
        rotor=ROTOR | {"unbalance": 0.02},
        balancer=[BALLS],
        operation={"motor": motor},
        run={"revolutions": 600},
    )
    run = cosimulate(scene)
    found, speed = run.summary(), run["motor.speed"][-1]
    assert speed == pytest.approx(57.3, abs=0.1)
    assert found.left[1] == pytest.approx(1e3 * found.left[0] * found.speed / 8.0)
    assert found.speed == pytest.approx(speed, rel=0.02)
    assert "G250" in str(found)
    assert "the speed still rises" in found.reason


def test_a_motor_that_still_speeds_up_is_told_a_length_at_whose_end_it_is_balanced():
    """The motor and then the weights settle in two runs that look ahead."""
    motor = {"inertia": 0.6, "stall_torque": 30.0, "no_load_speed": 150.0}
    scene = Scene(
        rotor=ROTOR | {"unbalance": 0.02},
        balancer=[BALLS],
        operation={"motor": motor},
        run={"revolutions": 30},
    )
    found = verdict(scene)
    assert found.outcome is Outcome.SPEED_CHANGES
    assert f"set run.revolutions = {found.revolutions}" in found.reason
    assert verdict(scene.replace({"run.revolutions": found.revolutions})).balanced


def test_numbers_are_readable():
    assert "vibration below 0.0001 mm (below 0.0001 mm/s rms), below 0.01 %" in said(1e-12, 1e-12)
    assert "100 %" in said(9.99e-4, 0.01)
    assert "e+" not in said(9.99e-4, 0.01)
    slow = verdict(drum(turns=40, balls__drag=1e9))
    assert "e+" not in str(slow)
    assert slow.revolutions is None or slow.revolutions <= 1_000_000


def said(vibration: float, velocity: float) -> str:
    found = Verdict("balls", vibration, velocity, alone=1e-3, after=1.0, outcome=Outcome.BALANCED)
    return " ".join(sentences(found))


def test_the_same_facts_are_data():
    found = verdict(drum())
    data = json.loads(json.dumps(found.as_json()))
    assert data["outcome"] == "balanced"
    assert data["balanced"] is True
    assert data["text"] == str(found)
    kept = {"balancers", "vibration", "velocity", "alone", "after", "reason", "used", "left"}
    assert kept <= data.keys()


def test_every_outcome_says_whether_the_rotor_is_balanced():
    assert [o for o in Outcome if o.balanced] == [Outcome.BALANCED]
    assert Outcome.CANNOT_TELL.balanced is None
    assert Outcome.NOT_SETTLED.balanced is False


def test_a_free_tool_is_judged_at_the_frequency_of_its_rotor_and_its_drift_named_apart():
    """It drifts and precesses, which nothing damps, and its weights balance it all the same."""
    found = verdict(Scene.load("angle_grinder"))
    assert found.balanced is True
    assert found.mean > 1e-3
    assert found.vibration == found.synchronous < 0.05 * found.alone
    assert "drifts and precesses" in str(found)
    assert found.growth < -1.0


def test_a_vibration_of_nothing_has_no_share_and_no_exponent():
    """An unbalance of 1e-12 kg m: some 1e-13 m without balls."""
    found = str(verdict(drum(unbalance=1e-12, turns=40)))
    assert "e-" not in found
    assert "e+" not in found
    assert "without balls below 0.0001 mm" in found


def test_a_run_up_over_the_capacity_says_so_and_states_what_is_held_at_its_end():
    rising = {"operation.run_up": {"from": 60.0, "to": 300.0, "seconds": 20.0},
              "run.revolutions": 100}  # fmt: skip
    over = verdict(drum(unbalance=0.05).replace(rising))
    assert over.outcome is Outcome.OVER_CAPACITY
    assert "the speed still rises" in over.reason
    found = verdict(drum().replace(rising))
    assert found.outcome is Outcome.SPEED_CHANGES
    assert "Balls use at this moment" in str(found)
    assert "Unbalance left at this moment" in str(found)


@pytest.mark.parametrize(("limit", "balanced"), [(0.5, True), (60.0, False), (200.0, True)])
def test_rigid_dry_friction_is_judged_by_runs_with_balls_and_without(limit, balanced):
    """A slider with 0.5 N hardly matters, 200 N hold the rotor at rest before the balls do."""
    scene = drum(turns=300, rotor__friction=[{"support": 1, "limit": limit}])
    found = verdict(scene)
    assert found.balanced is balanced
    longer = cosimulate(scene.replace({"run.revolutions": 1500}))
    late = longer.time > 0.2 * longer.time[-1]
    motion = (longer["rotor.x"] + 1j * longer["rotor.y"])[late]
    assert (abs(motion - motion.mean()).max() < 0.05 * found.alone) == balanced


@pytest.mark.parametrize(
    ("unbalance", "limit", "outcome"),
    [(0.0, 2.0, Outcome.NO_UNBALANCE), (0.02, 2e3, Outcome.NO_RESPONSE)],
)
def test_a_rotor_at_rest_on_dry_friction_is_told_from_one_without_unbalance(
    unbalance, limit, outcome
):
    scene = drum(unbalance, turns=60, rotor__friction=[{"support": 1, "limit": limit}])
    found = verdict(scene)
    assert found.outcome is outcome
    assert ("no unbalance" in found.reason) == (unbalance == 0.0)


def test_a_vibration_that_weights_left_behind_keep_up_is_not_said_to_decay():
    """Right after the start it falls, and a longer run shows that the weights keep it up."""
    parts = {"vibration": 2e-3, "alone": 1e-3, "synchronous": 1e-3, "other": (116.7, 1.6e-3),
             "other_change": 0.7, "speed": 420.0}  # fmt: skip
    for behind, says in ((None, True), ((110.6, 116.7), False)):
        found = Verdict("balls", **parts, left_behind=behind, outcome=Outcome.ANOTHER_MOTION)
        assert (", which decays." in " ".join(sentences(found))) == says


def test_a_longer_run_that_ends_in_another_motion_states_its_vibration():
    """Balls of little drag, captured later than the run shows."""
    changes = {"rotor.stiffness": 20e3, "rotor.damping": 30.0, "balls.speeds": [-180.0] * 3}
    scene = drum(speed=180.0, turns=10, balls__drag=1e-2).replace(changes)
    found = verdict(scene)
    assert found.outcome is Outcome.ANOTHER_MOTION
    said = re.search(r"the vibration is then ([\d.]+) mm", found.reason)
    assert said
    longer = verdict(scene.replace({"run.revolutions": 3000}))
    assert found.vibration < 0.5 * longer.vibration
    assert 1e-3 * float(said[1]) == pytest.approx(longer.vibration, rel=0.1)


def test_an_unstable_position_of_balance_is_left_where_others_are_stable():
    """Three balls balance at many angles: they leave those that are unstable, and balance."""
    scene = drum(speed=180.0, turns=20, balls__drag=0.01, rotor__damping=30.0)
    near = {"rotor.stiffness": 20e3, "balls.angles": [3.435, 1.801, 4.345]}
    found = verdict(scene.replace(near))
    assert found.growth > 0.0
    assert found.outcome is Outcome.NOT_SETTLED
    assert verdict(scene.replace({**near, "run.revolutions": found.revolutions})).balanced


@pytest.mark.parametrize("revolutions", [6, 12, 20])
def test_no_part_of_a_vibration_is_stated_larger_than_the_whole(revolutions):
    """A precession that decays was larger in the window than it is in the last revolution."""
    scene = Scene(
        rotor={"kind": "planar", "mass": 5.0, "stiffness": 2e3, "damping": 30.0,
               "unbalance": 2e-4},
        balancer=[BALLS | {"count": 2, "mass": 0.02, "track_radius": 0.1, "drag": 0.05,
                           "angles": [2.0, 4.2]}],
        speed=60.0,
        run={"revolutions": revolutions, "initial": {"x": 5e-3}},
    )  # fmt: skip
    found = verdict(scene)
    assert found.other is not None
    assert found.other[1] <= found.vibration
