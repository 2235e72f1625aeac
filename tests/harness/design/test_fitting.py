"""Weights that a design recommends, judged from the real start."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import autobalancer as ab
from autobalancer.harness.design import scenes
from autobalancer.harness.design.answer import _capacity, _none
from autobalancer.harness.design.candidates import STANDARD, Candidate, candidates
from autobalancer.harness.design.drags import drag_range
from autobalancer.harness.design.fitting import _assumed
from autobalancer.harness.design.space import Space
from autobalancer.harness.design.trials import Corner, Trial, _margin, corner_scenes, run_corner
from autobalancer.harness.drag.estimate import find_drag
from autobalancer.harness.errors import SceneError, UserError
from autobalancer.models.capture import Capture

FAN = {
    "rotor": {
        "kind": "planar", "mass": 14.0, "stiffness": [4e4, 6e4], "damping": [45.0, 55.0],
        "unbalance": 1.2e-4,
    },
    "operation": {"speed": 309.0},
}  # fmt: skip
SPACE = {"race": "80 mm", "width": "14 mm"}


@pytest.fixture(scope="module")
def fan():
    return ab.Scene.from_document(FAN)


@pytest.fixture(scope="module")
def found(fan):
    given = {"run_up": "4 s", "drag": "0.02 N s/m", "n": 6, "most": 3}
    return fan.design("120 g mm", reserve=1.5, **SPACE, **given)


def test_every_candidate_has_the_capacity_and_fits(found):
    for one in found.trials:
        c = one.candidate
        assert c.capacity >= 1.5 * 1.2e-4 * (1 - 1e-9)
        assert 2.0 * c.radius <= 0.014 * (1 + 1e-9)
        alpha = math.asin(c.radius / c.track)
        held = c.mass * c.track * math.sin(c.count * alpha) / math.sin(alpha)
        assert c.capacity == pytest.approx(held, rel=1e-9)


def test_weights_without_reserve_hold_the_unbalance_in_their_own_scene(fan):
    scene = scenes.with_balls(fan, 0.08, 0.014)
    space = Space(0.08, 0.014, 0.0, 7800.0, 0.0, 1.2e-4, 1.0)
    for one in candidates(scene, space, range(2, 9), standard=False):
        ((made, unbalance),) = corner_scenes(scene, one, [0.01], [space.unbalance])
        assert made.balancer[0].capacity >= unbalance


def test_sizes_below_the_largest_are_candidates(found):
    for count in (2, 3):
        radii = [t.candidate.radius for t in found.trials if t.candidate.count == count]
        assert len(radii) == 3
        assert max(radii) == pytest.approx(0.007)
        assert min(radii) < 0.7 * max(radii)


def test_lightest_of_the_candidates_that_always_balance_is_taken(found):
    good = [t for t in found.trials if t.worst.share == 1.0 and t.peak_ratio <= 1.05]
    if good:
        best = min(good, key=lambda t: t.total).candidate
        assert f"{best.count} balls of {2e3 * best.radius:.3g} mm" in " ".join(found.words())


def test_a_sag_is_no_vibration(fan):
    # a linear rotor moves about its sag as it moves about the axis without gravity
    given = {"run_up": "4 s", "drag": "0.02 N s/m", "n": 2, "most": 2, "standard": True}
    level = fan.replace({"operation.gravity": 9.81})
    lying, upright = (s.design("120 g mm", reserve=5.0, **SPACE, **given) for s in (level, fan))
    for one, other in zip(lying.trials, upright.trials, strict=True):
        assert one.peak_alone == pytest.approx(other.peak_alone, rel=1e-6)
    assert lying.trials[-1].corners[-1].balanced == 2


def of_peaks(found, ratios):
    """The same trials, all of which balance, with peaks so many times those without balancers."""
    trials = []
    for one, ratio in zip(found.trials, ratios, strict=False):
        corners = [
            replace(c, settled=np.ones(40), left=np.zeros(40), peak=np.full(40, ratio),
                    peak_alone=1.0, failure="")
            for c in one.corners
        ]  # fmt: skip
        trials.append(Trial(one.candidate, tuple(corners)))
    return replace(found, trials=tuple(trials))


@pytest.mark.parametrize(
    ("ratios", "best", "also"),
    [
        ([1.0, 1.0, 1.0, 1.0, 1.0], 0, [1, 2, 3]),
        ([1.5, 1.0, 1.2, 1.0, 1.3], 1, [3]),
        ([2.5, 1.5, 2.0], 1, [2, 0]),
        ([1.0], 0, []),
    ],
)
def test_up_to_three_others_that_balance_as_surely_are_named(found, ratios, best, also):
    data = of_peaks(found, ratios)
    document = data.as_json()
    assert (document["recommended"], document["also_good"]) == ([best], also)
    assert len(document["rows"]) == len(ratios)
    lines = [line for line in data.words() if line.startswith("Also good: ")]
    for line, row in zip(lines, also, strict=True):
        c = data.trials[row].candidate
        assert line.startswith(f"Also good: {c.count} balls of {2e3 * c.radius:.3g} mm")
        assert f"largest vibration {100 * ratios[row]:.3g} % of that without" in line


def test_share_of_starts_is_that_of_single_runs(found, fan):
    """Each start again as a run of its own, judged by its last tenth."""
    from autobalancer.harness.design.trials import corner_scenes
    from autobalancer.harness.motions.settle import alone
    from autobalancer.harness.motions.starts import job

    trial = found.trials[-1]
    corner = trial.corners[0]
    steady = fan.replace({"operation.speed": None, "operation.profile": [[0, 0], [4.0, 309.0]]})
    scenes = corner_scenes(_with_balls(steady), trial.candidate, [corner.drag], [corner.unbalance])
    scene = scenes[0][0]
    made, _ = job(scene, 309.0, "run-up", 1, 0, 6)
    bare = alone(scene, 309.0)
    for k in range(2):
        label = scene.balancer[0].label
        angles = made.values[k][::2].tolist()
        end = [[0, 0], [4.0, 309.0], [made.seconds, 309.0]]
        run = scene.replace({f"{label}.angles": angles, "operation.profile": end}).run()
        size = np.hypot(run["rotor.x"], run["rotor.y"])
        late = size[run.time >= made.seconds - 0.1 * made.settled].max() / bare
        assert corner.peak[k] == pytest.approx(size.max(), rel=0.02)
        if math.isfinite(corner.settled[k]) and late < 0.04:
            assert corner.left[k] <= 0.05


def _with_balls(scene):
    from autobalancer.harness.design.scenes import with_balls

    return with_balls(scene, 0.08, 0.014)


def test_the_recommended_weights_make_a_scene_with_the_drive_at_the_smallest_drag(found):
    best = next(t for t in found.trials if t.worst.share == 1.0)
    often = best
    for _ in range(6):  # as if 42 starts had balanced
        often = often.with_more(best)
    made = replace(found, trials=(often,)).scene()
    (balls,) = made.balancer
    size = (best.candidate.count, best.candidate.mass, best.candidate.track)
    assert (balls.count, balls.mass, balls.track_radius) == size
    assert balls.drag == min(c.drag for c in best.corners)
    assert list(made.profile().speeds) == [0.0, 309.0]
    assert made.rotor.unbalance == 1.2e-4
    assert made.run.duration == pytest.approx(4.0 + 2.0 * best.settling, rel=0.01)
    assert made.run().summary().balanced
    assert found.scene() is None  # 6 starts show too little


def test_the_command_saves_no_scene_where_none_is_recommended(invoke, fan, tmp_path):
    path, target = fan.save(tmp_path / "fan.toml"), tmp_path / "with.toml"
    space = ["--track", "80mm", "--width", "14mm", "--drag", "1e-4", "--most", "2", "-n", "2"]
    outcome = invoke("design", path, *space, "--save", target)
    assert outcome.exit_code == 0, outcome.output
    assert "not written, none is recommended" in " ".join(outcome.output.split())
    assert not target.exists()


def test_details_refuse_what_they_do_not_ask_for(invoke):
    outcome = invoke("design", "drum", "--details", "--save", "x.toml", "--run-up", "4s", "-n", 6)
    assert outcome.exit_code == 2
    assert "--save, --run-up, -n: not with --details" in outcome.stderr
    outcome = invoke("design", "goncharov_balls", "--details", "--starts", "rest")
    assert "--starts rest: not with --details" in outcome.stderr
    outcome = invoke("design", "goncharov_balls", "--details", "--starts", "0")
    assert "starts = 0: must be a whole number from 1 to" in outcome.stderr


def test_balls_that_are_left_behind_are_not_recommended(fan):
    """Drag far below the closed form's limit: a slow run-up leaves every ball behind."""
    found = fan.design("120 g mm", **SPACE, run_up="20 s", drag="2e-5 N s/m", n=6, most=2)
    heavy = [t for t in found.trials if t.margin < 0.1]
    assert heavy
    assert all(t.worst.share < 1.0 for t in heavy)
    assert any(line.startswith("None") for line in found.words())


