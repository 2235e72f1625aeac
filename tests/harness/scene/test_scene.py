"""Scene files: what a right one means, and what replacing a value does."""

import math
from pathlib import Path

import numpy as np
import pytest

from autobalancer.harness import Scene, bundled_scenes, load_scene
from autobalancer.harness.errors import SceneError
from autobalancer.harness.master.plan import plan
from autobalancer.models.papers.window import LiquidWindow

LIQUID_CASES = [name for name in bundled_scenes() if name.startswith("liquid_")]


def test_two_ball_scene_is_the_reference_scene_of_the_design():
    scene = load_scene("two_balls")
    rotor, weights = scene.rotor, scene.balancer[0]
    assert (rotor.mass, rotor.stiffness, rotor.damping) == (0.95, (1.0, 49.0), (0.5, 1.0))
    assert rotor.unbalance == 0.025
    assert (weights.count, weights.mass, weights.track_radius) == (2, 0.025, 1.0)
    assert (weights.drag, weights.kappa) == (0.0125, 1.0)
    assert (weights.angles, weights.speeds) == ((0.3, 1.0), (0.0, 0.0))
    assert scene.profile().speed(7.0) == 3.0
    assert scene.run.revolutions == 20


def test_assembly_carries_the_scene_s_numbers():
    assembly = load_scene("two_balls").assembly()
    assert assembly.added_mass == pytest.approx([0.05])
    assert assembly.rotor.stiffness_y[0, 0] == 49.0
    assert assembly.balancers[0].plane == 0
    assert assembly.balancers[0].device.point_capacity == pytest.approx(0.05)


@pytest.mark.parametrize("name", LIQUID_CASES)
def test_bundled_liquid_shaft_has_the_stiffness_derived_in_its_comments(name):
    elasticity, diameter, length = 2.1e11, 0.012, 0.5
    stiffness = 48.0 * elasticity * math.pi * diameter**4 / 64.0 / length**3
    assert load_scene(name).rotor.stiffness == pytest.approx((stiffness, stiffness), rel=1e-6)


@pytest.mark.parametrize(
    ("name", "lower", "upper"),
    [
        ("liquid_disc", 109.985, 416.497),
        ("liquid_no_internal", 109.985, None),
        ("liquid_closed", 109.985, 109.330),
        ("liquid_heavy", 55.7238, 161.503),
        ("liquid_heavy_force", 55.7238, 161.503),
        ("liquid_touch", 81.7461, 332.452),
    ],
)
def test_limits_stated_in_a_bundled_scene_s_comments_are_dubovik_s(name, lower, upper):
    scene = load_scene(name)
    rotor = scene.rotor
    mass = rotor.mass + float(scene.assembly().added_mass[0])
    c, chi, p = rotor.stiffness[0], rotor.damping[0], rotor.internal_damping
    assert math.sqrt(2.0 * c / (rotor.mass + mass)) == pytest.approx(lower, rel=1e-5)
    if upper is None:
        assert p == 0.0
    else:
        assert (1.0 + chi / p) * math.sqrt(c / mass) == pytest.approx(upper, rel=1e-5)
    text = scene.path.read_text(encoding="utf-8")
    assert f"{lower:.6g} rad/s" in text
    assert upper is None or f"{upper:.3f} rad/s" in text


@pytest.mark.parametrize("name", LIQUID_CASES)
def test_float_touches_within_the_window_only_where_the_scene_says_so(name):
    scene = load_scene(name)
    window = LiquidWindow.of(scene.assembly())
    end = window.upper or 5.0 * window.lower
    speeds = np.linspace(window.lower, max(end, window.lower), 2000)
    touches = np.asarray(window.bending(speeds)) > window.liquid.gap
    if name == "liquid_touch":
        assert not touches[0]
        assert speeds[np.argmax(touches)] == pytest.approx(113.630, rel=2e-3)
    else:
        assert not touches.any()


def test_heavy_liquid_has_mu_twenty_in_a_gap_of_a_millimetre():
    window = LiquidWindow.of(load_scene("liquid_heavy").assembly())
    assert window.mu == pytest.approx(20.0, rel=1e-5)
    assert window.liquid.gap == pytest.approx(1e-3)
    force, port = load_scene("liquid_heavy_force"), load_scene("liquid_heavy")
    assert force.balancer[0].inertia_as_force
    assert force.rotor == port.rotor


def test_empty_window_meets_the_condition_for_it():
    window = LiquidWindow.of(load_scene("liquid_closed").assembly())
    ratio = (1.0 + window.external_damping / window.internal_damping) ** 2
    assert ratio <= 2.0 * window.mu / (1.0 + window.mu)


def test_one_number_stands_for_both_axes():
    scene = load_scene("two_balls").replace({"rotor.stiffness": 4})
    assert scene.rotor.stiffness == (4.0, 4.0)
    assert scene.replace({"rotor.stiffness[2]": 9.0}).rotor.stiffness == (4.0, 9.0)


def test_weights_are_spread_evenly_by_default_and_turn_with_the_rotor():
    scene = load_scene("two_balls").replace({"weights.count": 4, "weights.angles": None})
    assert scene.balancer[0].angles == pytest.approx([0.0, math.pi / 2, math.pi, 3 * math.pi / 2])
    assert scene.balancer[0].speeds == (0.0,) * 4


