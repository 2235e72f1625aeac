"""Values and paths that no scene needs are refused in words."""

from __future__ import annotations

import pytest

from autobalancer.harness import Scene, load_scene
from autobalancer.harness.errors import SceneError, UserError
from autobalancer.harness.scene.changes import parse_change

SCENE = load_scene("two_balls")
MINIMAL = {
    "rotor": {"kind": "planar", "mass": 1.0, "stiffness": 1.0, "unbalance": 0.1},
    "operation": {"speed": 3.0},
}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"run.revolutions": 1e-50}, "must be 1e-09 or more"),
        ({"rotor.unbalance": 1e61}, r"rotor\.unbalance = 1e\+61 .*1e\+60 or less"),
        ({"run.initial.angle": 1e14}, r"must be 1e\+09 or less"),
        ({"weights.angles": [-1e14, 0.0]}, r"must be -1e\+09 or more"),
        ({"rotor." + ".".join(["a"] * 900): 1}, "no path has 901 parts"),
    ],
)
def test_an_extreme_value_or_path_is_refused(changes, words):
    with pytest.raises(SceneError, match=words):
        SCENE.replace(changes)


@pytest.mark.parametrize("name", ["tub", "Ü", "桶", "b" * 32])
def test_a_body_is_named_in_any_script(name):
    scene = load_scene("rubber_drive")
    named = scene.replace({"rotor.bodies[1].name": name, "rotor.on": name})
    assert named.replace({f"{name}.mass": 2.5}).rotor.bodies[0].mass == 2.5


@pytest.mark.parametrize("name", ["b" * 33, "1a", "a b", "a.b", "<b>"])
def test_a_name_of_a_body_that_no_table_could_show_is_refused(name):
    with pytest.raises(SceneError, match=r"bodies\[1\]\.name .* digits, _, - only, at most 32"):
        load_scene("rubber_drive").replace({"rotor.bodies[1].name": name, "rotor.on": name})


def test_a_document_deeper_than_any_scene_is_refused():
    deep: dict = {}
    inner = deep
    for _ in range(900):
        inner["rotor"] = {}
        inner = inner["rotor"]
    with pytest.raises(SceneError, match="more than 20 deep"):
        Scene.from_document(deep)
    with pytest.raises(SceneError, match="more than 20 deep"):
        SCENE.replace({"run.record": deep})


@pytest.mark.parametrize(
    "text", ["run.revolutions=1\nrotor.mass=3", "a=" + "[" * 900 + "]" * 900, "a", "=", "a="]
)
def test_an_assignment_that_is_not_one_value_is_refused_on_one_line(text):
    with pytest.raises(UserError, match="must be KEY=VALUE") as caught:
        parse_change(text)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 400


def test_a_file_larger_than_any_scene_is_refused_unread(tmp_path):
    path = tmp_path / "large.toml"
    with path.open("wb") as stream:
        stream.truncate(10_000_001)
    with pytest.raises(SceneError, match=r"large\.toml: has 10000001 bytes; .* at most 10000000"):
        load_scene(path)


@pytest.mark.parametrize("letter", ["\x00", "\x07", "\x1b", "\x7f", "\x9b", "\ufffe"])
@pytest.mark.parametrize("key", ["title", "source"])
def test_a_control_character_is_refused_with_its_place(key, letter):
    """XML cannot hold it, and a terminal would obey it."""
    with pytest.raises(SceneError, match=rf"{key} = .*U\+{ord(letter):04X}, at place 3: remove it"):
        Scene.from_document({**MINIMAL, key: f"ab{letter}c"})


def test_lines_and_letters_of_any_language_are_allowed():
    assert Scene.from_document({**MINIMAL, "title": "Größe\t→ 振動 🙂\nb"}).title.endswith("\nb")


@pytest.mark.parametrize("key", ["rotor.stiffness", "rotor.mass"])
def test_a_positive_number_too_close_to_0_is_refused(key):
    """Its inverse leaves no room for products: a division by zero later on."""
    with pytest.raises(SceneError, match=rf"{key} = 1e-300 .*too close to 0: must be 1e-60 or"):
        SCENE.replace({key: 1e-300})
