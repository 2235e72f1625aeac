"""Values with units: what they mean in SI, and what is refused."""

import math
import subprocess
import sys

import numpy as np
import pytest

from autobalancer.harness import SceneError, UserError, cosimulate, load_scene, speeds
from autobalancer.harness.output.picture import Line, Panel, Picture, PlotAxis
from autobalancer.harness.output.plot import as_png, drawn, save
from autobalancer.harness.output.table import Sheet
from autobalancer.harness.scene.changes import parse_change
from autobalancer.harness.stability.axis import Axis
from autobalancer.harness.units import QUANTITIES, engineering, in_words, to_si


@pytest.fixture
def engineers():
    token = engineering.set(True)
    yield
    engineering.reset(token)


@pytest.mark.parametrize(
    ("text", "symbol", "value"),
    [
        ("1200 rpm", "rad/s", 40.0 * math.pi),
        ("1200rpm", "rad/s", 40.0 * math.pi),
        ("20 Hz", "rad/s", 40.0 * math.pi),
        ("20 rev/s", "rad/s", 40.0 * math.pi),
        ("180 deg", "rad", math.pi),
        ("-90°", "rad", -math.pi / 2.0),
        ("300 g mm", "kg m", 3e-4),
        ("300 g*mm", "kg m", 3e-4),
        ("300 g·mm", "kg m", 3e-4),
        ("1 oz in", "kg m", 0.028349523125 * 0.0254),
        ("20 kN/m", "N/m", 2e4),
        ("0.08 N*s/mm", "N s/m", 80.0),
        ("7.8 g/cm^3", "kg/m^3", 7800.0),
        ("7.8 g/cm³", "kg/m^3", 7800.0),
        ("5e2 kg mm^2", "kg m^2", 5e-4),
        ("0.5 mm/kN", "m/N", 5e-7),
        ("10 %", "", 0.1),
        (".5 µm", "m", 5e-7),
    ],
)
def test_text_with_a_unit_is_its_value_in_si(text, symbol, value):
    assert to_si(text, symbol) == pytest.approx(value, rel=1e-14)


@pytest.mark.parametrize("symbol", QUANTITIES)
def test_the_examples_of_a_message_are_accepted_and_every_key_has_some(symbol):
    for example in QUANTITIES[symbol].examples:
        assert to_si(example, symbol) > 0.0


@pytest.mark.parametrize(
    ("path", "text", "said"),
    [
        ("speed", "3 kg", 'operation.speed = "3 kg": a speed is expected, such as "1200 rpm" or'),
        ("speed", "20 1/s", "a speed is expected"),
        ("speed", "20", "a speed is expected"),
        ("rotor.mass", "8,0 kg", "a mass is expected"),
        ("rotor.mass", "5 foo", "unknown unit 'foo': a mass is expected"),
        ("rotor.mass", "5 kg m-", "unknown unit"),
        ("rotor.mass", "5 kg\nx", "a mass is expected"),
        ("rotor.mass", "-5 g", "must be greater than 0"),
        ("rotor.unbalance", "50 g", "an unbalance is expected, such as"),
        ("weights.angles", ["0 deg", "1 kg"], "an angle is expected"),
        ("weights.count", "3 g", "must be a whole number"),
        ("coupling.tolerance", "1 mm", "a ratio is expected"),
        ("rotor.damping_ratio", "-1 %", "must be 0 or more"),
    ],
)
def test_a_unit_that_does_not_fit_is_refused_with_what_does(path, text, said):
    with pytest.raises(SceneError) as caught:
        load_scene("two_balls").replace({path: text})
    assert said in str(caught.value)


def test_every_place_of_a_number_takes_a_unit():
    scene = load_scene("two_balls").replace(
        {
            "rotor.stiffness[2]": "2 N/mm",
            "weights.angles": ["90 deg", 0.0],
            "operation.run_up": {"from": "1 rpm", "to": "30 rpm", "seconds": "200 ms"},
        }
    )
    assert scene.rotor.stiffness == (1.0, 2000.0)
    assert scene.balancer[0].angles == pytest.approx((math.pi / 2.0, 0.0))
    assert scene.profile().end == pytest.approx(math.pi)
    motor = {"inertia": "2 g m^2", "table": [[0.0, "5 N m"], ["600 rpm", "-1 N m"]]}
    drive = load_scene("two_balls").replace({"operation.motor": motor}).operation.motor
    assert drive.points[1] == pytest.approx((20.0 * math.pi, -1.0))
    assert "2 N/mm" in scene.toml  # the user's words are kept


def test_ranges_axes_and_limits_take_units():
    scene = load_scene("two_balls")
    found = speeds(scene, ("10 rpm", "90 rpm"), ["criterion"])
    assert found.range == pytest.approx((math.pi / 3.0, 3.0 * math.pi))
    assert Axis.parse("weights.mass=10g:20g:3", scene).values == pytest.approx([0.01, 0.015, 0.02])
    with pytest.raises(UserError, match="an unbalance is expected"):
        Axis.parse("rotor.unbalance=1g:2g:3", scene)
    with pytest.raises(UserError, match="range: 3 kg: a speed is expected"):
        speeds(scene, ("3 kg", "90 rpm"), ["criterion"])
    run = cosimulate(scene.replace({"run.revolutions": 2}))
    run.assert_bounded("rotor.x", "1 m")
    with pytest.raises(AssertionError, match=r"limit 0\.001"):
        run.assert_bounded("rotor.x", "1 mm")
    with pytest.raises(UserError, match="below 3 kg: a length is expected"):
        run.assert_balanced(below="3 kg")


