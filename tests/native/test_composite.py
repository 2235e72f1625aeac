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
from autobalancer.fmus.native.build.layout import hashed
from autobalancer.fmus.xml.archive import unzipped, zipped
from autobalancer.harness import Scene, bundled_scenes, cosimulate, load_scene
from autobalancer.harness.export.one_file import build_one_file
from autobalancer.harness.master.cosimulation import CoSimulation
from autobalancer.harness.master.schedule import at_fixed_steps

RANGE = 1e-11  # of a signal's range
# where weights collide: the last digits of a start angle move their signals by 1e-9
RANGE_MET = 1e-7  # an impact reaches the rotor as a pulse of separate units


def turning(scene: Scene, parts: int, revolutions: float) -> np.ndarray:
    """Times that divide every revolution."""
    count = round(parts * revolutions)
    return np.arange(count + 1) * (2.0 * math.pi / scene.profile().speed(0.0) / parts)


@pytest.mark.parametrize("name", bundled_scenes())
def test_a_scene_moves_as_separate_units_coupled_in_python(hosted, name):
    """In a run, and in a host; the host's steps end where a run-up does by chance alone.

    Where there are events, which separate units step over, or a motor, which they do not have, the
    host is compared with the run.
    """
    scene = at_fixed_steps(load_scene(name))
    run_up = scene.operation.run_up is not None
    scene = scene.replace({} if run_up else {"run.revolutions": 5})
    run = cosimulate(scene)
    alone = scene.has_events or scene.operation.motor
    expected = run if alone else cosimulate(scene, separate=True)
    names = list(expected.signals)
    motions = [np.column_stack(list(run.signals.values()))]
    if not run_up:
        host = hosted(scene)
        motions.append(host.driven(expected.time, names))
        assert host.get("coupling.steps") == [expected.steps]
    allowed = RANGE_MET if any(b.can_meet for b in scene.balancer) else RANGE
    for k, signal in enumerate(names):
        size = max(np.ptp(expected[signal]), 1e-3 * np.abs(expected[signal]).max())
        for found in motions:
            assert np.abs(found[:, k] - expected[signal]).max() <= allowed * size, signal
    facts = ["signal_units", "steps", "unconverged"]
    if allowed == RANGE:
        facts.append("passes")
    for fact in facts:
        assert getattr(run, fact) == getattr(expected, fact), fact
    assert run.time.tolist() == expected.time.tolist()


@pytest.mark.slow
@pytest.mark.parametrize("scheme", ["auto", "iterated"])
@pytest.mark.parametrize("name", ["two_plane_rodrigues", "liquid_heavy_force"])
def test_schemes_do_what_the_harness_does(hosted, name, scheme):
    """Loop gains of 0.04 and of 19."""
    changes = {"run.revolutions": 3, "coupling.scheme": scheme, "run.initial.angle": 0.7}
    scene = at_fixed_steps(load_scene(name)).replace(changes)
    with CoSimulation(scene) as cosim:
        cosim.start()
        gain = cosim.gain
    expected = cosimulate(scene, separate=True)
    names = list(expected.signals)
    host = hosted(scene)
    found = host.driven(expected.time, names)
    for k, signal in enumerate(names):
        allowed = RANGE * max(1e-3 * np.abs(expected[signal]).max(), np.ptp(expected[signal]))
        assert np.abs(found[:, k] - expected[signal]).max() <= allowed, signal
    assert host.get("coupling.loop_gain") == [pytest.approx(gain, rel=1e-9)]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["two_balls", "balls_and_liquid", "goncharov_balls"])
def test_the_steps_of_the_tool_do_not_matter(hosted, name):
    """At 5, 7.5 and 1,000 steps per revolution outputs have the same bits as at the scene's own."""
    scene = load_scene(name)
    names = [f"{b.label}.{v}" for b in scene.balancer for v in b.records]
    names += ["rotor.x", "rotor.vy", "rotor.plane[1].a_xi"]
    own = round(scene.coupling.steps_per_rev)
    runs = {}
    for parts in (own, 5, 7.5, 1000):
        found = hosted(scene).driven(turning(scene, parts, 2), names)
        runs[parts] = found[[0, -1]]
    for parts in (5, 7.5, 1000):
        assert runs[parts] == pytest.approx(runs[own], rel=1e-12, abs=1e-15), parts


