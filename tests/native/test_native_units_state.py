"""State of native units: complete, and refused when it is damaged or another's."""

from __future__ import annotations

import ctypes
import struct

import pytest

from autobalancer.harness import load_scene
from autobalancer.harness.export.one_file import build_one_file

pytestmark = pytest.mark.slow

CASES = [
    ("LiquidBalancer", {}),
    ("BallBalancer", {"weights": 3}),
    ("RotorOnSupports", {"planes": 2}),
    ("RotorOnSupports", {"kind": "flexible", "stations": 3, "planes": 1}),
    ("RotorOnSupports", {"kind": "two_support", "stations": 2, "planes": 1, "sliders": 2}),
    ("Motor", {"points": 3}),
]
FRICTION = {"slider[1].limit_x": 0.5, "slider[2].limit_x": 0.4, "slider[2].stiffness_x": 2e5}
MOVED = {
    "Motor": {"torque": 3.0, "der(torque)": 20.0},
    "LiquidBalancer": {"a_xi": 3.0, "der(a_eta)": 20.0, "x": 1e-3},
    "BallBalancer": {"a_xi": 3.0, "der(a_eta)": 20.0, "acceleration": 2.0},
    "RotorOnSupports": {"plane[1].F_xi": 5.0, "der(plane[1].F_eta)": 40.0, "acceleration": 3.0},
}


def moving(fmus, packaging, case, steps: int = 5):
    unit, options = case
    host = packaging.Host(fmus.native(unit, **options))
    host.begin(FRICTION if "sliders" in options else {})
    host.set(MOVED[unit])
    for _ in range(steps):
        host.step(1e-3)
    return host


def run_on(host, steps: int = 4) -> list[list[float]]:
    seen = [host.outputs()]
    for k in range(steps):
        host.set({name: value * k for name, value in MOVED[host.unit].items()})
        seen.append(host.outputs())
        host.step(2e-3)
        seen.append(host.outputs())
    return seen


@pytest.mark.parametrize("case", CASES)
def test_a_state_is_everything(fmus, packaging, case):
    """The same bits after going back, from the same instance and in another one."""
    host = moving(fmus, packaging, case)
    host.unit = case[0]
    state, time = host.slave.getFMUState(), host.time
    expected = run_on(host)
    host.slave.setFMUState(state)
    host.time = time
    assert run_on(host) == expected
    data = host.slave.serializeFMUState(state)
    other = packaging.Host(fmus.native(case[0], **case[1]))
    other.unit = case[0]
    copy = other.slave.deserializeFMUState(data)
    other.slave.setFMUState(copy)
    other.time = time
    assert run_on(other) == expected
    for one, saved in ((host, state), (other, copy)):
        one.slave.freeFMUState(saved)
        one.free()


@pytest.mark.parametrize("case", CASES)
def test_a_state_from_before_the_start_brings_its_parameters(fmus, packaging, case):
    unit, options = case
    host = packaging.Host(fmus.native(unit, **options))
    name = host.description.modelVariables[0].name
    place = 0.04 if unit == "LiquidBalancer" else None
    host.slave.setupExperiment()
    host.slave.enterInitializationMode()
    before = host.slave.getFMUState()
    host.slave.exitInitializationMode()
    expected = host.outputs()
    host.slave.setFMUState(before)
    if place is None and name != "station[1].z":
        host.set({name: 5.0})
    host.slave.exitInitializationMode()
    changed = host.slave.getFMUState()
    host.slave.setFMUState(before)
    host.slave.exitInitializationMode()
    assert host.outputs() == expected
    host.slave.setFMUState(changed)
    assert (host.outputs() == expected) == (unit == "LiquidBalancer" or "station" in name)
    for state in (before, changed):
        host.slave.freeFMUState(state)
    host.free()


def test_a_saved_state_is_overwritten_in_place(fmus, packaging):
    host = moving(fmus, packaging, CASES[1])
    state = host.slave.getFMUState()
    address = state.value
    host.step(1e-3)
    expected = host.outputs()
    host.slave.fmi2GetFMUstate(host.slave.component, ctypes.byref(state))
    assert state.value == address
    host.step(1e-3)
    host.slave.setFMUState(state)
    assert host.outputs() == expected
    host.slave.freeFMUState(state)
    assert state.value is None
    host.slave.freeFMUState(state)  # nothing to free, and no harm
    host.free()


