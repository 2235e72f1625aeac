"""Units in Python hold the scene's values, run what is in the file, and say what they cannot do."""

from __future__ import annotations

import numpy as np
import pytest
from fmpy import platform_tuple, read_model_description, simulate_fmu

from autobalancer.fmus.build import build
from autobalancer.fmus.present import is_present_build
from autobalancer.harness import SceneError, cosimulate, load_scene
from tests.native.packaging import Host


def starts(path):
    """Start values that the description says, by name."""
    variables = read_model_description(str(path)).modelVariables
    return {v.name: float(v.start) for v in variables if v.start not in (None, "true", "false")}


@pytest.mark.parametrize("name", ["two_balls", "three_mass_shaft", "drum"])
def test_python_units_have_the_start_values_of_the_native_ones(tmp_path, name):
    scene = load_scene(name)
    native = scene.build(tmp_path / "native", platforms=[platform_tuple]).files
    python = scene.build(tmp_path / "python", python=True).files
    assert [path.name for path in python] == [path.name for path in native]
    for ours, theirs in zip(python, native, strict=True):
        said = starts(ours)
        assert said == {k: v for k, v in starts(theirs).items() if k in said}
        held = Host(ours)
        assert dict(zip(said, held.get(*said), strict=True)) == said
        held.free()


def test_python_units_of_a_scene_run_in_the_master_as_built_ones_do(tmp_path):
    scene = load_scene("two_balls").replace({"coupling.units": "python", "run.revolutions": 2})
    scene.build(tmp_path, python=True)
    ready = cosimulate(scene, fmus=tmp_path)
    built = cosimulate(scene, separate=True)
    assert (ready["rotor.x"] == built["rotor.x"]).all()


def test_python_units_hold_other_values_for_other_scenes_in_one_process(tmp_path):
    """The same sources: instances read their values from their own folder, after a reset too."""
    paths = {}
    for mass in (0.5, 2.5):
        scene = load_scene("two_balls").replace({"rotor.mass": mass})
        paths[mass] = scene.build(tmp_path / str(mass), python=True).files[0]
    hosts = {mass: Host(path) for mass, path in paths.items()}
    for _ in range(2):
        for mass, host in hosts.items():
            assert host.get("mass") == [mass]
            host.begin()
            host.slave.reset()


@pytest.mark.parametrize(
    ("name", "refused"),
    [
        ("contact_order", r"balls.weight_radius = 0.025 m: must be 0.0 m in a Python unit"),
        ("bristol_friction", r"sliders = \d: must be 0 in a Python unit"),
        ("sommerfeld", "Motor: exists as a native unit only"),
        ("washing_machine", "operation.unbalance_changes: the unbalance of a Python unit is fixed"),
    ],
)
@pytest.mark.parametrize("ssp", [False, True])
def test_what_python_units_cannot_do_is_refused_by_name(tmp_path, name, refused, ssp):
    with pytest.raises(SceneError, match=refused if not ssp else rf"{refused}|SSP") as error:
        load_scene(name).build(tmp_path, python=True, ssp=ssp)
    assert name in str(error.value)
    assert list(tmp_path.iterdir()) == []


# -- edited units ----------------------------------------------------------------------------------


def halved(name, content):
    """A Python rotor whose motion is half of what it was."""
    if name.endswith("fmus/rotor/slave.py"):
        line = b"motion, planes = self._propagate(step)"
        assert content.count(line) == 1
        content = content.replace(line, line + b"; motion = 0.5 * motion")
    return name, content


def moved(path):
    values = {"speed": 100.0}
    run = simulate_fmu(
        str(path), stop_time=0.05, output_interval=0.01, output=["x"], start_values=values
    )
    return run["x"]


def test_an_edited_unit_runs_what_it_says_beside_the_original(tmp_path, rewritten):
    path = build("RotorOnSupports", tmp_path, backend="python")
    edited = rewritten(path, tmp_path / "edited.fmu", halved)
    before = moved(path)
    other = moved(edited)
    assert np.abs(other).max() < 0.8 * np.abs(before).max()
    assert (moved(path) == before).all()
    assert (moved(edited) == other).all()


def test_a_state_of_an_edited_unit_is_none_of_the_original(tmp_path, rewritten):
    path = build("RotorOnSupports", tmp_path, backend="python")
    edited = rewritten(path, tmp_path / "edited.fmu", halved)
    first, other = Host(path).begin(), Host(edited).begin()
    state = first.slave.serializeFMUState(first.slave.getFMUState())
    found = other.slave.deserializeFMUState(state)
    assert "the state belongs to" in other.refused(lambda: other.slave.setFMUState(found))


def test_the_master_runs_an_edited_unit_and_says_which_file_was_changed(tmp_path, rewritten):
    scene = load_scene("two_balls").replace({"coupling.units": "python", "run.revolutions": 1})
    scene = scene.replace({"coupling.steps_per_rev": 20})
    rotor, _ = scene.build(tmp_path, python=True).files
    before = cosimulate(scene, fmus=tmp_path)
    assert is_present_build(rotor, "RotorOnSupports")
    rewritten(rotor, tmp_path / "edited.zip", halved).replace(rotor)
    assert not is_present_build(rotor, "RotorOnSupports")
    after = cosimulate(scene, fmus=tmp_path)
    assert np.abs(after["rotor.x"]).max() < 0.8 * np.abs(before["rotor.x"]).max()
    said = " ".join(after.events)
    assert "rotor.fmu is not of this installation (changed: " in said
    assert "rotor/slave.py)" in said


def test_an_fmu_is_no_scene_and_the_message_says_what_runs_it(tmp_path):
    rotor, _ = load_scene("two_balls").build(tmp_path, platforms=[platform_tuple]).files
    with pytest.raises(SceneError, match=r"rotor\.fmu: is an FMU.*autobalancer run FILE\.fmu"):
        load_scene(rotor)


# -- communication points --------------------------------------------------------------------------


def test_a_step_from_elsewhere_or_beyond_the_stop_time_is_refused(fmus, backend):
    host = Host(getattr(fmus, backend)("RotorOnSupports"))
    host.slave.setupExperiment(startTime=1.0, stopTime=2.0)
    host.slave.enterInitializationMode()
    host.slave.exitInitializationMode()
    host.slave.doStep(1.0, 0.5)
    wrong = host.refused(lambda: host.slave.doStep(1.4, 0.1))
    assert "communication point = 1.4 s: must be where the unit is, 1.5 s" in wrong
    late = host.refused(lambda: host.slave.doStep(1.5, 0.6))
    assert "must not be beyond the stop time, 2.0 s" in late
    host.slave.doStep(1.5 + 1e-9, 0.5)  # the rounding of a host
