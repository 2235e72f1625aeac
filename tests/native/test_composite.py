"""The composite: what the harness couples out of separate units, inside one FMU."""

from __future__ import annotations

import math

import fmpy
import numpy as np
import pytest
from fmpy import platform_tuple, simulate_fmu
from fmpy.validation import validate_fmu
from scipy.interpolate import CubicSpline

from autobalancer.fmus.composite.build import COMPOSITION
from autobalancer.fmus.native.build.compile import stamp
from autobalancer.fmus.native.build.tokens import hashed
from autobalancer.fmus.xml.archive import unzipped, zipped
from autobalancer.harness import Scene, bundled_scenes, cosimulate, load_scene
from autobalancer.harness.export.one_file import build_one_file

RANGE = 1e-11  # of a signal's range: rounding
COUPLED = 1e-6  # tolerance of separate FMUs, of which a run of them keeps a tenth to all
KEPT = 1e-5  # of a signal's range: what both may differ by


def turning(scene: Scene, parts: int, revolutions: float) -> np.ndarray:
    """Times that divide every revolution."""
    count = round(parts * revolutions)
    return np.arange(count + 1) * (2.0 * math.pi / scene.profile().speed(0.0) / parts)


@pytest.mark.parametrize("name", bundled_scenes())
def test_a_host_sees_what_a_run_records(hosted, name):
    """At any times of the host: steps of the machine are its own."""
    scene = load_scene(name).replace({"coupling.scheme": "auto", "coupling.tolerance": 1e-8})
    run_up = scene.operation.run_up is not None
    scene = scene.replace({} if run_up else {"run.revolutions": 3})
    run = cosimulate(scene)
    names = list(run.signals)
    found = hosted(scene).driven(run.time[::7], names)
    for k, signal in enumerate(names):
        size = max(np.ptp(run[signal]), 1e-3 * np.abs(run[signal]).max())
        assert np.abs(found[:, k] - run[signal][::7]).max() <= 1e-6 * size, signal


SMOOTH = [
    *("two_balls", "run_up", "two_plane_rodrigues", "three_mass_shaft", "balls_and_liquid"),
    *("liquid_heavy_force", "filimonikhina"),
]


@pytest.mark.slow
@pytest.mark.parametrize("name", SMOOTH)
def test_a_machine_moves_as_separate_units_coupled_in_python(hosted, name):
    """Two engines, which share equations of the parts alone."""
    scene = load_scene(name).replace({"coupling.scheme": "auto", "coupling.tolerance": COUPLED})
    changes = {"run.duration": 0.2} if scene.operation.run_up else {"run.revolutions": 2}
    scene = scene.replace(changes)
    coupled = cosimulate(scene, separate=True)
    names = [signal for signal in coupled.signals if not signal.endswith("clearance")]
    host = hosted(scene.replace({"coupling.tolerance": 1e-9}))
    expected = host.driven(coupled.time, names)
    for k, signal in enumerate(names):
        size = max(np.ptp(expected[:, k]), 1e-3 * np.abs(expected[:, k]).max())
        assert np.abs(coupled[signal] - expected[:, k]).max() <= KEPT * size, signal


@pytest.mark.slow
@pytest.mark.parametrize("name", ["two_balls", "balls_and_liquid", "goncharov_balls"])
def test_the_steps_of_the_tool_do_not_matter(hosted, name):
    """At 5, 7.5 and 1,000 steps per revolution outputs have the same bits as at the scene's own."""
    scene = load_scene(name)
    names = [f"{b.label}.{v}" for b in scene.balancer for v in b.records]
    names += ["rotor.x", "rotor.vy", "rotor.plane[1].a_xi"]
    own = 20
    runs = {}
    for parts in (own, 5, 7.5, 1000):
        found = hosted(scene).driven(turning(scene, parts, 2), names)
        runs[parts] = found[[0, -1]]
    for parts in (5, 7.5, 1000):
        assert runs[parts] == pytest.approx(runs[own], rel=1e-12, abs=1e-15), parts


def test_a_state_within_a_step_is_everything(state_is_everything):
    scene = load_scene("balls_and_liquid")
    names = ["rotor.x", "balls.weight[2].angle", "liquid.clearance", "coupling.steps"]
    state_is_everything(scene, {"balls.drag": 0.1}, turning(scene, 7.3, 8), names)


@pytest.mark.slow
@pytest.mark.parametrize("fmi", [2, 3])
def test_fmpy_finds_nothing_wrong_and_simulates_it(tmp_path, fmi):
    """With the harness's own motion, asked for at 37 points per revolution."""
    scene = load_scene("balls_and_liquid").replace({"run.revolutions": 2})
    path = build_one_file(scene, tmp_path / "one.fmu", fmi, [platform_tuple])
    assert not validate_fmu(str(path))
    period = 2.0 * math.pi / scene.profile().speed(0.0)
    expected = cosimulate(scene)
    rows = simulate_fmu(
        str(path), stop_time=2.0 * period, output_interval=period / 37, output=["rotor.x"]
    )
    error = rows["rotor.x"] - CubicSpline(expected.time, expected["rotor.x"])(rows["time"])
    assert len(rows) == 75
    assert np.abs(error).max() < 1e-4 * np.ptp(expected["rotor.x"])