def test_a_state_of_another_unit_is_refused_and_changes_nothing(fmus, packaging):
    rotor, balls = moving(fmus, packaging, CASES[2]), moving(fmus, packaging, CASES[1])
    before = rotor.outputs()
    state = balls.slave.getFMUState()
    text = rotor.refused(lambda: rotor.slave.setFMUState(state))
    assert "the state belongs to 'BallBalancer/frame=rotor/weights=3/" in text
    assert "not to 'RotorOnSupports/frame=rotor/kind=planar/" in text
    data = balls.slave.serializeFMUState(state)
    assert "belongs to" in rotor.refused(lambda: rotor.slave.deserializeFMUState(data))
    assert rotor.outputs() == before
    balls.slave.freeFMUState(state)
    for host in (rotor, balls):
        host.free()


def fnv(data: bytes) -> bytes:
    total = 0xCBF29CE484222325
    for byte in data:
        total = (total ^ byte) * 0x100000001B3 & 0xFFFFFFFFFFFFFFFF
    return total.to_bytes(8, "little")


@pytest.mark.parametrize("time", [-1.0, 3.0, 1e9])
def test_a_time_that_is_not_that_of_the_coupled_units_is_refused(hosted, time):
    """A step from there would first have to reach it."""
    host = hosted(load_scene("two_balls"))
    for _ in range(4):
        host.step(0.3)
    data = bytearray(host.slave.serializeFMUState(host.slave.getFMUState()))
    at = data.index(struct.pack("<d", host.time))
    data[at : at + 8] = struct.pack("<d", time)
    data[-8:] = fnv(bytes(data[:-8]))
    host.slave.setFMUState(host.slave.deserializeFMUState(bytes(data)))
    assert "its motion stands at 1.2" in host.refused(lambda: host.slave.doStep(host.time, 0.3))


def test_a_state_of_one_file_brings_the_unbalance_of_its_time_back(packaging, tmp_path):
    """Restored at 0.15 s the rotor has the unbalance from before its change at 0.2 s."""
    changes = [{"time": 0.1, "amount": 1.0}, {"time": 0.2, "amount": 0.2}]
    scene = load_scene("two_balls").replace({"operation.unbalance_changes": changes})
    host = packaging.Host(build_one_file(scene, tmp_path / "changing.fmu"))
    host.begin({})
    moved = []
    for _ in range(15):
        host.step(0.01)
    state, time = host.slave.getFMUState(), host.time
    for _ in range(2):
        for _ in range(20):
            host.step(0.01)
        moved.append(host.outputs())
        host.slave.setFMUState(state)
        host.time = time
    host.slave.freeFMUState(state)
    host.free()
    assert moved[0] == moved[1]


def test_a_new_instance_that_begins_with_a_change_of_the_unbalance_has_the_same_bits(instance):
    """The step that the change ends is one with the unbalance before it."""
    change = {"operation.unbalance_changes": [{"time": 2e-3, "amount": 1.0}]}
    scene = load_scene("two_balls").replace(change)
    host, new = instance(scene).begin(), instance(scene)
    host.step(1e-3)
    state = host.slave.serializeFMUState(host.slave.getFMUState())
    new.slave.setFMUState(new.slave.deserializeFMUState(state))
    new.time = host.time
    host.step(3e-3)
    new.step(3e-3)
    assert new.outputs() == host.outputs()


@pytest.mark.parametrize("steps", [0, 3])
@pytest.mark.parametrize(
    "name", ["bristol_friction", "contact_order", "run_up", "small_turbine", "washing_machine_ring"]
)
def test_a_new_instance_goes_on_from_a_state_of_one_file_with_the_same_bits(instance, name, steps):
    """It has made no machine yet, and must know of dry friction and impacts at its first step."""
    host = instance(load_scene(name)).begin()
    new = instance(load_scene(name))
    for _ in range(steps):
        host.step(1e-3)
    state = host.slave.serializeFMUState(host.slave.getFMUState())
    new.slave.setFMUState(new.slave.deserializeFMUState(state))
    new.time = host.time
    for _ in range(3):
        host.step(1e-3)
        new.step(1e-3)
        assert new.outputs() == host.outputs()
