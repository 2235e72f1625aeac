"""Pictures of a run show what closed forms say: spectra, polar curves, orbits, modes."""

from __future__ import annotations

import math

import numpy as np
import pytest

from autobalancer.harness import Scene, UserError, cosimulate, load_scene
from autobalancer.harness.output.picture import Picture
from autobalancer.harness.output.plot import drawn
from autobalancer.harness.result.in_space import mode_shapes
from autobalancer.harness.result.motion import Motion
from autobalancer.harness.result.orders import spectra, synchronous
from autobalancer.harness.result.result import UnknownSignalError

pytestmark = pytest.mark.slow

M, K, C, U, ALPHA = 2.0, 2.0, 1.6, 0.01, 0.5  # disc: natural frequency 1 rad/s, damping ratio 0.4


def disc(revolutions: float = 30.0, **operation: object) -> Scene:
    rotor = {"kind": "planar", "mass": M, "stiffness": K, "damping": C,
             "unbalance": U, "unbalance_angle": ALPHA}  # fmt: skip
    driven, run = operation or {"speed": 1.5}, {"revolutions": revolutions}
    return Scene.from_document({"rotor": rotor, "operation": driven, "run": run})


def linear_response(speed):
    """Amplitude A of the steady x = Re(A e^{i angle})."""
    return U * np.exp(1j * ALPHA) * speed**2 / (K - M * speed**2 + 1j * C * speed)


@pytest.fixture(scope="module")
def slow_run_up():
    """600 revolutions from 0.3 to 3 rad/s: the vibration has time to become the steady one."""
    revolutions = 600
    seconds = math.tau * revolutions / 1.65
    return cosimulate(disc(revolutions, run_up={"from": 0.3, "to": 3.0, "seconds": seconds}))


def lines(picture: Picture, panel: int = 0, style: str | None = None):
    return [line for line in picture.panels[panel].lines if style in (None, line.style)]


def test_orders_of_a_known_vibration_are_found_whatever_the_speed_does():
    time = np.linspace(0.0, 20.0, 4000)
    angle = 3.0 * time + 0.9 * time**2
    signal = 2.0 * np.cos(angle + 0.3) + 0.5 * np.cos(2.0 * angle - 1.0)
    signal += 0.2 * np.cos(0.5 * angle) + 7.0
    found = synchronous(angle, signal[None])[1]
    np.testing.assert_allclose(found, np.full(found.shape, 2.0 * np.exp(0.3j)), atol=2e-4)
    lines = spectra(angle, signal)
    for order, amplitude in ((0.5, 0.2), (1.0, 2.0), (2.0, 0.5), (3.0, 0.0)):
        line = lines.amplitude[:, np.isclose(lines.orders, order)]
        np.testing.assert_allclose(line, amplitude, atol=2e-4)


def test_waterfall_draws_frequency_speed_and_amplitude(slow_run_up):
    picture = slow_run_up.plot_waterfall()
    assert [axis.label for axis in picture.panels[0].axes] == [
        "frequency [Hz]", "speed [rad/s]", "amplitude, 0-peak [mm]",
    ]  # fmt: skip
    for line in lines(picture):
        frequency, speed, height = line.points
        top = height.argmax()
        assert math.tau * frequency[top] == pytest.approx(speed[0], rel=0.04)
        assert height[top] == pytest.approx(1e3 * abs(linear_response(speed[0])), rel=0.03)
    field = picture.panels[1].field
    column = int(np.searchsorted(field.x, 1.0))
    ridge = math.tau * field.y[np.nanargmax(field.values[:, column])]
    assert ridge == pytest.approx(field.x[column], rel=0.03)


def test_texts_over_colours_have_an_outline(slow_run_up):
    spectra = drawn(slow_run_up.plot_waterfall()).axes[1]
    assert [text.get_text() for text in spectra.texts] == ["order 1", "order 2"]
    assert all(text.get_path_effects() for text in spectra.texts)


def on_circle(speed, curve):
    """A/w is the mobility times u: a circle of diameter u/c through the origin, turned by alpha."""
    turned = curve * np.exp(-1j * ALPHA) / speed
    return np.abs(turned + 0.5j * U / C) / (0.5 * U / C)


def test_polar_curve_of_a_slow_run_up_is_a_circle_and_its_marks_say_the_speed(slow_run_up):
    picture = slow_run_up.plot_polar()
    (line,), (marks,) = lines(picture, style="solid"), lines(picture, style="marks")
    curve = marks.points[1] * np.exp(1j * marks.points[0]) * 1e-3
    speeds = np.array([float(text.removesuffix(" rad/s")) for text in marks.texts])
    np.testing.assert_allclose(on_circle(speeds, curve), 1.0, atol=0.02)
    np.testing.assert_allclose(curve, linear_response(speeds), atol=0.03 * U / C)
    assert len(line.points[0]) > 500
    along_y = lines(picture, panel=1, style="solid")[0]
    np.testing.assert_allclose(
        np.mod(line.points[0] - along_y.points[0], math.tau), math.pi / 2, atol=0.02
    )