def test_replace_leaves_the_original_alone():
    scene = load_scene("two_balls")
    other = scene.replace({"rotor.unbalance": 0.1, "weights.drag": np.float64(0.2)})
    assert (other.rotor.unbalance, other.balancer[0].drag) == (0.1, 0.2)
    assert (scene.rotor.unbalance, scene.balancer[0].drag) == (0.025, 0.0125)
    assert other.replace({"run.revolutions": 3}).rotor.unbalance == 0.1


def test_speed_and_run_up_take_each_other_s_place():
    run_up = {"from": 0.0, "to": 9.0, "seconds": 60.0}
    rising = load_scene("two_balls").replace({"operation.run_up": run_up})
    profile = rising.profile()
    assert (profile.speed(0.0), profile.speed(30.0), profile.speed(99.0)) == (0.0, 4.5, 9.0)
    assert rising.replace({"operation.speed": 2.0}).profile().acceleration(0.0) == 0.0
    assert rising.replace({"operation.run_up.to": 6.0}).profile().end == 6.0


def test_where_nothing_is_asked_a_tolerance_is_kept_by_what_can_keep_one():
    scene = load_scene("liquid_disc")
    assert (scene.coupling.tolerance, scene.coupling.steps_per_rev) == (1e-4, None)
    for asked in ({"scheme": "jacobi"}, {"order": 1}, {"corrections": 2}):
        coupling = scene.replace({f"coupling.{k}": v for k, v in asked.items()}).coupling
        assert (coupling.tolerance, coupling.steps_per_rev) == (None, 40)


def test_scene_survives_the_way_into_another_process():
    import pickle

    scene = load_scene("liquid_disc")
    copy = pickle.loads(pickle.dumps(scene))
    assert copy == scene
    assert copy.replace({"rotor.mass": 7.0}).rotor.mass == 7.0
    assert copy.path == scene.path


def test_what_a_scene_builds_is_built_once_and_no_part_of_its_value():
    scene = load_scene("two_balls")
    assert scene.assembly() is scene.assembly()
    assert scene.profile() is scene.profile()
    assert scene == load_scene("two_balls")
    assert scene.model_dump() == load_scene("two_balls").model_dump()


def test_scene_is_frozen():
    scene = load_scene("two_balls")
    with pytest.raises(ValueError, match="frozen"):
        scene.rotor.mass = 2.0


def test_a_file_wins_over_a_bundled_scene_of_its_name(tmp_path, monkeypatch):
    bundled = load_scene("two_balls")
    text = bundled.path.read_text(encoding="utf-8").replace("mass = 0.95", "mass = 1.95")
    (tmp_path / "two_balls.toml").write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    assert load_scene("two_balls.toml").rotor.mass == 1.95
    assert load_scene("two_balls").rotor.mass == 0.95
    assert load_scene(Path("two_balls.toml")).rotor.mass == 1.95


def test_byte_order_mark_and_windows_line_ends_are_read(tmp_path):
    path = tmp_path / "windows.toml"
    content = load_scene("two_balls").path.read_bytes().replace(b"\n", b"\r\n")
    path.write_bytes(b"\xef\xbb\xbf" + content)
    assert load_scene(path).model_dump() == load_scene("two_balls").model_dump()


def test_bare_rotor_has_neither_balancer_nor_check():
    bare = load_scene("liquid_disc").without_balancers()
    assert (bare.balancer, bare.checks) == ((), ())
    assert bare.rotor == load_scene("liquid_disc").rotor
    assert bare.replace({"operation.speed": 10.0}).balancer == ()


def test_balancer_goes_by_its_kind_when_it_has_no_name():
    document = {
        "rotor": {"kind": "planar", "mass": 1.0, "stiffness": 1.0},
        "balancer": [
            {"kind": "balls", "count": 2, "mass": 0.1, "track_radius": 1.0},
            {"kind": "rollers", "count": 3, "mass": 0.1, "track_radius": 1.0},
        ],
        "operation": {"speed": 1.0},
    }
    scene = Scene.from_document(document)
    assert [b.label for b in scene.balancer] == ["balls", "rollers"]
    assert [b.kappa for b in scene.balancer] == [7 / 5, 3 / 2]
    assert scene.replace({"rollers.mass": 0.2}).balancer[1].mass == 0.2


def test_unknown_scene_lists_the_bundled_ones():
    with pytest.raises(SceneError, match=r"two_bals.*did you mean \"two_balls\".*liquid_disc"):
        load_scene("two_bals")


def test_the_eccentricity_of_a_race_is_two_parts_in_the_rotor():
    offset = {"weights.track_offset_xi": 3e-5, "weights.track_offset_eta": -4e-5}
    scene = load_scene("two_balls").replace(offset)
    assert scene.assembly().weights[0].offset == 3e-5 - 4e-5j
    start = {name: value for unit in plan(scene).units for name, value in unit.start.items()}
    assert (start["track_offset_xi"], start["track_offset_eta"]) == (3e-5, -4e-5)