def test_an_assignment_takes_a_unit_without_quotes():
    assert parse_change("rotor.damping=1e4") == ("rotor.damping", 1e4)
    assert parse_change("rotor.damping=1.5e-3") == ("rotor.damping", 1.5e-3)
    assert parse_change("speed=1200 rpm") == ("speed", "1200 rpm")
    assert parse_change("rotor.mass = 3kg") == ("rotor.mass", "3kg")


@pytest.mark.parametrize("name", ["two_balls", "two_plane_rodrigues", "three_mass_shaft"])
def test_a_damping_ratio_is_that_of_each_support_with_the_mass_on_it(name):
    scene = load_scene(name)
    key = "support_damping" if scene.rotor.kind == "flexible" else "damping"
    rotor = scene.replace({"rotor.damping_ratio": "5 %"}).rotor
    damping = np.reshape(getattr(rotor, key), (-1, 2))
    springs = np.reshape(getattr(rotor, key.replace("damping", "stiffness")), (-1, 2))
    masses = (damping / (2.0 * 0.05)) ** 2 / springs  # c = 2 ratio sqrt(k m)
    assert masses.sum(axis=0) == pytest.approx([rotor.mass] * 2)
    places = np.array(rotor.support_positions)
    assert masses[:, 0] @ places == pytest.approx(rotor.mass * rotor.centre)
    both = {"rotor.damping_ratio": 0.1, f"rotor.{key}": getattr(rotor, key)}
    with pytest.raises(SceneError, match=f"give either {key}"):
        scene.replace(both)


def test_pint_is_loaded_only_for_text_with_a_unit():
    code = (
        "import sys; from autobalancer.harness import cosimulate, load_scene;"
        "scene = load_scene('two_balls'); cosimulate(scene); print('pint' in sys.modules);"
        "scene.replace({'speed': '20 rpm'}); print('pint' in sys.modules)"
    )
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert said.stdout.split() == ["False", "True"]


def test_tables_and_lines_show_engineering_units(engineers):
    sheet = Sheet(
        ["speed [rad/s]", "frequency [rad/s]", "x [m]", "n"], [["3.14159265", "-", "1", "2"]]
    )
    shown = sheet.in_units()
    assert list(shown.columns) == ["speed [rpm]", "frequency [Hz]", "x [mm]", "n"]
    assert shown.rows == [["30", "-", "1000", "2"]]
    assert in_words("from 3.14159265 to 6.2831853 rad/s, 0.02 kg m, 3 m/s, 2 N s/m") == (
        "from 30 to 60 rpm, 20000 g mm, 3 m/s, 2 N s/m"
    )


def test_axes_drawn_directly_are_relabelled_when_saved(engineers, tmp_path):
    from matplotlib.figure import Figure

    axes = (figure := Figure()).subplots()
    axes.plot([0.0, 100.0], [0.0, 1.0])
    axes.set_xlabel("speed [rad/s]")
    save(figure, tmp_path / "picture.png")
    assert axes.get_xlabel() == "speed [rpm]"
    labels = [float(label.get_text()) for label in axes.get_xticklabels()]
    assert labels == pytest.approx([place * 30.0 / math.pi for place in axes.get_xticks()])
    assert all(label % 50 == 0 for label in labels)


def test_units_are_those_of_the_option_or_of_the_environment(invoke, monkeypatch):
    monkeypatch.setenv("AUTOBALANCER_UNITS", "engineering")
    assert "9.5493, 66.8451 rpm" in invoke("rotor", "two_balls").stdout.splitlines()[-1]
    assert "rad/s" in invoke("rotor", "two_balls", "--units", "si").stdout.splitlines()[-1]
    monkeypatch.setenv("AUTOBALANCER_UNITS", "feet")
    outcome = invoke("rotor", "two_balls")
    assert outcome.exit_code == 2
    assert "AUTOBALANCER_UNITS" in outcome.stderr


def test_titles_legends_and_marks_of_pictures_follow_the_units_that_are_shown(engineers):
    line = Line((np.zeros(2), np.zeros(2)), "at 10 rad/s", texts=("1 rad/s", "2 rad/s"))
    panel = Panel((PlotAxis("time", "s"), PlotAxis("speed", "rad/s")), [line], title="5 rad/s")
    figure = drawn(Picture("from 0.1 kg m", [panel]))
    as_png(figure)
    (axes,) = figure.axes
    assert (figure.get_suptitle(), axes.get_title()) == ("from 100000 g mm", "47.7465 rpm")
    assert axes.get_ylabel() == "speed [rpm]"
    assert axes.get_legend().get_texts()[0].get_text() == "at 95.493 rpm"
    assert [text.get_text() for text in axes.texts] == ["9.5493 rpm", "19.0986 rpm"]