def test_two_weights_end_where_they_hold_the_unbalance():
    """Either side of the light side by arccos(U/(2 m R)); NaN cuts the line at 360 degrees."""
    scene = load_scene("run_up")
    names = ["rotor.x", "rotor.y", "weights.weight[1].angle", "weights.weight[2].angle"]
    result = cosimulate(scene, record=names)
    panel = result.plot_weights().panels[2]
    ends = sorted(line.points[1][-1] for line in panel.lines if line.label.startswith("weight"))
    apart = math.degrees(math.acos(2.5e-3 / 4e-3))
    assert ends == pytest.approx([180.0 - apart, 180.0 + apart], abs=0.1)
    for line in panel.lines[:2]:
        steps = np.abs(np.diff(line.points[1]))
        assert np.nanmax(steps) < 180.0
        assert np.isnan(steps).any()


def test_history_marks_the_balanced_time_among_logarithmic_amplitudes_and_angles_within_a_turn():
    names = ["rotor.x", "rotor.y", "weights.weight[1].angle", "weights.weight[2].angle"]
    result = cosimulate("run_up", record=names)
    (amplitudes,) = [panel for panel in result.plot().panels if panel.axes[1].log]
    (mark,) = [line for line in amplitudes.lines if line.style == "dotted"]
    assert mark.points[0].tolist() == [result.summary().after] * 2
    (angles,) = [panel for panel in result.plot().panels if panel.axes[1].unit == "deg"]
    turned = np.concatenate([line.points[1] for line in angles.lines])
    assert 0.0 <= np.nanmin(turned) < np.nanmax(turned) < 360.0
    without = next(line for line in amplitudes.lines if line.style == "dashed")
    assert without.points[1][0] == pytest.approx(1e3 * result.summary().alone)  # drawn in mm


def test_at_constant_speed_the_same_stand_over_time():
    picture = cosimulate("two_balls").plot_waterfall()
    assert picture.panels[1].axes[0].label == "time [s]"


def test_orbits_of_a_rigid_shaft_lie_on_straight_lines_through_its_planes():
    result = cosimulate("drum")
    (panel,) = result.plot_orbits(revolutions=1.0).panels
    bent = next(line for line in panel.lines if line.style == "marks")
    z, x, y = bent.points
    assert z.tolist() == [-0.02, 0.0, 0.40, 0.42]
    for along in (x, y):
        slope = (along[2] - along[1]) / 0.40
        np.testing.assert_allclose(along, along[1] + slope * z, atol=1e-9 * np.abs(along).max())
    micrometres = [1e6 * result[f"rotor.station[{j}].x"][-1] for j in (1, 2)]
    np.testing.assert_allclose(x[1:3], micrometres, rtol=1e-12)
    assert [axis.label for axis in panel.axes] == ["along the shaft [m]", "x [µm]", "y [µm]"]
    orbit = panel.lines[1].points
    assert len(orbit[1]) == 41  # one revolution of 40 steps


def test_orbit_of_a_steady_disc_is_its_circle():
    picture = cosimulate(disc(60.0)).plot_orbits()
    x, y = lines(picture)[0].points
    np.testing.assert_allclose(np.hypot(x, y), 1e3 * abs(linear_response(1.5)), rtol=1e-3)
    assert picture.panels[0].equal


def test_mode_shapes_turn_as_their_titles_say():
    """Rodrigues' rotor has circular whirl in both senses."""
    picture = mode_shapes(load_scene("two_plane_rodrigues"))
    senses = set()
    for panel in picture.panels:
        sense = panel.title.rpartition(", ")[2]
        senses.add(sense)
        whirling = [line for line in panel.lines if line.style == "solid"][:2]
        for line in whirling:
            _, x, y = line.points
            turned = np.sum(x[:-1] * np.diff(y) - y[:-1] * np.diff(x))
            assert (turned > 0.0) == (sense == "forward")
            np.testing.assert_allclose(np.hypot(x, y), np.hypot(x[0], y[0]), rtol=1e-6)
    assert senses == {"forward", "backward"}


def test_what_a_scene_does_not_have_is_said():
    with pytest.raises(UserError, match="no balancer with weights"):
        cosimulate("liquid_disc").plot_weights()