def test_a_first_step_that_heavy_drag_divides_is_seen_as_it_is(hosted):
    """At its parts' ends with the harness's outputs, and in between."""
    changes = {"weights.drag": 1.0, "weights.speeds": [1.0, -2.0], "run.revolutions": 1}
    scene = at_fixed_steps(load_scene("two_balls")).replace(changes)
    names = ["rotor.plane[1].a_xi", "weights.F_xi", "rotor.vx", "weights.weight[1].angle"]
    expected = cosimulate(scene, record=names)
    times = np.linspace(0.0, expected.time[1], 12)
    fine = hosted(scene.replace({"coupling.steps_per_rev": 640})).driven(times, names)
    found = hosted(scene).driven(times, names)
    assert found[-1] == pytest.approx([expected[name][1] for name in names], rel=1e-9)
    assert (np.abs(found - fine).max(axis=0)[2:] <= 1e-3 * np.ptp(fine, axis=0)[2:]).all()


def test_between_the_ends_of_steps_the_order_is_four(hosted):
    """At 0.37 of the steps' spacing, against steps 16 times finer."""
    names = ["rotor.x", "rotor.y", "weights.weight[1].angle", "weights.F_xi"]
    runs = []
    for steps in (20, 40, 320):
        scene = load_scene("two_balls").replace({"coupling.steps_per_rev": steps})
        runs.append(hosted(scene).driven(turning(scene, 20 / 0.37, 5), names))
    coarse, fine = (np.abs(run - runs[2]).max(axis=0) / np.ptp(runs[2], axis=0) for run in runs[:2])
    assert (fine < 3e-6).all()
    assert (coarse > 10.0 * fine).all()


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
    scene = load_scene("two_balls").replace({"run.revolutions": 4})
    changed = scene.replace({"rotor.mass": 1.1, "weights.drag": 0.02, "operation.speed": 3.4})
    expected = cosimulate(changed)
    values = {"rotor.mass": 1.1, "weights.drag": 0.02, "speed": 3.4, "coupling.top_speed": 3.4}
    found = hosted(scene, values).driven(expected.time, ["rotor.x", "rotor.y"])
    for k, signal in enumerate(("rotor.x", "rotor.y")):
        assert found[:, k] == pytest.approx(expected[signal], abs=RANGE * np.ptp(expected[signal]))


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
    ("two_balls", {}),
    ("goncharov_balls", {}),  # isotropic
    ("two_balls", {"rotor.stiffness": [1e5, 1e7]}),  # too stiff for a series
    ("two_plane_rodrigues", {}),
    ("three_mass_shaft", {}),
]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "changes"), ROTORS)
def test_within_a_step_the_rotor_is_where_a_step_as_short_would_take_it(hosted, name, changes):
    """By a series there, by a matrix here; without balancers both are exact."""
    scene = load_scene(name).replace({"coupling.scheme": "auto", **changes}).without_balancers()
    names = [f"rotor.plane[1].{v}" for v in ("x", "y", "a_xi")] + ["der(rotor.plane[1].a_eta)"]
    runs = [
        hosted(scene.replace({"coupling.steps_per_rev": steps})).driven(
            turning(scene, 140, 2), names
        )
        for steps in (20, 140)
    ]
    size = np.abs(runs[1]).max(axis=0)
    assert (size > 0.0).all()
    assert (np.abs(runs[0] - runs[1]).max(axis=0) <= 1e-11 * size).all()


def test_a_liquid_shows_its_mass_and_the_mass_that_it_adds():
    """rho pi (r1^2 - r2^2) h, and rho pi r1^2 h (Dubovik 2006)."""
    scene = load_scene("liquid_disc").replace({"run.revolutions": 0.1})
    run = cosimulate(scene, record=["liquid.liquid_mass", "liquid.added_mass"])
    whole = 1000.0 * math.pi * 0.1**2 * 0.05
    assert run["liquid.added_mass"][-1] == pytest.approx(whole, rel=1e-12)
    assert run["liquid.liquid_mass"][-1] == pytest.approx(whole - 0.9**2 * whole, rel=1e-12)
