"""Input in a form of its own: the message shows the right one, or it is understood."""

from __future__ import annotations

import pytest

from autobalancer.harness import load_scene
from autobalancer.harness.errors import SceneError, UserError
from autobalancer.harness.scatter.vary import Variation
from autobalancer.harness.scene.changes import parse_change
from autobalancer.harness.units import to_si


@pytest.mark.parametrize(
    ("text", "value"), [(".006", 0.006), ("5.", 5.0), ("-.5e-2", -0.005), ("0.006", 0.006)]
)
def test_numbers_without_a_digit_before_or_behind_the_point_are_numbers(text, value):
    assert parse_change(f"balls.drag={text}") == ("balls.drag", value)


def test_a_text_without_quotes_is_shown_in_quotes():
    with pytest.raises(UserError, match=r"text stands in quotes: 'rotor.unbalance=\"G6.3\"'"):
        parse_change("rotor.unbalance=G6.3")
    with pytest.raises(UserError, match=r"'coupling.scheme=\"jacobi\"'$"):
        parse_change("rotor.unbalance=")


@pytest.mark.parametrize(
    ("text", "symbol", "hint"),
    [
        ("G6.3", "kg m", "a grade is no unbalance: that of G6.3 is 6.3e-3 m/s"),
        ("6 %", "N s/m", r"of a damping ratio it is 2 \* ratio \* sqrt"),
        ("100-2000", "rad/s", "two speeds are written apart: 100rpm 2000rpm"),
        ("100rpm-2000rpm", "rad/s", "two speeds are written apart"),
    ],
)
def test_a_value_of_another_kind_says_how_to_state_it(text, symbol, hint):
    with pytest.raises(ValueError, match=hint):
        to_si(text, symbol)


def test_a_deviation_alone_says_how_it_is_written():
    with pytest.raises(UserError, match=r"5 % write rotor.mass=normal\(MEAN,5%\)"):
        Variation.parse("rotor.mass=5%", load_scene("two_balls"))


def test_a_path_that_does_not_exist_names_no_bundled_scenes(invoke, tmp_path):
    (tmp_path / "drum.toml").write_text("")
    outcome = invoke("run", tmp_path / "drun.toml")
    assert outcome.exit_code == 2
    assert "no such file (did you mean" in outcome.stderr
    assert "two_balls" not in outcome.stderr
    assert "two_balls" in invoke("run", "two_bals").stderr
    outcome = invoke("run", tmp_path / "undamped.toml")  # alike in its ending alone
    assert outcome.stderr.endswith("undamped.toml: no such file\n")


def test_a_scene_file_of_any_name_is_named_whole(tmp_path):
    """Names that stand in the question too, as `a` and `you`; one in quotes."""
    for name, typed in (("a", "aa"), ("you", "yuo"), ('my"drum', 'my"drun')):
        (tmp_path / f"{name}.toml").write_text("")
        with pytest.raises(SceneError) as refused:
            load_scene(tmp_path / f"{typed}.toml")
        said = f'{typed}.toml: no such file (did you mean "{tmp_path / name}.toml"?)'
        assert str(refused.value).endswith(said)


def test_a_number_and_another_mistake_are_not_taken_for_a_value_with_a_space(invoke):
    outcome = invoke("capture", "--speed", "20", "two_balls", "--plt", "x.png")
    assert "--plt" in outcome.stderr
    assert "quotes" not in outcome.stderr


def test_paths_that_are_nearly_right_say_how_they_are_written(invoke):
    axes = ["--x", "spede=1:2:3", "--y", "weights.drag=1:2:3"]
    assert 'did you mean "speed"?' in invoke("map", "two_balls", *axes).stderr
    fit = ["fit", "two_balls", "--measured", "x.csv", "--free", "rotor.stiffness"]
    assert "name one of them, rotor.stiffness[1] to rotor.stiffness[2]" in invoke(*fit).stderr
    outcome = invoke("race", "two_balls", "--lobes", "2=20um")
    assert "run the scene with them instead" in outcome.stderr  # its supports are not alike
    outcome = invoke("race", "grinder", "--lobes", "2=20um")
    assert "give them as the key race" in outcome.stderr


def test_engineers_frequencies_stand_in_one_column(invoke):
    outcome = invoke("--units", "engineering", "rotor", "two_balls")
    if outcome.exit_code:
        outcome = invoke("rotor", "two_balls", "--units", "engineering")
    assert outcome.exit_code == 0, outcome.output
    assert outcome.output.count("[Hz]") == 1