def test_no_candidate_with_the_capacity_is_a_reasoned_none(fan):
    found = fan.design("90 g m", **SPACE, n=1, most=2)
    assert not found.trials
    (line,) = [w for w in found.words() if w.startswith("None")]
    assert "larger race" in line


def test_standard_diameters_alone_are_used(fan):
    found = fan.design("120 g mm", **SPACE, drag="0.02 N s/m", standard=True, n=1, most=2)
    assert found.trials
    for one in found.trials:
        assert any(math.isclose(2.0 * one.candidate.radius, d) for d in STANDARD)


def test_unknown_drag_is_tried_from_the_bound_of_the_oil_to_ten_times_it(fan):
    drags = drag_range(fan, None, "ISO VG 68")
    found = fan.design("120 g mm", **SPACE, drag="0.02 N s/m", n=1, most=2)
    one = found.trials[0].candidate
    low, high = drags.of(one)
    assert low == pytest.approx(find_drag(2.0 * one.radius, oil="ISO VG 68").value)
    assert high == pytest.approx(10.0 * low)
    assert "Measure it" in drags.said


@pytest.mark.parametrize(
    ("given", "word"),
    [
        ({"start": "asleep"}, "must be some of rest, turning, run-up"),
        ({"drag": "0.1..0.01 N s/m"}, "--drag"),
        ({"drag": 0.1, "oil": "ISO VG 46"}, "either --drag"),
        ({"run_up": "-4 s"}, "--run-up"),
        ({"start": "rest", "run_up": "4 s"}, "belongs to --starts run-up"),
        ({"clearance": "20 mm"}, "--clearance"),
        ({"n": 0}, "n = 0: must be a whole number from 1 to"),
    ],
)
def test_wrong_values_are_refused_by_name(fan, given, word):
    with pytest.raises(UserError, match=word):
        fan.design("120 g mm", **SPACE, **given)


