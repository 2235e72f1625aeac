"""Steady motions: names, shares, what is said of them, refusals."""

import json

import numpy as np
import pytest

from autobalancer import Scene, load
from autobalancer.harness.errors import SceneError, UserError
from autobalancer.harness.motions.batch import squared_distances
from autobalancer.harness.motions.kinds import WINDOWS, Kind, Seen, classify
from autobalancer.harness.motions.outcome import wilson
from autobalancer.harness.motions.starts import job
from autobalancer.harness.motions.study import _point
from autobalancer.models.boundaries import balancing_boundaries
from tests.studies.left_behind import motions as witness

GREEN = {"kind": "planar", "mass": 1.0, "stiffness": 1.0, "damping": 0.02, "unbalance": 0.01}
BALLS = {"name": "balls", "kind": "balls", "count": 2, "mass": 0.03267, "track_radius": 1.0}


def green(drag=0.001, **operation):
    return Scene(
        rotor=GREEN, balancer=[{**BALLS, "drag": drag}], operation=operation or {"speed": 3.0}
    )


def seen(vibration, lag, swing=0.0):
    """One run of two weights: a value, or one for each window."""
    v = np.broadcast_to(vibration, WINDOWS).astype(float)[None]
    lags = np.broadcast_to(np.reshape(lag, (-1, 2)), (WINDOWS, 2)).astype(float)[None]
    return Seen(np.full((1, WINDOWS), 3.0), v, lags, np.full((1, WINDOWS, 2), swing), 50.0)


RISING = np.linspace(1.0, 2.0, WINDOWS)
NOISE = 1.0 + 0.4 * np.array([1, -1, 1, 1, -1, 1, -1, -1])


@pytest.mark.parametrize(
    ("vibration", "lag", "swing", "kind", "weights"),
    [
        (0.01, (0.0, 0.0), 0.0, Kind.BALANCED, 0),
        (0.01 * RISING**3, (0.0, 0.0), 0.0, Kind.UNDECIDED, 0),
        (0.8, (0.0, 0.0), 0.0, Kind.SYNCHRONOUS, 0),
        (0.8, (0.0, 0.0), 0.5, Kind.TWO_FREQUENCIES, 0),
        (NOISE, (0.0, 0.0), 0.5, Kind.IRREGULAR, 0),
        (5.0, (2.1, 2.1), 0.2, Kind.BEHIND, 2),
        (5.0, (2.1, 0.0), 0.2, Kind.BEHIND, 1),
        (5.0, (2.1, 0.04), 0.2, Kind.BEHIND, 1),
        (5.0, (2.1, 1.0), 0.2, Kind.BEHIND, 2),
        (5.0, (0.02, 0.02), 0.2, Kind.TWO_FREQUENCIES, 0),
        (NOISE, (2.1, 1.0), 0.2, Kind.IRREGULAR, 0),
        (5.0, np.outer(RISING, (1.0, 1.0)), 0.2, Kind.UNDECIDED, 0),
        (np.nan, (0.0, 0.0), 0.0, Kind.FAILED, 0),
    ],
)
def test_windows_are_named_by_the_rules(vibration, lag, swing, kind, weights):
    found = classify(seen(vibration, lag, swing), 1.0, 3.0)
    assert (Kind(int(found.kind[0])), found.weights[0]) == (kind, weights)
    if kind is Kind.BEHIND and lag[1] != 1.0:
        assert found.frequency[0] == pytest.approx(0.9)
    elif kind is Kind.BEHIND:  # beside two natural frequencies
        assert np.isnan(found.frequency[0])


EARLY_SLIP = np.array([0.3, 0, 0, 0, 0, 0, 0, 0])
BEATING = 5.0 + 0.1 * np.array([1, -1, 1, 1, -1, 1, -1, -1])


@pytest.mark.parametrize(
    ("vibration", "slip", "kind", "decided"),
    [
        (5.0, 0.0, Kind.BEHIND, True),
        (5.0, EARLY_SLIP, Kind.BEHIND, True),  # on its way to a motion that does not beat
        (BEATING, 0.0, Kind.BEHIND, False),
        (BEATING, EARLY_SLIP, Kind.IRREGULAR, False),
    ],
)
def test_beating_weights_are_left_behind_where_a_long_run_shows_no_slip(
    vibration, slip, kind, decided
):
    lags = 2.1 - np.broadcast_to(slip, WINDOWS)
    one = seen(vibration, np.stack([lags, np.full(WINDOWS, 2.1)], axis=1))
    found = classify(one, 1.0, 3.0)
    assert (Kind(int(found.kind[0])), found.decided[0]) == (kind, decided)