@pytest.mark.parametrize(
    ("scene", "option", "change", "message"),
    [
        ("liquid_disc", "weights", [], "--weights: Liquid-balanced disc"),
        ("two_balls", "waterfall", ["run.revolutions=1.5"], "1.5 revolutions are too few"),
        # of 75 revolutions the speed rises over 23.9
        ("run_up", "polar", ["operation.run_up.seconds=0.3"], "3.58 revolutions are too few"),
        ("two_balls", "plot", ["run.record=[]"], "--plot: nothing to draw"),
    ],
)
def test_a_picture_that_the_run_cannot_give_is_refused_before_it(
    invoke, monkeypatch, tmp_path, scene, option, change, message
):
    monkeypatch.setattr("autobalancer.harness.result.run.cosimulate", None)
    changes = [part for each in change for part in ("--set", each)]
    done = invoke("run", scene, f"--{option}", tmp_path / "a.png", *changes)
    assert done.exit_code == 2, done.output
    assert message in done.output


def test_pictures_of_a_motors_run_go_by_the_speed_that_it_makes():
    """The angle that pictures take from the speed is the motor's own."""
    scene = load_scene("sommerfeld").replace({"run.revolutions": 120.0})
    names = ["motor.speed", "motor.angle", "rotor.x", "rotor.y"]
    result = cosimulate(scene, record=names)
    motion = Motion(scene, result.time, result)
    assert np.ptp(result["motor.speed"]) > 1.0
    np.testing.assert_array_equal(motion.speed, result["motor.speed"])
    np.testing.assert_allclose(motion.angle, result["motor.angle"], atol=1e-4)
    panel = result.plot_waterfall().panels[1]
    assert panel.axes[0].label == "time [s]"
    ridge = math.tau * panel.field.y[np.nanargmax(panel.field.values, axis=0)]
    speed = np.interp(panel.field.x, result.time, result["motor.speed"])
    np.testing.assert_allclose(ridge / speed, 1.0, atol=1.5 / 32)  # lines are 1/32 apart


def test_a_rotor_that_comes_to_rest_has_no_orders():
    with pytest.raises(UserError, match="does not turn forwards all the time"):
        synchronous(np.array([0.0, 30.0, 60.0, 60.0]), np.zeros((1, 4)))


def test_what_was_not_recorded_is_said():
    result = cosimulate(disc(2.0), record=["rotor.x"])
    with pytest.raises(UnknownSignalError, match=r"rotor.y.*was not recorded"):
        result.plot_orbits()
    with pytest.raises(UserError, match="2 revolutions are too few: 4 or more are needed: raise"):
        cosimulate(disc(2.0)).plot_polar()


def test_a_rotor_at_rest_has_no_waterfall_and_all_other_pictures():
    result = cosimulate(disc(8.0).replace({"rotor.unbalance": 0.0}))
    with pytest.raises(UserError, match=r"rotor\.x: does not vibrate"):
        result.plot_waterfall()
    for picture in (result.plot_polar(), result.plot_orbits()):
        assert picture._repr_png_()


def test_run_draws_what_is_asked_for(invoke, tmp_path):
    kinds = ("weights", "waterfall", "polar", "orbits")
    options = [part for kind in kinds for part in (f"--{kind}", str(tmp_path / f"{kind}.png"))]
    # its scene records no angles of the weights: they are added
    done = invoke("run", "run_up", *options)
    assert done.exit_code == 0, done.output
    for kind in kinds:
        assert (tmp_path / f"{kind}.png").read_bytes().startswith(b"\x89PNG")


def test_a_waterfall_of_a_profile_says_which_part_it_shows():
    corners = [[0.0, 1.0], [20.0, 2.0], [60.0, 2.0], [110.0, 0.2]]  # 8.7 turns down
    changes = {
        "operation.profile": corners,
        "run.record": ["rotor.x", "rotor.y"],
        "run.revolutions": None,
    }
    result = cosimulate(load_scene("two_balls").without_balancers().replace(changes))
    assert result.plot_waterfall().title.endswith("waterfall: run-down from 60 s to 110 s only")
    assert result.plot_polar().title.endswith("run-down from 60 s to 110 s only")


def test_no_legend_over_time_covers_a_curve():
    stops = load_scene("washing_machine_stops").replace({"run.duration": 0.5})
    weights = load_scene("two_balls").replace({"run.revolutions": 2.0})
    for picture in (cosimulate(stops).plot(), cosimulate(weights).plot_weights()):
        figure = drawn(picture)
        figure.draw_without_rendering()
        legends = [(axes, each) for axes in figure.axes if (each := axes.get_legend())]
        assert legends
        for axes, legend in legends:
            assert legend.get_window_extent().x0 >= axes.get_window_extent().x1
            assert legend.get_window_extent().x1 <= figure.bbox.x1
