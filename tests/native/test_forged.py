"""States and compositions from outside: refused, or harmless."""

from __future__ import annotations

import ctypes
import math
import struct
from contextlib import suppress

import pytest
from fmpy import platform_tuple
from fmpy.fmi1 import FMICallException

import autobalancer as ab
from autobalancer.harness import load_scene
from tests.native.packaging import Host
from tests.studies.forged import PHASE, VALUES, Found, study

STATES, COMPOSITIONS = 1000, 300


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Found]:
    folder = tmp_path_factory.mktemp("forged")
    return dict(study(folder, range(STATES), range(COMPOSITIONS)))


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["states", "compositions"])
def test_what_is_forged_is_refused_or_does_no_harm(found, kind):
    """A sample of what `python -m tests.studies.forged` looks at, under sanitizers."""
    assert found[kind].faults == []
    (counts,) = found[kind].counts
    assert "accepted 0" not in counts
    assert "refused 0" not in counts


def fnv(data: bytes) -> bytes:
    total = 0xCBF29CE484222325
    for byte in data:
        total = (total ^ byte) * 0x100000001B3 & 0xFFFFFFFFFFFFFFFF
    return total.to_bytes(8, "little")


@pytest.mark.parametrize("phase", [0, 3, 5, 16, -1])
def test_a_state_of_no_phase_is_refused(hosted, phase):
    """Of phase 0 a call out of order would look for the phase's name without end."""
    host = hosted(load_scene("two_balls"))
    host.step(0.01)
    data = bytearray(host.slave.serializeFMUState(host.slave.getFMUState()))
    assert struct.unpack_from("<i", data, PHASE) == (4,)
    struct.pack_into("<i", data, PHASE, phase)
    data[-8:] = fnv(bytes(data[:-8]))
    said = host.refused(lambda: host.slave.deserializeFMUState(bytes(data)))
    assert "the phase of the instance is none" in said


def test_a_restore_that_fails_leaves_the_instance_as_it_was(hosted):
    """Parameters that do not fit together are seen when the equations are made anew."""
    host = hosted(load_scene("two_balls"))
    host.step(0.01)
    state = host.slave.getFMUState()
    before = host.slave.serializeFMUState(state)
    data = bytearray(before)
    layout = host.description.modelVariables
    tolerance = next(v.valueReference for v in layout if v.name == "coupling.tolerance")
    struct.pack_into("<d", data, VALUES + 8 * int(tolerance), 0.0)
    data[-8:] = fnv(bytes(data[:-8]))
    forged = host.slave.deserializeFMUState(bytes(data))
    assert "must be above 0 and at most 0.1" in host.refused(lambda: host.slave.setFMUState(forged))
    after = ctypes.c_void_p()
    host.slave.fmi2GetFMUstate(host.slave.component, ctypes.byref(after))
    assert host.slave.serializeFMUState(after) == before


SLOW = {"coupling.tolerance": 1e-5, "coupling.top_speed": 100.0}
SLOW |= {"speed": 0.0}


def test_a_speed_that_no_step_resolves_ends_with_a_message(hosted):
    """Its series has coefficients that are not finite; 1e284 looks in a step would never end."""
    host = hosted(load_scene("two_balls"), {"acceleration": 1e283} | SLOW)
    assert "too fast for the time to go on" in host.refused(lambda: host.step(0.001))


def test_a_speed_far_beyond_the_top_speed_takes_steps_of_bounded_turn(hosted):
    """Of a rotor that nothing moves a series says nothing about the length of a step."""
    still = {"rotor.unbalance": 0.0, "weights.drag": 0.0, "weights.angles": [0.0, math.pi]}
    host = hosted(load_scene("two_balls").replace(still), {"acceleration": 1e9} | SLOW)
    host.step(1e-2)
    turned = 0.5 * 1e9 * 1e-2**2
    (steps,) = host.get("coupling.steps")
    assert steps >= turned / 800.0


@pytest.mark.parametrize("start", ["station[1].x0", "station[2].vx0"])
def test_events_that_follow_each_other_too_closely_end_with_a_message(hosted, start):
    """Motion far beyond what dry friction can stop changes its way within rounding of the time."""
    host = hosted(load_scene("bristol_friction"), {f"rotor.{start}": 1e200})
    said = host.refused(lambda: [host.step(1e-3) for _ in range(5)])
    assert "events follow each other too closely" in said