def test_parameters_and_speed_are_those_that_are_set(hosted):
    """As a scene with them, though the file was built for another."""
    keys = {"coupling.scheme": "auto", "coupling.tolerance": 1e-8, "run.revolutions": 4}
    scene = load_scene("two_balls").replace(keys)
    changed = scene.replace({"rotor.mass": 1.1, "weights.drag": 0.02, "operation.speed": 3.4})
    expected = cosimulate(changed)
    values = {"rotor.mass": 1.1, "weights.drag": 0.02, "speed": 3.4, "coupling.top_speed": 3.4}
    found = hosted(scene, values).driven(expected.time, ["rotor.x", "rotor.y"])
    for k, signal in enumerate(("rotor.x", "rotor.y")):
        assert found[:, k] == pytest.approx(expected[signal], abs=1e-7 * np.ptp(expected[signal]))


OTHERS = {
    "damaged": (
        lambda text: text.replace("part=weights,1", "part=weighty,1"),
        "identity is Composite/",
    ),
    "missing": (lambda text: None, "cannot be opened"),
    "of other sources": (lambda text: text.replace(stamp(), 16 * "0"), "other sources"),
}


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("case", OTHERS)
def test_what_it_is_made_of_must_be_what_its_identity_says(packaging, tmp_path, fmi, case):
    change, said = OTHERS[case]
    path = build_one_file(
        load_scene("two_balls"), tmp_path / "one.fmu", fmi, platforms=[platform_tuple]
    )
    files = unzipped(path)
    old = files.pop(COMPOSITION).decode()
    new = change(old)
    if new is not None:
        files[COMPOSITION] = new.encode()
    if case == "of other sources":
        text = files["modelDescription.xml"].decode()
        files["modelDescription.xml"] = text.replace(hashed(old), hashed(new)).encode()
    path.write_bytes(zipped(files))
    assert said in packaging.refusal(path)


@pytest.mark.parametrize("fmi", [2, 3])
def test_the_folder_it_lies_in_may_have_any_name(tmp_path, fmi):
    """FMI 2.0 has it in percent signs, FMI 3.0 as it is."""
    path = build_one_file(
        load_scene("two_balls"), tmp_path / "one.fmu", fmi, platforms=[platform_tuple]
    )
    folder = tmp_path / "50 % größer, 100%41"
    fmpy.extract(str(path), str(folder))
    found = simulate_fmu(str(folder), stop_time=1.0, output=["rotor.x"])
    assert np.ptp(found["rotor.x"]) > 0.0


def test_its_identity_can_name_a_folder(tmp_path):
    """Tools do that: 255 characters are the most."""
    scene = load_scene("three_mass_shaft")
    path = build_one_file(scene, tmp_path / "one.fmu", platforms=[platform_tuple])
    guid = fmpy.read_model_description(str(path)).guid
    assert len(guid) < 40
    other = scene.replace({"run.initial.angle": 0.1})
    path = build_one_file(other, tmp_path / "other.fmu", platforms=[platform_tuple])
    assert guid != fmpy.read_model_description(str(path)).guid


ROTORS = [
    ("two_balls", {}, 1e-11),
    ("goncharov_balls", {}, 1e-11),  # isotropic
    ("two_balls", {"rotor.stiffness": [1e5, 1e7]}, 1e-9),  # along y it moves a hundredth
    ("two_plane_rodrigues", {}, 1e-11),
    ("three_mass_shaft", {}, 1e-11),
]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "changes", "rounding"), ROTORS)
def test_a_rotor_alone_is_right_to_rounding(hosted, name, changes, rounding):
    """By series here; the separate rotor steps by a matrix exponential, which is exact."""
    scene = load_scene(name).replace({"coupling.scheme": "auto", **changes}).without_balancers()
    names = [f"rotor.plane[1].{v}" for v in ("x", "y", "a_xi", "a_eta")]
    exact = cosimulate(scene.replace({"run.revolutions": 2}), record=names, separate=True)
    found = hosted(scene).driven(exact.time, names)
    for k, signal in enumerate(names):
        size = np.abs(exact[signal]).max()
        assert size > 0.0
        assert np.abs(found[:, k] - exact[signal]).max() <= rounding * size


def test_a_liquid_shows_its_mass_and_the_mass_that_it_adds():
    """rho pi (r1^2 - r2^2) h, and rho pi r1^2 h (Dubovik 2006)."""
    scene = load_scene("liquid_disc").replace({"run.revolutions": 0.1})
    run = cosimulate(scene, record=["liquid.liquid_mass", "liquid.added_mass"])
    whole = 1000.0 * math.pi * 0.1**2 * 0.05
    assert run["liquid.added_mass"][-1] == pytest.approx(whole, rel=1e-12)
    assert run["liquid.liquid_mass"][-1] == pytest.approx(whole - 0.9**2 * whole, rel=1e-12)


def test_a_float_that_touches_is_seen_whatever_is_recorded():
    """Steps in which a float cannot touch are not looked at where only places are recorded."""
    scene = load_scene("liquid_touch").replace({"run.revolutions": 2})
    few, all_of_it = cosimulate(scene, record=["rotor.x"]), cosimulate(scene)
    assert few.events == all_of_it.events
    assert any("touches the chamber" in str(event) for event in few.events)