def test_wilsons_interval_is_that_of_his_formula():
    assert wilson(9, 100) == pytest.approx((0.0481, 0.1623), abs=2e-4)
    assert wilson(0, 40)[0] == 0.0
    assert wilson(40, 40)[1] == 1.0


def test_light_balls_from_rest_are_left_behind_as_an_independent_integration_finds():
    """1,000 starts of it: 75 % both left behind, 12 % one, 13 % balanced; at 0.9128 rad/s."""
    (point,) = green().motions(starts="rest", n=24).points
    names = {s.motion.name: s for s in point.shares}
    both = names["left behind: 2 of 2 beside 0.9688 rad/s"]
    assert both.frequency == pytest.approx(0.9128, rel=5e-3)
    assert both.vibration == pytest.approx(0.488, rel=5e-3)
    low, high = both.interval
    assert low < 0.75 < high


def test_starts_that_end_alike_are_one_share_where_no_natural_frequency_is_known():
    """The rotor is unstable by its internal damping: the closed form says nothing."""
    scene = load("two_balls").replace({"rotor.internal_damping": 5.0})
    (share,) = scene.motions(n=3, starts="turning").points[0].shares
    assert (share.motion.name, share.count) == ("left behind: 2 of 2", 3)


def test_weights_beside_several_natural_frequencies_are_one_share():
    columns = [np.array(c) for c in ([3, 3, 1], [2, 2, 0], [np.nan] * 3, [0.1] * 3, [0.2] * 3)]
    shares = _point([*columns, np.full(3, "", object)], 3.0, "rest", None, 1.0).shares
    assert [(s.motion.name, s.count) for s in shares] == [
        ("left behind: 2 beside several natural frequencies", 2),
        ("balanced", 1),
    ]


def test_starts_that_turn_with_the_rotor_balance():
    (point,) = green().motions(starts="turning", n=8).points
    assert point.balanced.count == 8


def test_a_sag_is_no_part_of_the_largest_vibration():
    given = {"starts": ["turning"], "n": 2}
    (one,) = green(0.05, speed=3.0, gravity=0.1).motions(**given).points  # the sag is 0.107
    (none,) = green(0.05, speed=3.0).motions(**given).points
    assert one.largest == pytest.approx(none.largest, rel=0.1)


def test_starts_under_gravity_differ_although_weights_at_rest_roll_down():
    lying = green(0.05, profile=[[0.0, 0.0], [600.0, 3.0]], gravity=0.3)
    made, _ = job(lying, 3.0, "run-up", 1, 0, 3)
    squares, _ = squared_distances(made)
    ends = np.sqrt(squares[:, -200:].max(axis=1))
    assert np.ptp(ends) > 0.1 * ends.max()  # by the weights' angles alone 4e-5


def test_the_output_says_that_weights_that_are_alike_were_changed(invoke, tmp_path):
    path = green().save(tmp_path / "green.toml")
    target = tmp_path / "motions.json"
    line = ["motions", path, "-n", "4", "--starts", "rest,turning", "--json", target]
    outcome = invoke(*line, "--plot", tmp_path / "shares.png", "--store", tmp_path / "store")
    assert outcome.exit_code == 0, outcome.output
    assert "made to differ by 0.0001 (balls.drag)" in outcome.output
    assert "(balls.drag)" not in json.dumps(load(str(path)).document)
    document = json.loads(target.read_text(), parse_constant=pytest.fail)
    assert [p["start"] for p in document["points"]] == ["rest", "turning"]
    assert sum(m["count"] for m in document["points"][0]["motions"]) == 4
    again = invoke(*line, "--store", tmp_path / "store")
    assert again.exit_code == 0
    assert json.loads(target.read_text()) == document
    other = invoke("motions", path, "-n", "5", "--store", tmp_path / "store")
    assert other.exit_code == 2
    assert "made for another" in other.stderr