def test_a_motion_that_would_take_years_to_follow_ends_with_a_message(hosted):
    """Balls at 1e14 rad/s: 3 million steps of the machine are 1e-8 s, and 1e-3 s are asked for.

    They are so light that they do not move the rotor, whose own speed has a bound.
    """
    start = {"balls.mass": 1e-12, "balls.drag": 0.0, "balls.weight[1].speed0": 1e14}
    host = hosted(load_scene("balls_and_liquid"), start)
    assert "the motion is too fast" in host.refused(lambda: host.step(1e-3))


def test_a_message_is_that_of_its_own_error(hosted):
    """What was refused before, and had nothing to do with it, is not said once more."""
    host = hosted(load_scene("bristol_friction"), {"rotor.station[1].x0": 1e200})
    host.refused(lambda: host.set({"rotor.station[1].mass": 1.0}))
    said = host.refused(lambda: [host.step(1e-3) for _ in range(5)])
    assert "events follow each other too closely" in said


def field_at(host, data: bytes, name: str) -> int:
    """Where a field lies in a serialised state: the message of a wrong value names it."""
    for at in range(VALUES, len(data) - 8, 8):
        changed = bytearray(data)
        struct.pack_into("<d", changed, at, 0.123)
        changed[-8:] = fnv(bytes(changed[:-8]))
        before = len(host.messages)
        with suppress(FMICallException):
            host.slave.deserializeFMUState(bytes(changed))
        if any(f"{name}[1] = 0.123" in text for _, text in host.messages[before:]):
            return at
    raise AssertionError(f"no field {name}")


def test_an_event_of_a_spring_that_the_machine_does_not_have_does_no_harm(hosted):
    rotor = {"stiffness": 1e4, "cubic_stiffness": -1e9, "damping": 10.0, "mass": 1.0}
    scene = ab.Scene(rotor=ab.Planar(**rotor), operation={"speed": 50.0}, run={"duration": 1.0})
    host = hosted(scene, {"rotor.x0": 1e-3})
    host.step(1e-2)
    data = bytearray(host.slave.serializeFMUState(host.slave.getFMUState()))
    event, which = (field_at(host, bytes(data), f"one_piece.{n}") for n in ("event", "which"))
    for number in (0.0, 1.0, 9e15):
        struct.pack_into("<d", data, event, 13.0)
        struct.pack_into("<d", data, which, number)
        data[-8:] = fnv(bytes(data[:-8]))
        with suppress(FMICallException):
            host.slave.setFMUState(host.slave.deserializeFMUState(bytes(data)))
            host.step(1e-2)
    assert "must be a whole number from 0" in host.messages[-1][1]


def test_a_state_whose_outputs_cannot_be_computed_says_why(hosted):
    """Of its step, whose speed is beyond the table of the bearings."""
    host = hosted(load_scene("small_turbine"))
    host.step(1e-4)
    data = bytearray(host.slave.serializeFMUState(host.slave.getFMUState()))
    before = 6 * 8  # the speed, in front of what is declared as `placed`
    struct.pack_into("<d", data, field_at(host, bytes(data), "one_piece.placed") - before, 1e5)
    data[-8:] = fnv(bytes(data[:-8]))
    host.slave.setFMUState(host.slave.deserializeFMUState(bytes(data)))
    said = host.refused(lambda: host.outputs())
    assert "speed = 100000 rad/s" in said
    assert "the speeds of the bearings' table" in said


def test_a_torque_of_a_state_beyond_its_table_is_refused_with_the_reason(tmp_path):
    """Nothing else is computed of a restored state before its torque, which is read first."""
    rows = [[speed, 1.0, 0.0, 0.0, 1.0, 0.1, 0.0, 0.0, 0.1] for speed in (0.0, 50.0)]
    rotor = {"kind": "planar", "mass": 1.0, "unbalance": 0.0, "bearings": [{"table": rows}]}
    scene = ab.Scene.from_document(
        {"rotor": rotor, "operation": {"speed": 40.0}, "run": {"duration": 1.0}}
    )
    found = scene.build(tmp_path, platforms=[platform_tuple]).files
    host = Host(next(path for path in found if path.stem == "rotor")).begin()
    host.step(1e-3)
    host.get("torque")
    data = bytearray(host.slave.serializeFMUState(host.slave.getFMUState()))
    speed = int(host.variables["speed"].valueReference)
    assert struct.unpack_from("<d", data, VALUES + 8 * speed) == (40.0,)
    struct.pack_into("<d", data, VALUES + 8 * speed, 60.0)
    data[-8:] = fnv(bytes(data[:-8]))
    host.slave.setFMUState(host.slave.deserializeFMUState(bytes(data)))
    said = host.refused(lambda: host.get("torque"))
    assert "speed = 60" in said
    assert "the speeds of the bearings' table" in said
