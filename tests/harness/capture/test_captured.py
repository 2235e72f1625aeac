"""What is said of weights that are left behind: sentence, table, JSON, picture, refusals."""

import json

import pytest

from autobalancer.harness import Scene, load_scene
from autobalancer.harness.errors import SceneError

ROTOR = {"kind": "planar", "mass": 1.0, "stiffness": 1.0, "damping": 0.1, "unbalance": 0.01}
BALLS = {"name": "balls", "kind": "balls", "count": 2, "mass": 0.0327, "track_radius": 1.0}


def scene(drag=0.006, speed=4.0, balancer=None, **rotor):
    balls = {**BALLS, "drag": drag} if drag else BALLS
    return Scene(rotor={**ROTOR, **rotor}, balancer=[balancer or balls], speed=speed)


def test_the_sentence_says_from_which_drag_on_none_is_left_behind():
    low, high = scene(0.006).capture(), scene(0.0075).capture()
    assert low.sentence().startswith("Closed form: 2 of 2 balls can be left behind at 4 rad/s")
    assert "never from drag 0.00646 N s/m (1.08 times the present one) on" in low.sentence()
    assert "no balls can be left behind" in high.sentence()
    assert "left behind only below drag 0.00646 N s/m" in high.sentence()


def test_one_size_of_the_vibration_is_stated_once():
    """Where the unbalance adds less than a digit."""
    said = scene(0.001, speed=3.0, damping=0.02, unbalance=1e-4).capture().sentence()
    assert "vibration 480 mm, let go at" in said


def test_without_drag_the_limit_is_that_of_equal_drag():
    found = scene(drag=None).capture()
    assert found.drag["balls"] == pytest.approx(0.006457, rel=1e-3)
    assert any("No drag is given" in line for line in found.limits())


def test_large_unbalance_and_strong_damping_are_named_as_limits():
    said = " ".join(scene(unbalance=0.05, damping=0.5).capture().limits())
    assert "76 % of the capacity" in said
    assert "largest damping ratio is 0.24" in said
    assert not scene(0.0075, unbalance=0.001).capture().limits()


def test_supports_that_are_not_alike_are_named_as_a_limit_where_weights_can_be_left_behind():
    alike = scene(0.005)
    unlike = alike.replace({"rotor.stiffness": [1.0, 1.2]})
    words = "not alike along x and y"
    assert unlike.capture().found.motions
    assert any(words in line for line in unlike.capture().limits())
    assert not any(words in line for line in alike.capture().limits())


def test_json_holds_drag_release_and_every_motion(invoke, tmp_path):
    path = scene(0.006).save(tmp_path / "machine.toml")
    target = tmp_path / "found.json"
    outcome = invoke("capture", path, "--json", target, "-o", tmp_path / "brake.png")
    assert outcome.exit_code == 0, outcome.output
    document = json.loads(target.read_text(), parse_constant=pytest.fail)
    assert document["all_pass"] is False
    assert document["drag"]["balls"] == pytest.approx(0.006457, rel=1e-3)
    (natural,) = document["natural_frequencies"]
    assert [m["weights"] for m in natural["motions"]] == [1, 2]
    assert (tmp_path / "brake.png").stat().st_size > 10_000


def test_marks_of_the_picture_look_like_no_curve_and_differ_in_shape():
    (panel,) = scene(0.006).capture().plot().panels
    looks = {line.label.split(":")[0]: (line.style, line.colour) for line in panel.lines}
    stable, unstable = looks.pop("stable"), looks.pop("unstable")
    assert stable[0] != unstable[0]
    assert not {stable[1], unstable[1]} & {shade for _, shade in looks.values()}


def test_below_a_natural_frequency_above_the_speed_the_sentence_cannot_tell(invoke, tmp_path):
    rotor = {"kind": "two_support", "mass": 1.0, "inertia": 0.08, "polar_inertia": 0.04,
             "span": 1.0, "stiffness": [0.5, 0.5], "damping": [0.02, 0.02],
             "planes": [0.2, 0.8]}  # fmt: skip
    balls = [{**BALLS, "name": name, "at": k, "mass": 0.02, "drag": 0.3}
             for k, name in enumerate("ab", 1)]  # fmt: skip
    path = Scene(rotor=rotor, balancer=balls, speed=1.9).save(tmp_path / "machine.toml")
    target = tmp_path / "found.json"
    outcome = invoke("capture", path, "--json", target)
    assert "cannot tell at 1.9 rad/s" in outcome.output.replace("\n", " ")
    assert json.loads(target.read_text())["all_pass"] is None


def test_speeds_states_it_and_writes_it(invoke, tmp_path):
    target = tmp_path / "speeds.json"
    outcome = invoke(
        "speeds", "two_balls", "--range", "0.5", "5", "--method", "criterion", "--json", target
    )
    assert "Closed form: no pendulums can be left behind" in outcome.output
    assert json.loads(target.read_text())["capture"]["all_pass"] is True


def test_a_run_that_ends_with_balls_left_behind_states_it(invoke, tmp_path):
    path = scene(0.006).replace({"run.revolutions": 2}).save(tmp_path / "machine.toml")
    assert "can be left behind at 4 rad/s" in invoke("run", path).output
    safe = scene(0.0075).replace({"run.revolutions": 2}).save(tmp_path / "safe.toml")
    assert "left behind" not in invoke("run", safe).output


@pytest.mark.parametrize(
    ("name", "says"),
    [("liquid_touch", "only liquid"), ("bristol_friction", "no balancer")],
)
def test_what_has_no_weights_is_refused_with_what_applies(name, says):
    with pytest.raises(SceneError, match=says):
        load_scene(name).capture()


def test_dry_friction_is_refused(invoke, tmp_path):
    friction = [{"support": 1, "limit": [0.1, 0.1]}]
    path = scene(friction=friction).save(tmp_path / "dry.toml")
    outcome = invoke("capture", path)
    assert outcome.exit_code == 2
    assert "rotor.friction" in outcome.stderr


def test_weights_that_lag_together_above_the_natural_frequencies_are_marked_as_unstable():
    """In a run both stay there as long as they are at one angle; a little apart, they part."""
    machine = scene(0.006, unbalance=0.0, stiffness=[1.0, 4.0], damping=[0.1, 0.2])
    (panel,) = machine.capture().plot().panels
    (crosses,) = [line.points[0] for line in panel.lines if line.label == "unstable"]
    lagging = max(crosses)
    assert 3.5 < lagging < 3.9

    def speeds(apart):
        angles = [f"balls.weight[{k}].angle" for k in (1, 2)]
        starts = {"balls.angles": [0.0, apart], "run.revolutions": 100}
        run = machine.replace(starts).run(record=angles)
        late = run.time > 0.5 * run.time[-1]
        span = run.time[late][-1] - run.time[late][0]
        return [4.0 + (run[name][late][-1] - run[name][late][0]) / span for name in angles]

    assert speeds(0.0) == pytest.approx([lagging] * 2, rel=2e-3)
    assert speeds(0.02) == pytest.approx([4.0] * 2, rel=1e-4)
