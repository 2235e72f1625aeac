"""Values in a wrong unit are warned of, never refused; what was understood is one line."""

import re
import warnings

import pytest

from autobalancer.harness import Scene, bundled_scenes, cosimulate, load_scene
from autobalancer.harness.scene import plausible
from autobalancer.harness.scene.plausible import ImplausibleWarning, implausible, understood

DRUM = """
[rotor]
kind = "planar"
mass = 8.0
stiffness = [20e3, 30e3]
damping = [80.0, 100.0]
unbalance = 0.02
[[balancer]]
kind = "balls"
count = 3
mass = 0.05
track_radius = 0.2
drag = 0.2
[operation]
speed = 150.0
"""
MISTAKES = {
    "rpm as rad/s": ("speed=1200", 'speed = 1200 rad/s = 11460 rpm: .* write "1200 rpm"'),
    "g as kg": ("balls.mass=50", r'balls.mass = 50 kg: .* heavier than .* write "50 g"'),
    "mm as m": ("balls.track_radius=200", "move along their track at 30000 m/s; .* track_radius"),
    "g mm as kg m": ("rotor.unbalance=20000", 'eccentricity of 2500000 mm, .* write "20000 g mm"'),
    "degrees as rad": ("balls.angles=[0,120,240]", "balls.angles = .* are they in degrees"),
    "capacity": ("rotor.unbalance=0.05", "50 g m to balance, the weights hold at most 30 g m"),
    "density": ("balls.weight_radius=1.5e-3", "a density of 3.54e.03 g/cm.3 with weight_radius"),
    "rpm as rad/s, no balls": ("speed=5000", "101 times the critical speed"),
    "damping": ("rotor.damping=1e4", "damping is 12.5 times the critical one"),
}


@pytest.fixture
def drum(tmp_path):
    path = tmp_path / "my_drum.toml"
    path.write_text(DRUM, encoding="utf-8")
    return path


@pytest.mark.parametrize(("change", "said"), MISTAKES.values(), ids=MISTAKES)
def test_a_value_in_a_wrong_unit_is_warned_of_and_not_refused(change, said, drum, invoke):
    outcome = invoke("rotor", drum, "--set", change)
    assert outcome.exit_code == 0, outcome.output
    lines = outcome.stderr.splitlines()

    assert any(line.startswith("WARNING: ") and re.search(said, line) for line in lines), lines
    assert not invoke("rotor", drum, "--set", change, "--quiet").stderr


def test_what_was_understood_is_said_in_engineering_units(drum, invoke):
    line = (
        "my_drum: 8 kg at 150 rad/s = 1432 rpm; natural frequencies 7.88, 9.66 Hz; unbalance "
        "20 g m, eccentricity 2.5 mm; 3 balls of 50 g hold 30 g m"
    )
    assert understood(load_scene(drum)) == line
    outcome = invoke("rotor", drum)
    assert outcome.stdout.splitlines()[0] == line
    assert not outcome.stderr
    assert line not in invoke("rotor", drum, "--quiet").stdout


def test_bundled_scenes_are_warned_of_only_where_that_is_their_point():
    found = {name: implausible(load_scene(name)) for name in bundled_scenes()}
    assert {name for name, lines in found.items() if lines} == {
        "contact_order", "sommerfeld",  # more unbalance than the weights can hold
        "liquid_touch",  # overdamped
    }  # fmt: skip


def test_the_library_warns_once():
    scene = load_scene("two_balls").replace({"rotor.unbalance": 0.0625, "run.revolutions": 1})
    with pytest.warns(ImplausibleWarning, match="62.5 g m to balance") as warned:
        scene.run()
    assert warned[0].filename == __file__  # not the library's
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        cosimulate(scene)


def test_a_quiet_check_does_not_warn(invoke, monkeypatch):
    monkeypatch.setattr(plausible, "_warnings_given", set())
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        outcome = invoke("check", "sommerfeld", "--quiet")
    assert (outcome.exit_code, outcome.stderr) == (0, "")


def test_a_file_of_the_name_of_a_bundled_scene_is_pointed_out(tmp_path, invoke, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert "bundled" not in invoke("rotor", "two_balls").stderr
    (tmp_path / "two_balls.toml").write_text(DRUM, encoding="utf-8")
    said = invoke("rotor", "two_balls").stderr
    assert "two_balls: is the bundled scene; write two_balls.toml for the file here" in said
    assert "bundled" not in invoke("rotor", "two_balls.toml").stderr


def test_unbalance_out_of_reach_is_found_in_two_planes():
    scene = load_scene("two_plane_rodrigues").replace({"left.mass": 1e-3, "right.mass": 1e-3})
    assert any("the weights hold at most" in line for line in implausible(scene))


@pytest.mark.parametrize(("internal", "grows"), [(20.0, False), (120.0, True)])
def test_a_rotor_that_whirls_by_itself_beyond_any_bound_is_warned_of(internal, grows):
    """The limit is w0 (1 + c/ci) = 139 and 62 rad/s, the speed 120 rad/s."""
    rotor = {"kind": "planar", "mass": 14.0, "stiffness": 30e3, "damping": 40.0,
             "internal_damping": internal, "unbalance": 5e-3}  # fmt: skip
    balls = {"kind": "balls", "count": 5, "mass": 0.02, "track_radius": 0.12, "drag": 0.05}
    scene = Scene(rotor=rotor, balancer=[balls], speed=120.0, run={"revolutions": 300})
    found = [line for line in implausible(scene) if "the rotor itself is unstable" in line]
    assert bool(found) == grows
    if grows:
        (line,) = found
        rate = float(re.search(r"grows by (\S+) 1/s", line)[1])
        assert rate == pytest.approx(5.18, rel=0.01)
        assert not implausible(
            scene.replace({"run.revolutions": 0.9 * 25.0 / rate * 120.0 / 6.283})
        )


def test_a_scene_made_in_python_can_be_judged():
    rotor = {"kind": "planar", "mass": 8.0, "stiffness": 2e4, "unbalance": 1.0}
    found = implausible(Scene(rotor=rotor, operation={"speed": 150.0}))
    assert len(found) == 1
    assert "eccentricity of 125 mm, more than 10 mm" in found[0]
