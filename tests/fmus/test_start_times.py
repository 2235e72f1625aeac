"""A run that starts at another time than 0 is the same run, shifted."""

from __future__ import annotations

import math

import fmpy
import numpy as np
import pytest
from fmpy import platform_tuple

from autobalancer.harness import Scene, load_scene
from tests.native.packaging import Host
from tests.studies.start_times import STARTS, Machine, Solver, study

CHANGING = {
    "operation.speed": None,
    "operation.profile": [[0.0, 0.0], [2.0, 20.0], [3.0, 20.0], [5.0, 0.0]],
    "operation.unbalance_changes": [{"time": 2.5, "amount": 2e-3, "angle": 1.0}],
    "run.revolutions": 60.0 / (2.0 * math.pi),
}


@pytest.mark.parametrize(
    ("scene", "fmi"), [("run_up", 2), ("run_up", 3), ("balls_and_liquid", 3), ("finite_weights", 2)]
)
def test_every_start_time_gives_the_same_result_shifted(scene, fmi):
    """The sample of `python -m tests.studies.start_times`."""
    short = {"run.revolutions": 20} if scene == "finite_weights" else {}
    rows = list(study([load_scene(scene).replace(short)], [fmi]))
    assert [row.start for row in rows] == list(STARTS)
    assert [row for row in rows if not row.holds] == []


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
def test_profile_and_changes_count_from_the_start_of_the_run(tmp_path, fmi, kind):
    scene = load_scene("two_balls").replace(CHANGING)
    path = scene.build(tmp_path, fmi=fmi, platforms=[platform_tuple], one_file=True).files[0]

    def speeds(start):
        run = fmpy.simulate_fmu(
            str(path),
            fmi_type=kind,
            start_time=start,
            stop_time=start + 6.0,
            output_interval=0.5,
            output=["rotor.speed", "rotor.x"],
        )
        rows = np.unique(np.round(2.0 * (run["time"] - start)), return_index=True)[1]
        return run["rotor.speed"][rows], run["rotor.x"][rows]

    speed, place = speeds(0.0)
    times = np.arange(13) / 2.0
    assert list(speed) == pytest.approx([scene.profile().speed(t) for t in times], abs=1e-9)
    for start in (-5.0, -2.5, 100.0):
        shifted, moved = speeds(start)
        assert list(shifted) == pytest.approx(list(speed), abs=1e-9)
        # the solver of a tool chooses its steps by its own times
        error = 1e-9 if kind == "CoSimulation" else 1e-2
        assert abs(moved - place).max() <= error * abs(place).max()


@pytest.mark.parametrize("time", [1.37, 0.9, 0.7, 1.1])
def test_a_time_event_is_passed_where_the_host_can_only_come_close(tmp_path, time):
    """Of 1e6 s + time the host knows 1e-10 s: it falls short of the event, or goes beyond."""
    changes = {**CHANGING, "operation.unbalance_changes": [{"time": time, "amount": 2e-3}]}
    scene = load_scene("two_balls").replace(changes)
    machine = Machine.of(scene, tmp_path, 2)
    solver = Solver(machine, 1e6)
    assert solver.next == 1e6 + time
    solver.step(1e6, solver.next - 1e6)
    solver.host.slave.enterEventMode()
    assert solver.event() == 1e6 + 2.0  # the corner of the profile


@pytest.mark.parametrize("name", ["RotorOnSupports", "BallBalancer"])
def test_a_separate_unit_knows_no_time_but_its_steps(fmus, backend, name):
    path = getattr(fmus, backend)(name)
    runs = []
    for start in (0.0, -5.0, 1e6):
        host = Host(path)
        host.slave.setupExperiment(startTime=start)
        host.slave.enterInitializationMode()
        signal = "plane[1].F" if name == "RotorOnSupports" else "a"
        host.set({"speed": 100.0, "acceleration": 20.0, f"{signal}_xi": 3.0})
        host.slave.exitInitializationMode()
        host.time = start
        runs.append(host.run(50))
        host.free()
    assert runs[0] == runs[1] == runs[2]


def test_messages_and_states_have_the_time_of_the_host(fmus):
    path = fmus.native("RotorOnSupports")
    host = Host(path)
    host.slave.setupExperiment(startTime=-5.0, stopTime=-4.0)
    host.slave.enterInitializationMode()
    host.slave.exitInitializationMode()
    host.time = -5.0
    host.step(0.5)
    assert "at t = -4.5 s" in host.refused(lambda: host.slave.doStep(0.0, 0.1))
    assert "stop time, -4.0 s" in host.refused(lambda: host.slave.doStep(-4.5, 0.6))
    kept = host.slave.serializeFMUState(host.slave.getFMUState())
    other = Host(path).begin()
    other.slave.setFMUState(other.slave.deserializeFMUState(kept))
    other.slave.doStep(-4.5, 0.5)


def test_a_restored_run_goes_on_with_its_profile(tmp_path):
    """Its start is part of the state: an instance that began at another time takes it over."""
    scene = load_scene("two_balls").replace(CHANGING)
    path = scene.build(tmp_path, platforms=[platform_tuple], one_file=True).files[0]
    first = Host(path)
    first.slave.setupExperiment(startTime=-5.0)
    first.slave.enterInitializationMode()
    first.slave.exitInitializationMode()
    first.time = -5.0
    first.step(1.5)
    kept = first.slave.serializeFMUState(first.slave.getFMUState())
    other = Host(path).begin()
    other.slave.setFMUState(other.slave.deserializeFMUState(kept))
    other.time = -3.5
    for host in (first, other):
        host.step(2.5)
    assert first.outputs() == other.outputs()
    assert first.get("rotor.speed") == [pytest.approx(10.0, rel=1e-12)]


def test_many_short_steps_do_not_move_a_corner(tmp_path):
    """The plain sum of 20,000 steps of 1e-5 s is off by 3e-13 of it, ours by a rounding."""
    scene = Scene.from_document(
        {
            "rotor": {"kind": "planar", "mass": 1.0, "stiffness": 1e4, "damping": 10.0},
            "operation": {"profile": [[0.0, 0.0], [0.1, 1e3], [1.0, 1e3]]},
            "run": {"revolutions": 100},
        }
    )
    path = scene.build(tmp_path, platforms=[platform_tuple], one_file=True).files[0]
    host = Host(path).begin()
    for k in range(20000):
        host.slave.doStep(k * 1e-5, 1e-5)
    angle = host.get("rotor.angle")[0]
    assert angle == pytest.approx(0.5 * 0.1 * 1e3 + 0.1 * 1e3, rel=1e-13)
