"""Pictures of a rotor: what they show is right, and every axis says its unit."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from autobalancer.harness import Scene, UserError, load_scene
from autobalancer.harness.balancing.cycles import balance
from autobalancer.harness.output.picture import Line, Picture, colour
from autobalancer.harness.output.plot import drawn

pytestmark = pytest.mark.slow


def disc(**changes):
    """A planar rotor whose every answer has a closed form: k/m = 1, zeta = c/(2 m)."""
    rotor = {"kind": "planar", "mass": 2.0, "stiffness": 2.0, "damping": 0.08,
             "unbalance": 0.01, "unbalance_angle": 0.5, **changes}  # fmt: skip
    return Scene.from_document({"rotor": rotor, "operation": {"speed": 1.5}})


def shown(picture: Picture, panel: int = 0, **look: str) -> list[Line]:
    """Lines of a panel with this look."""
    return [
        line
        for line in picture.panels[panel].lines
        if all(getattr(line, key) == value for key, value in look.items())
    ]


def test_campbell_curves_meet_the_speed_line_at_the_critical_speeds():
    """Rodrigues' rotor: forward tilt mode Jt l^2 - Jp w l - k22 = 0 crosses l = w at 1.81."""
    found = load_scene("two_plane_rodrigues").rotor(0.02, 4.0)
    assert found.critical == pytest.approx([1.0, math.sqrt(9.0 / 2.75)])
    data = found.campbell()
    tilt = np.sort(np.abs(data.eigenvalues.imag), axis=1)
    w = data.speeds
    forward = (0.5 * w + np.sqrt((0.5 * w) ** 2 + 4 * 3.25 * 9.0)) / (2 * 3.25)
    np.testing.assert_allclose(tilt[:, -1], forward, rtol=1e-3)  # damping of 2 % shifts it by 4e-4
    picture = found.plot(kind="campbell")
    (marks,) = shown(picture, style="marks")
    np.testing.assert_array_equal(marks.points, (found.critical, found.critical))
    assert shown(picture, style="dashed", label="backward motion")
    labels = [axis.label for panel in picture.panels for axis in panel.axes]
    assert all(label.endswith(("[rad/s]", "[1]")) for label in labels)


def test_legend_of_the_campbell_diagram_covers_no_line():
    figure = drawn(load_scene("drum").rotor().plot(kind="campbell"))
    figure.draw_without_rendering()
    above = figure.axes[0]
    legend = above.get_legend().get_window_extent()
    assert not above.get_window_extent().shrunk(0.999, 0.999).overlaps(legend)
    assert legend.x1 <= figure.bbox.x1


def test_campbell_says_when_a_mode_changes_its_nature():
    """Internal damping makes a heavily damped disc oscillate at higher speeds only."""
    scene = disc(damping=[5.0, 3.0], internal_damping=1.0)
    with pytest.raises(UserError, match=r"0.1 to 9 rad/s: a mode is overdamped at some"):
        scene.rotor(0.1, 9.0).campbell()


def test_response_of_the_unit_is_that_of_a_disc():
    """|A| = u w^2/|k - m w^2 + i c w|, lagging by atan2(c w, k - m w^2)."""
    found = disc().rotor(0.1, 3.0)
    data = found.response()
    exact = 0.01 * np.exp(0.5j) * data.points**2
    exact /= 2.0 - 2.0 * data.points**2 + 0.08j * data.points
    np.testing.assert_allclose(data.measured[:, 0, 0], exact, rtol=1e-7)
    np.testing.assert_allclose(data.measured[:, 1, 0], -1j * exact, rtol=1e-7)
    np.testing.assert_allclose(
        np.interp(data.points, data.speeds, np.abs(data.amplitude[:, 0, 0])), np.abs(exact),
        rtol=2e-2,
    )  # fmt: skip
    picture = found.plot(kind="response")
    assert len(picture.panels) == 2  # x and y alike: drawn once
    assert picture.panels[0].axes[1].label == "amplitude, 0-peak [mm]"
    (size,) = shown(picture, style="marks")
    np.testing.assert_allclose(size.points[1], 1e3 * np.abs(exact), rtol=1e-7)
    (phase,) = shown(picture, panel=1, style="marks")
    np.testing.assert_allclose(phase.points[1], np.degrees(np.angle(exact)), rtol=1e-6)


