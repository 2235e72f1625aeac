"""Steps that the composite chooses by a tolerance."""

from __future__ import annotations

import math

import numpy as np
import pytest
from fmpy import platform_tuple

from autobalancer.harness import Scene, cosimulate, load_scene
from autobalancer.harness.export.one_file import build_one_file
from autobalancer.harness.master.one_file import composition


def loose(name: str, tolerance: float, revolutions: float) -> Scene:
    changes = {"coupling.corrections": None, "coupling.scheme": "auto"}
    changes |= {"coupling.tolerance": tolerance, "run.revolutions": revolutions}
    return load_scene(name).replace(changes)


@pytest.mark.slow
@pytest.mark.parametrize("parts", [5, 20, 1000])
@pytest.mark.parametrize("tolerance", [1e-3, 1e-5])
def test_the_tool_may_ask_as_often_as_it_likes(instance, parts, tolerance):
    """Within the tolerance of a run at a hundredth of it, at every point that is asked for."""
    runs = []
    for allowed in (tolerance, 1e-2 * tolerance):
        host = instance(loose("two_balls", allowed, 1)).begin()
        rows = []
        for _ in range(3 * parts):
            host.step(2.0 * math.pi / 3.0 / parts)
            rows.append(host.get("rotor.x", "rotor.y", "weights.moment_xi", "weights.moment_eta"))
        runs.append(np.array(rows))
    assert np.abs(runs[0] - runs[1]).max() <= tolerance * np.abs(runs[1]).max()


@pytest.mark.parametrize("coupling", [{}, {"steps_per_rev": 20}, {"scheme": "iterated"}])
@pytest.mark.parametrize("name", ["two_balls", "finite_weights"])
def test_a_file_has_the_tolerance_that_a_run_keeps(name, coupling):
    """The default where the scene gives none: steps are of separate FMUs."""
    document = {**load_scene(name).document, "coupling": coupling}
    start = composition(Scene.from_document(document)).start
    assert start["coupling.tolerance"] == 1e-4
    assert "coupling.steps_per_rev" not in start


FLUNG = {
    "rotor": {"kind": "planar", "mass": 1.0, "stiffness": 1e3, "damping": 20.0, "unbalance": 0.01},
    "balancer": [
        {"kind": "pendulums", "count": 1, "mass": 20.0, "track_radius": 0.1, "angles": [1.95],
         "speeds": [148.6]}
    ],
    "operation": {"speed": 20.0},
    "run": {"revolutions": 1.0},
}  # fmt: skip


def test_steps_are_taken_again_that_a_unit_cannot_follow(instance):
    """A pendulum of twenty times the rotor's mass flings it about: masses turn round."""
    names = ("rotor.x", "rotor.y", "pendulums.moment_xi", "pendulums.moment_eta")
    runs = []
    for tolerance in (1e-2, 1e-6):
        host = instance(Scene.from_document(FLUNG | {"coupling": {"tolerance": tolerance}})).begin()
        rows = []
        for _ in range(100):
            host.step(2.0 * math.pi / 20.0 / 100.0)
            rows.append(host.get(*names))
        runs.append(np.array(rows))
    sizes = np.abs(runs[1]).max(axis=0)
    assert (np.abs(runs[0] - runs[1]).max(axis=0) < 0.05 * sizes).all()


def test_what_is_read_beside_an_output_does_not_change_it():
    """A clearance follows from a place; with a force beside it the machine is expanded anew."""
    keys = {"coupling.steps_per_rev": None, "coupling.tolerance": 1e-5, "run.revolutions": 10}
    scene = load_scene("balls_and_liquid").replace(keys)
    names = ["rotor.x", "liquid.clearance"]
    alone = cosimulate(scene, record=names)
    beside = cosimulate(scene, record=[*names, "balls.F_xi"])
    assert alone["liquid.clearance"].tolist() == beside["liquid.clearance"].tolist()
    assert np.ptp(alone["liquid.clearance"]) > 1e-3


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6])
@pytest.mark.parametrize("name", ["two_balls", "run_up", "three_mass_shaft", "goncharov_balls"])
def test_the_stated_error_of_a_run_so_far_covers_its_error(instance, name, tolerance):
    """Against the same file with steps that err by rounding, within three times at every look."""
    scene = loose(name, tolerance, 20)
    names = [f"rotor.{each}" for each in ("x", "y")] if len(scene.rotor.stations) == 1 else [
        f"rotor.station[{k + 1}].{axis}" for k in range(len(scene.rotor.stations)) for axis in "xy"
    ]  # fmt: skip
    length = scene.profile().time_of(math.tau * 20) / 40
    hosts = [instance(each).begin() for each in (scene, loose(name, 1e-12, 20))]
    rows, stated = ([], []), []
    for _ in range(40):
        for host, found in zip(hosts, rows, strict=True):
            host.step(length)
            found.append(host.get(*names))
        stated.append(hosts[0].get("coupling.error")[0])
    given, right = (np.array(each) for each in rows)
    error = np.abs(given - right).max(axis=1) / np.abs(right).max()
    assert (error <= 3.0 * np.array(stated) + 1e-12).all()
    assert np.all(np.diff(stated) >= 0.0)
    assert 0.0 < stated[-1] < tolerance


@pytest.mark.parametrize("fmi", [2, 3])
def test_the_tolerance_of_the_experiment_counts_though_outputs_were_read_before(
    packaging, tmp_path, fmi
):
    path = build_one_file(load_scene("two_balls"), tmp_path / "one.fmu", fmi, [platform_tuple])
    host = packaging.Host(path)
    host.get("rotor.x")
    if fmi == 2:
        host.slave.setupExperiment(tolerance=1e-3)
        host.slave.enterInitializationMode()
    else:
        host.slave.enterInitializationMode(tolerance=1e-3)
    host.slave.exitInitializationMode()
    assert host.get("coupling.tolerance") == [1e-3]