def test_motor_is_refused_with_what_to_give_instead():
    with pytest.raises(SceneError, match=r"operation\.motor: give operation\.speed or run_up"):
        ab.load("sommerfeld").design("1 g m", race="0.1 m", width="20 mm")


@pytest.mark.parametrize(
    ("capacity", "words"),
    [
        (1.0, "capacity 1 times the largest unbalance, without reserve"),
        (1.03, "capacity 1.03 times the largest unbalance, hardly any reserve"),
        (1.3, "capacity 1.3 times the largest unbalance"),
    ],
)
def test_a_capacity_without_reserve_is_called_so(capacity, words):
    one = SimpleNamespace(candidate=SimpleNamespace(capacity=capacity * 2e-4))
    assert _capacity(SimpleNamespace(space=SimpleNamespace(unbalance=2e-4)), one) == words


def test_unbalances_that_are_tried_are_written_without_exponents():
    (*_, line) = _assumed(SimpleNamespace(), "turning", (2e-4, 0.02))
    assert line == "Unbalance: tried at 200 g mm and at 20 g m."


def test_few_starts_that_all_balance_are_no_recommendation_and_no_refusal():
    nothing = np.zeros(6)
    corner = Corner(0.02, 1.2e-4, nothing, nothing, nothing, 1.0, 2.0)
    one = Trial(Candidate(2, 0.004, 0.002, 2e-4, 0.07), (corner,))
    (line,) = _none(SimpleNamespace(trials=[one], kind="balls"))
    assert line.startswith("Cannot tell from 6 starts: all of 2 balls of 8 mm")
    assert "at least 61 % only. Give -n 35 or more" in line