def test_a_rising_and_a_falling_speed_differ_for_light_balls():
    scene = green(0.0101).replace({"rotor.damping": 0.1})
    found = scene.sweep(0.3, 3.6)
    low, high = found.hysteresis
    (lost,) = balancing_boundaries(scene.assembly(), 0.3, 3.6)
    assert low == pytest.approx(lost.speed, abs=0.03)  # the balanced motion, by Floquet
    assert high == pytest.approx(2.9, abs=0.03)
    up, down = found.branches
    assert np.interp(2.5, up.speed, up.vibration) > 10.0 * np.interp(
        2.5, down.speed[::-1], down.vibration[::-1]
    )
    held = up.speed[up.vibration > 3.0 * found.alone]
    assert held.max() == pytest.approx(2.93, rel=0.05)  # let go there, by an integration


def test_a_motor_that_stalls_is_refused():
    motor = {"inertia": 0.5, "stall_torque": 1e-3, "no_load_speed": 3.0}
    with pytest.raises(SceneError, match="stalls"):
        green(motor=motor).motions(starts="run-up", n=2)


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["--starts", "resting"], "must be some of rest, turning, run-up"),
        (["--speeds", "3", "1", "4"], "two positive speeds, rising"),
        (["--sweep"], "give also --speeds"),
        (["--sweep", "--speeds", "1", "3", "4", "--store", "x"], "keeps no store"),
    ],
)
def test_contradictory_options_end_with_two(invoke, tmp_path, options, says):
    outcome = invoke("motions", green().save(tmp_path / "green.toml"), *options)
    assert outcome.exit_code == 2
    assert says in " ".join(outcome.stderr.split())


def test_liquid_alone_and_no_start_are_refused():
    with pytest.raises(SceneError, match="only liquid"):
        load("liquid_touch").motions(n=2)
    with pytest.raises(UserError, match="at least one of"):
        green().motions(starts="", n=2)


@pytest.mark.parametrize("seed", [-1, 1.5, True, "a"])
def test_what_no_random_numbers_can_be_drawn_from_is_refused(invoke, tmp_path, seed):
    for study in (
        lambda: green().motions(n=2, seed=seed),
        lambda: green().sweep(1.0, 2.0, seed=seed),
        lambda: green().scatter({"balls.drag": "normal(0.001,1%)"}, n=2, seed=seed),
    ):
        with pytest.raises(UserError, match="must be a whole number, 0 or more"):
            study()
    outcome = invoke("motions", green().save(tmp_path / "green.toml"), "--seed=-1")
    assert outcome.exit_code == 2


def test_a_map_has_the_share_of_run_ups_that_balances():
    quick = green(run_up={"from": 0.0, "to": 3.0, "seconds": 20.0})
    found = quick.map("balls.drag=0.02:0.06:2", "rotor.damping=0.1:0.2:2", "motions")
    assert found.share.shape == (2, 2)
    assert found.share.max() == 1.0


@pytest.mark.parametrize(
    ("name", "says"), [("liquid_touch", "only liquid"), ("bristol_friction", "no bal")]
)
def test_a_map_of_motions_refuses_what_has_no_weights_before_it_runs(name, says):
    with pytest.raises(SceneError, match=says):
        load(name).map("run.revolutions=10:20:2", "speed=100:200:2", "motions")


def test_a_map_whose_points_all_fail_is_an_error_with_the_first_reason(monkeypatch):
    weak = {"motor": {"inertia": 0.5, "stall_torque": 0.002, "no_load_speed": 4.0}}
    monkeypatch.setattr("autobalancer.harness.motions.map.STARTS_OF_POINT", 2)
    with pytest.raises(SceneError, match=r"no point of the map could be run: .*the motor stalls"):
        green(0.006, **weak).map("rotor.damping=0.1:0.2:2", "balls.drag=0.005:0.006:2", "motions")


def test_weights_that_slip_steadily_by_less_than_two_per_cent_are_two_frequencies():
    om = 3.0
    assert kind_of(seen(4.0, [0.01 * om, 0.01 * om], swing=3.0)) is Kind.TWO_FREQUENCIES
    uneven = np.where(np.arange(WINDOWS) % 2, 4.0, 5.0)
    assert kind_of(seen(uneven, [0.01 * om, 0.01 * om], swing=3.0)) is Kind.IRREGULAR


def kind_of(one):
    return Kind(int(classify(one, 1.0, 3.0).kind[0]))


