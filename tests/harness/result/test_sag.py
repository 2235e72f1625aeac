"""Under gravity a run starts at rest in the sag, in every engine; pictures are counted from it."""

from __future__ import annotations

import fmpy
import numpy as np
import pytest
from fmpy import platform_tuple

from autobalancer.harness import Scene, cosimulate
from autobalancer.harness.export.build import build_files
from autobalancer.harness.export.one_file import build_one_file
from autobalancer.models.monolith import simulate

G, MASS, CARRIED = 9.81, 8.0, 3 * 0.05
LEVEL = {"stiffness": [20e3, 30e3], "damping": [80.0, 100.0]}
SAG = -(MASS + CARRIED) * G / 30e3  # M g/k with the balls' weight


def drum(unbalance: float = 0.0, **tables) -> Scene:
    """A horizontal drum; its balls are so light to move that nothing but gravity's pull counts."""
    ball = {"kind": "balls", "count": 3, "mass": 0.05, "track_radius": 0.2, "drag": 0.2}
    document = {
        "rotor": {"kind": "planar", "mass": MASS, **LEVEL, "unbalance": unbalance},
        "balancer": [ball],
        "operation": {"speed": 150.0, "gravity": G},
        "run": {"revolutions": 5},
    }
    return Scene(**{**document, **tables})


def alone(**changes) -> Scene:
    return drum(balancer=[]).replace(changes)


@pytest.mark.parametrize("form", ["one file", "separate", "python", "inertia as a force"])
def test_a_run_starts_in_the_sag_of_all_that_the_rotor_carries(form):
    scene = drum()
    if form == "python":
        scene = scene.replace({"coupling.units": "python", "run.revolutions": 1})
    if form == "inertia as a force":
        scene = scene.replace({"balls.inertia_as_force": True})
    run = cosimulate(scene, separate=form == "separate")
    assert run["rotor.y"][0] == pytest.approx(SAG, rel=1e-12)
    assert run["rotor.x"][0] == 0.0
    # balls that gravity swings shake the rotor by far less than a drop from y = 0 would
    assert np.abs(run["rotor.y"] - SAG).max() < 0.05 * abs(SAG)


@pytest.mark.parametrize("separate", [False, True])
def test_a_rotor_without_unbalance_stays_at_rest_where_it_starts(separate):
    run = cosimulate(alone(), separate=separate, record=["rotor.x", "rotor.y", "rotor.vy"])
    assert np.abs(run["rotor.y"] - run["rotor.y"][0]).max() < 1e-15
    assert run["rotor.y"][0] == pytest.approx(-MASS * G / 30e3, rel=1e-12)


def test_internal_damping_draws_the_sag_aside_and_the_rotor_stays_there():
    """(k - i w c_i) z = -i M g for equal supports."""
    changes = {"rotor.stiffness": 20e3, "rotor.damping": 80.0, "rotor.internal_damping": 30.0}
    run = cosimulate(alone(**changes))
    right = -1j * MASS * G / (20e3 - 1j * 150.0 * 30.0)
    z = run["rotor.x"] + 1j * run["rotor.y"]
    assert np.abs(z - right).max() < 1e-12 * abs(right)


def test_an_initial_displacement_is_counted_from_the_sag_and_an_integration_agrees():
    scene = drum(0.002).replace({"run.initial.x": 1e-3, "run.initial.y": 2e-3})
    run = cosimulate(scene.replace({"coupling.tolerance": 1e-7}))
    assert run["rotor.y"][0] == pytest.approx(SAG + 2e-3, rel=1e-12)
    initial = scene.run.initial.motion()
    right = simulate(scene.assembly(), scene.profile(), run.time, initial=initial, rtol=1e-11)
    assert np.abs(run["rotor.y"] - right.signal("rotor.y")).max() < 1e-6 * abs(SAG)


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
def test_a_built_machine_starts_in_the_sag(tmp_path, fmi, kind):
    path = build_one_file(drum(), tmp_path / "one.fmu", fmi, [platform_tuple])
    rows = fmpy.simulate_fmu(str(path), fmi_type=kind, stop_time=0.02, output=["rotor.y"])
    assert rows["rotor.y"][0] == pytest.approx(SAG, rel=1e-12)
    assert np.abs(rows["rotor.y"] - SAG).max() < 0.05 * abs(SAG)


def test_the_description_of_a_separate_unit_has_the_sag_as_its_start(tmp_path):
    build_files(drum(), tmp_path, platforms=[platform_tuple])
    described = [fmpy.read_model_description(str(path)) for path in tmp_path.glob("*.fmu")]
    (rotor,) = [each for each in described if each.modelName == "RotorOnSupports"]
    start = {v.name: v.start for v in rotor.modelVariables}
    assert float(start["y0"]) == pytest.approx(SAG, rel=1e-12)


def test_pictures_and_tables_show_the_displacement_from_the_sag():
    run = cosimulate(drum(0.002))
    (amplitudes,) = [panel for panel in run.plot().panels if panel.axes[1].log]
    assert amplitudes.axes[1].name == "displacement from the sag, 0-peak"
    assert amplitudes.lines[0].points[1][0] == amplitudes.axes[1].limits[0]  # 0 at the start
    assert run.plot_weights().panels[0].axes[1].name == "displacement from the sag, 0-peak"
    from autobalancer.harness.result.tables import as_json, summary

    rows = {row[0]: row for row in summary(run).rows}
    largest = max(np.abs(run["rotor.y"] - SAG))
    shown = max(abs(float(n)) for n in rows["rotor.y, from the sag"][2:4])
    assert shown == pytest.approx(largest, rel=1e-4)
    assert as_json(run)["sag"] == {"rotor.x": 0.0, "rotor.y": pytest.approx(SAG)}
    assert as_json(run)["signals"]["rotor.y"]["largest"] == run["rotor.y"].max()


def test_the_rise_of_a_heavy_rotor_is_drawn_from_its_sag():
    scene = alone(**{"rotor.unbalance": 1e-6})
    found = scene.rotor(20.0, 40.0)
    (panel,) = found.plot(kind="run-up").panels
    assert panel.axes[1].name.startswith("displacement from the sag")
    assert found.run_up().run[1].max() < 1e-3 * abs(SAG)