def test_response_along_both_axes_is_drawn_where_they_differ():
    picture = disc(stiffness=[2.0, 3.0]).rotor(0.1, 3.0).plot(kind="response")
    assert [panel.title for panel in picture.panels] == ["along x", "along y", "", ""]


def test_response_needs_an_unbalance():
    with pytest.raises(UserError, match="has no unbalance to respond to"):
        disc(unbalance=0.0).rotor(0.1, 3.0).response()


def test_run_up_passes_the_resonance_and_stays_below_its_steady_height():
    """Acceleration through a resonance: the peak comes late and is lower than u w/c."""
    speeds, displacement = disc().rotor(0.05, 3.0).run_up().run
    peak = int(np.argmax(displacement[:, 0]))
    assert 1.0 < speeds[peak] < 1.2
    assert displacement[peak, 0] < 0.01 * 1.0 / 0.08
    assert speeds[-1] == pytest.approx(3.0)
    # far above it the disc turns about its centre of mass
    assert displacement[-1, 0] == pytest.approx(0.005 / (1 - 1 / 9), rel=0.05)


@pytest.mark.filterwarnings("error")
def test_a_run_up_without_balancers_gives_no_warning_that_the_scene_does_not():
    """Its eccentricity of 20 mm is small beside the tracks, and large for a rotor without any."""
    load_scene("three_mass_shaft").rotor(0.5, 4.0).run_up()


def test_a_run_up_with_and_without_balancers_has_times_of_its_own_each():
    found = load_scene("run_up").rotor(20.0, 60.0)
    data, picture = found.run_up(), found.plot(kind="run-up")
    assert len(data.run[0]) != len(data.alone[0])
    for panel, (speeds, displacement) in zip(picture.panels, (data.run, data.alone), strict=True):
        *_, line = panel.lines
        np.testing.assert_array_equal(line.points[0], speeds)
        assert panel.axes[1].limits[1] > 1e3 * displacement.max()  # mm


def test_polar_picture_ends_where_the_unbalance_is_undone():
    result = balance(load_scene("balancing_machine"))
    for i, panel in enumerate(result.plot().panels):
        path = next(line for line in panel.lines if line.colour == colour(0))
        angle, size = (part[-1] for part in path.points)
        goal = -result.technologies[0].cycles[0].actual[i] * 1e3  # g m
        assert size * np.exp(1j * angle) == pytest.approx(goal, rel=1e-9)
        assert "[g m]" in panel.title
        assert i or "2 cycles" in path.label


def test_command_prints_modes_and_writes_what_is_asked_for(invoke, tmp_path):
    data = tmp_path / "modes.json"
    paths = {name: tmp_path / f"{name}.png" for name in ("campbell", "response", "run-up")}
    options = [part for name, path in paths.items() for part in (f"--{name}", str(path))]
    scene = tmp_path / "disc.toml"
    scene.write_text(
        '[rotor]\nkind = "planar"\nmass = 2.0\nstiffness = 2.0\ndamping = 0.08\nunbalance = 0.01\n'
        "[operation]\nspeed = 1.5\n"
    )
    arguments = ["rotor", str(scene), *options, "--range", "0.1", "3.0", "--json", str(data)]
    done = invoke(*arguments)
    assert done.exit_code == 0, done.output
    assert "Critical speeds, undamped: 1 rad/s" in done.output
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in paths.values())
    found = json.loads(data.read_text())
    assert found["critical_speeds"] == pytest.approx([1.0])
    assert [m["damping_ratio"] for m in found["modes"]] == pytest.approx([0.02, 0.02])
    assert {m["direction"] for m in found["modes"]} == {"forward", "backward"}


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--range", "3.0", "1.0"], "--range 3 1: must be two speeds"),
        (["--campbell", "picture.bmp"], "pictures end in .png, .svg, .pdf"),
        (["--run-up", "no/such/place.png"], "there is no directory no/such"),
        (["--run-up", f"{__file__}/place.png"], "test_rotor_plots.py is a file, not a directory"),
    ],
)
def test_command_refuses_what_it_cannot_draw(invoke, options, message):
    done = invoke("rotor", "two_balls", *options)
    assert done.exit_code == 2
    assert message in done.output