def on_a_table(low=1.0, **operation):
    """The machine of `green` with more damping on a bearing that grows stiffer with the speed."""
    rows = [[low, 1.0, 0, 0, 1.0, 0.1, 0, 0, 0.1], [6.0, 1.5, 0, 0, 1.5, 0.1, 0, 0, 0.1]]
    rotor = {"kind": "planar", "mass": 1.0, "unbalance": 0.01, "bearings": [{"table": rows}]}
    return Scene(
        rotor=rotor, balancer=[{**BALLS, "drag": 0.003}], operation=operation or {"speed": 3.0}
    )


def test_balls_are_left_behind_at_the_natural_frequency_of_a_tables_speed():
    found = on_a_table().motions([2.0, 3.0], "rest", 6)
    for point in found.points:
        behind = [s for s in point.shares if s.motion.kind is Kind.BEHIND]
        assert behind
        closed = on_a_table().capture(point.speed).found.motions
        for share in behind:
            (expected,) = (m.frequency for _, m in closed if m.weights == share.motion.weights)
            assert share.frequency == pytest.approx(expected, rel=5e-3)


def test_speeds_beyond_a_table_are_refused_before_anything_runs():
    scene = on_a_table()
    with pytest.raises(SceneError, match="speed = 7 rad/s: must be within 1 to 6 rad/s"):
        scene.motions([3.0, 7.0], "rest", 2)
    with pytest.raises(SceneError, match=r"speed = 0\.5 rad/s: must be within 1 to 6"):
        scene.sweep(0.5, 3.0)


@pytest.mark.parametrize(
    ("seed", "number"), [(2711, 147), (4304, 35)], ids=["irregular at first", "a swing that grows"]
)
def test_a_motion_that_decides_late_has_the_name_that_an_integration_finds(seed, number):
    one = witness.case(witness.KINDS[number % len(witness.KINDS)], number, seed)
    named = witness.by_integration(one)
    assert named == (Kind.BEHIND, 4)
    assert witness.by_package(one) == named


def test_motions_of_a_rotor_without_unbalance_have_no_ratio_to_that_without_balancers():
    found = green(drag=0.01).replace({"rotor.unbalance": 0.0}).motions(starts=["rest"], n=2)
    assert all(point.alone == 0.0 for point in found.points)
    assert {row[-1] for row in found.readable().rows} == {"-"}
    assert {row[-1] for row in found.table().rows} == {""}


def test_a_weight_that_turns_far_beyond_a_natural_frequency_is_not_beside_it(tmp_path):
    """Supports damped by 10 % brake a single weight at 0.9 of the rotor's speed."""
    rotor = {"kind": "planar", "mass": 1.0, "stiffness": 1.0, "damping": 0.2, "unbalance": 0.0005}
    one = {"kind": "pendulums", "count": 1, "mass": 0.002, "track_radius": 1.0, "drag": 8e-6}
    operation = {"speed": 4.0}
    machine = Scene.from_document({"rotor": rotor, "balancer": [one], "operation": operation})
    found = machine.motions(starts=["rest"], n=2)
    (share,) = found.points[0].shares
    assert share.frequency == pytest.approx(0.8955 * 4.0, rel=0.01)
    assert share.motion.name == "left behind: 1 of 1"
    assert "left behind: 1 of 1 at 3.58" in found.readable().rows[0][2]
    assert "cannot tell at 4 rad/s" in machine.capture().sentence()


def test_weights_that_cancel_each_other_balance_a_rotor_without_unbalance():
    """Nothing holds the weights: each start ends at rest or with a weight behind."""
    scene = Scene(
        rotor={"kind": "planar", "mass": 4.0, "stiffness": 20e3, "damping": 20.0},
        balancer=[{"kind": "balls", "count": 2, "mass": 0.005, "track_radius": 0.05,
                   "drag": 0.005}],
        operation={"speed": 150.0},
    )  # fmt: skip
    found = scene.motions(starts=["turning", "rest"], n=25)
    turning, rest = found.points
    assert turning.balanced.count == 25
    assert rest.balanced.count > 0
    assert {s.motion.kind for s in rest.shares} == {Kind.BALANCED, Kind.BEHIND}


def test_the_store_can_be_named_by_text(tmp_path):
    path = tmp_path / "store"
    for _ in range(2):
        load("two_balls").motions(n=1, store=str(path))
    assert path.is_file()
