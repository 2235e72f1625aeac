"""Pictures of a rotor: what they show is right, and every axis says its unit."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from autobalancer.harness import UserError, load_scene
from autobalancer.harness.balancing.cycles import balance
from autobalancer.harness.output.picture import colour
from autobalancer.harness.rotor import plot as pictures
from autobalancer.harness.rotor import study as rotor_study
from autobalancer.harness.scene import Scene

pytestmark = pytest.mark.slow


def disc(**changes):
    """A planar rotor whose every answer has a closed form: k/m = 1, zeta = c/(2 m)."""
    rotor = {"kind": "planar", "mass": 2.0, "stiffness": 2.0, "damping": 0.08,
             "unbalance": 0.01, "unbalance_angle": 0.5, **changes}  # fmt: skip
    return Scene.from_document({"rotor": rotor, "operation": {"speed": 1.5}})


@pytest.fixture
def drawn(monkeypatch):
    """Figures instead of files."""
    figures = []

    def keep(figure, path):
        figures.append(figure)
        return path

    monkeypatch.setattr(pictures, "save", keep)
    return figures


def texts(figure):
    """Everything a reader can read around the axes."""
    found = []
    for axes in figure.axes:
        found += [axes.get_xlabel(), axes.get_ylabel(), axes.get_title()]
    return found


def test_campbell_curves_meet_the_speed_line_at_the_critical_speeds(drawn):
    """Rodrigues' rotor: forward tilt mode Jt l^2 - Jp w l - k22 = 0 crosses l = w at 1.81."""
    scene = load_scene("two_plane_rodrigues")
    data, critical = rotor_study.campbell_of(scene, 0.02, 4.0)
    assert critical == pytest.approx([1.0, math.sqrt(9.0 / 2.75)])
    tilt = np.sort(np.abs(data.eigenvalues.imag), axis=1)
    w = data.speeds
    forward = (0.5 * w + np.sqrt((0.5 * w) ** 2 + 4 * 3.25 * 9.0)) / (2 * 3.25)
    np.testing.assert_allclose(tilt[:, -1], forward, rtol=1e-3)  # damping of 2 % shifts it by 4e-4
    pictures.plot_campbell(data, critical, "title", None)
    (figure,) = drawn
    marks = [line for line in figure.axes[0].lines if line.get_marker() == "o"]
    assert [float(line.get_xdata()[0]) for line in marks] == pytest.approx(critical.tolist())
    lines = [line.get_linestyle() for line in figure.axes[0].lines if len(line.get_xdata()) > 1]
    assert "--" in lines  # the backward mode
    assert figure.axes[0].get_ylabel().endswith("[rad/s]")
    assert "[1]" in figure.axes[1].get_ylabel()
    assert figure.axes[1].get_xlabel() == "speed [rad/s]"


def test_campbell_says_when_a_mode_changes_its_nature():
    """Internal damping makes a heavily damped disc oscillate at higher speeds only."""
    scene = disc(damping=[5.0, 3.0], internal_damping=1.0)
    with pytest.raises(UserError, match=r"0.1 to 9 rad/s: a mode is overdamped at some"):
        rotor_study.campbell_of(scene, 0.1, 9.0)


def test_response_of_the_unit_is_that_of_a_disc(drawn):
    """|A| = u w^2/|k - m w^2 + i c w|, lagging by atan2(c w, k - m w^2)."""
    data = rotor_study.response_of(disc(), 0.1, 3.0)
    exact = 0.01 * np.exp(0.5j) * data.points**2
    exact /= 2.0 - 2.0 * data.points**2 + 0.08j * data.points
    np.testing.assert_allclose(data.measured[:, 0, 0], exact, rtol=1e-7)
    np.testing.assert_allclose(data.measured[:, 1, 0], -1j * exact, rtol=1e-7)
    np.testing.assert_allclose(
        np.interp(data.points, data.speeds, np.abs(data.amplitude[:, 0, 0])), np.abs(exact),
        rtol=2e-2,
    )  # fmt: skip
    pictures.plot_response(data, None)
    (figure,) = drawn
    assert len(figure.axes) == 2  # x and y alike: drawn once
    assert figure.axes[0].get_ylabel() == "amplitude, 0-peak [mm]"
    assert "[deg]" in figure.axes[1].get_ylabel()


def test_response_along_both_axes_is_drawn_where_they_differ(drawn):
    data = rotor_study.response_of(disc(stiffness=[2.0, 3.0]), 0.1, 3.0)
    pictures.plot_response(data, None)
    assert {axes.get_title() for axes in drawn[0].axes} >= {"along x", "along y"}


def test_response_needs_an_unbalance():
    with pytest.raises(UserError, match="has no unbalance to respond to"):
        rotor_study.response_of(disc(unbalance=0.0), 0.1, 3.0)


def test_run_up_passes_the_resonance_and_stays_below_its_steady_height(drawn):
    """Acceleration through a resonance: the peak comes late and is lower than u w/c."""
    data = rotor_study.run_up_of(disc(), 0.05, 3.0)
    speeds, displacement = data.run
    peak = int(np.argmax(displacement[:, 0]))
    assert 1.0 < speeds[peak] < 1.2
    assert displacement[peak, 0] < 0.01 * 1.0 / 0.08
    assert speeds[-1] == pytest.approx(3.0)
    # far above it the disc turns about its centre of mass
    assert displacement[-1, 0] == pytest.approx(0.005 / (1 - 1 / 9), rel=0.05)
    pictures.plot_run_up(data, None)
    assert drawn[0].axes[-1].get_xlabel().startswith("speed [rad/s]")
    assert drawn[0].axes[0].get_ylabel().endswith("0-peak [mm]")


def test_a_run_up_with_and_without_balancers_has_times_of_its_own_each(drawn):
    data = rotor_study.run_up_of(load_scene("run_up"), 20.0, 60.0)
    assert len(data.run[0]) != len(data.alone[0])
    pictures.plot_run_up(data, None)
    for axes, (speeds, _) in zip(drawn[0].axes, (data.run, data.alone), strict=True):
        np.testing.assert_array_equal(axes.lines[0].get_xdata(), speeds)


def test_the_larger_peak_of_a_run_up_is_within_the_picture_wherever_it_is(drawn):
    data = rotor_study.run_up_of(load_scene("run_up"), 20.0, 60.0)
    smaller = (data.run[0], 0.1 * data.run[1])
    pictures.plot_run_up(replace(data, run=smaller), None)
    top = max(line.get_ydata().max() for line in drawn[0].axes[1].lines[: len(data.stations)])
    assert all(axes.get_ylim()[1] > top and axes.get_ylim()[0] == 0.0 for axes in drawn[0].axes)


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
    ],
)
def test_command_refuses_what_it_cannot_draw(invoke, options, message):
    done = invoke("rotor", "two_balls", *options)
    assert done.exit_code == 2
    assert message in done.output