@pytest.mark.parametrize(
    ("balanced", "says"),
    [
        (39, "Cannot tell from 40 starts whether a candidate balances in at least 90 %"),
        (30, "None: no candidate balances in at least 90 %"),
    ],
)
def test_a_share_that_may_be_enough_is_no_none(balanced, says):
    settled = np.where(np.arange(40) < balanced, 1.0, np.inf)
    corner = Corner(0.02, 1.2e-4, settled, settled, settled, 1.0, 2.0, seconds=4.0)
    one = Trial(Candidate(2, 0.004, 0.002, 2e-4, 0.07), (corner,))
    (line,) = _none(SimpleNamespace(trials=[one], kind="balls"))
    assert line.startswith(says)
    assert "within 4 s at speed" in line
    assert ("-n 200" in line) == (balanced == 39)


def test_weights_with_much_drag_get_the_time_that_they_need():
    # by Runge-Kutta on the equations 16 of 16 starts balance, the last after 1011 revolutions
    rotor = {"kind": "planar", "mass": 0.0162, "stiffness": 285.0, "damping": 0.2,
             "unbalance": 3.2e-8}  # fmt: skip
    balls = {"kind": "balls", "name": "balls", "count": 4, "mass": 7.55e-6, "drag": 4.63e-3,
             "track_radius": 6.145e-3, "weight_radius": 6.15e-4}  # fmt: skip
    scene = ab.Scene.from_document(
        {"rotor": rotor, "balancer": [balls], "operation": {"profile": [[0, 0], [1.89, 774.0]]}}
    )
    corner = run_corner((scene, 3.2e-8, "run-up", 0, 8))
    assert corner.balanced == 8
    assert corner.settled.max() < corner.seconds


def test_dry_friction_is_refused_as_it_has_no_vibration_without_balancers_to_compare_with(fan):
    dry = fan.replace({"rotor.friction": [{"support": 1, "limit": [0.1, 0.1]}]})
    with pytest.raises(SceneError, match=r"rotor\.friction"):
        dry.design("120 g mm", **SPACE, n=1, most=2)


def test_where_the_closed_form_cannot_tell_the_margin_is_no_number(fan):
    nothing = Capture(100.0, (), (), (), np.zeros(1), 0.1, drag_ratio=0.5)
    assert _margin(nothing) == 2.0
    unstable = Capture(100.0, (), (), (), np.zeros(1), 0.1, drag_ratio=0.5, unstable=True)
    assert math.isnan(_margin(unstable))


@pytest.mark.parametrize("name", ["overhung_fan", "washing_machine_tub", "oval_fan"])
def test_a_rotor_without_a_design_is_refused_before_sizes_are_asked_for(name):
    with pytest.raises(ab.UserError, match=r'rotor\.kind = .* must be "planar"$'):
        ab.load(name).design()


@pytest.mark.parametrize(("mass", "falls"), [(0.0018, True), (0.0002, False)])
def test_a_vibration_is_said_to_fall_where_a_longer_run_ends_with_less(fan, mass, falls):
    """Seven balls of 0.2 g hold too little and soon rest; heavier ones still settle."""
    from autobalancer.harness.design.answer import _left
    from autobalancer.harness.motions.batch import squared_distances
    from autobalancer.harness.motions.settle import alone
    from autobalancer.harness.motions.starts import job

    drive = {"operation.speed": None, "operation.profile": [[0.0, 0.0], [4.0, 309.0]]}
    size = Candidate(7, 0.0038, mass, 2e-4, 0.0762)
    ((scene, unbalance),) = corner_scenes(_with_balls(fan.replace(drive)), size, [0.0035], [1.2e-4])
    corner = run_corner((scene, unbalance, "run-up", 0, 6))
    one = Trial(size, (corner,))
    said = _left(one)
    assert "vibration at the end of the runs" in said
    assert f"{corner.seconds:.3g} s at speed" in said
    made, _ = job(scene, 309.0, "run-up", 1, 0, 6)
    factor = 4.0 * corner.seconds / made.settled
    squares, _ = squared_distances(made.longer(factor, np.arange(6)))
    late = np.sqrt(squares[:, -squares.shape[1] // 20 :].max(axis=1)) / alone(scene, 309.0)
    assert ("still falls" in said) is one.still_falls is falls
    assert bool(np.median(late) < 0.5 * one.left) is falls
    if not falls:
        assert np.median(late) == pytest.approx(one.left, rel=0.3)
