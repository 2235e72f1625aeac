"""FMI 3.0: the same units behind another front."""

from __future__ import annotations

import ctypes

import pytest

pytestmark = pytest.mark.slow

BALLS, ROTOR = "BallBalancer", "RotorOnSupports"


@pytest.fixture
def host(fmus, packaging):
    """A unit of FMI 3.0 that has begun."""

    def make(unit: str, values: dict | None = None):
        return packaging.Host(fmus.native(unit, fmi=3)).begin(values)

    return make


def test_time_is_read_together_with_others(host):
    rotor = host(ROTOR)
    rotor.slave.doStep(0.0, 0.25)
    names = ["time", "mass", "speed", "time", "time", "angle"]
    assert rotor.get(*names) == [0.25, 2.0, 300.0, 0.25, 0.25, pytest.approx(75.0)]
    assert rotor.get("time") == [0.25]


def test_references_are_unique_over_all_types(host):
    balls = host(BALLS, {"inertia_as_force": True})
    (reference,) = balls.references("inertia_as_force")
    assert balls.slave.getBoolean([reference]) == [True]
    wrong = f"value references [0]: unknown, there are {reference} to {reference + 1}"
    assert wrong in balls.refused(lambda: balls.slave.getBoolean([0]))
    text = balls.refused(lambda: balls.slave.getFloat64([reference]))
    assert f"value references [{reference}]: unknown" in text
    text = balls.refused(lambda: balls.slave.setBoolean([reference], [False]))
    assert "inertia_as_force: fixed once initialisation has ended" in text
    time = balls.references("time")
    assert "unknown" in balls.refused(lambda: balls.slave.setFloat64(time, [1.0]))


def test_state_and_derivatives(host):
    balls = host(BALLS, {"inertia_as_force": True})
    balls.set({"a_xi": 4.0, "der(a_xi)": 50.0})
    balls.slave.doStep(0.0, 1e-3)
    state = balls.slave.getFMUState()
    data = balls.slave.serializeFMUState(state)
    balls.slave.doStep(1e-3, 1e-3)
    expected = balls.outputs()
    balls.slave.setFMUState(balls.slave.deserializeFMUState(data))
    balls.slave.doStep(1e-3, 1e-3)
    assert balls.outputs() == expected
    slope = balls.slave.getOutputDerivatives(balls.references("F_xi"), [1])
    assert slope == balls.get("der(F_xi)")
    known, unknown = balls.references("a_xi"), balls.references("F_xi")
    (found,) = balls.slave.getDirectionalDerivative(unknown, known, [2.0])
    before = balls.get("a_xi", "F_xi")
    balls.set({"a_xi": before[0] + 2.0})
    after = balls.get("F_xi")[0]
    balls.set({"a_xi": before[0]})
    assert found == pytest.approx(after - balls.get("F_xi")[0], rel=1e-9)
    balls.slave.freeFMUState(state)
    assert not state.value


def test_other_interfaces_and_types_are_refused(fmus, packaging, host):
    rotor = host(ROTOR)
    dll = rotor.slave.dll
    component = rotor.slave.component
    for name in ("fmi3EnterStepMode", "fmi3EnterConfigurationMode"):
        before = len(rotor.messages)
        function = getattr(dll, name)
        function.argtypes = [ctypes.c_void_p]
        assert function(component) == 3
        assert f"{name}: the unit does not have this" in rotor.messages[before][1]
    for kind in ("Float32", "Int32", "UInt64", "String", "Clock"):
        function = getattr(dll, f"fmi3Get{kind}")
        function.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p,
                             ctypes.c_size_t]  # fmt: skip
        array = (ctypes.c_uint * 1)(0)
        values = (ctypes.c_double * 1)()
        before = len(rotor.messages)
        assert function(component, array, 1, values, 1) == 3
        assert "the unit has Reals and Booleans only" in rotor.messages[before][1]
    said = packaging.refusal(fmus.native(ROTOR, fmi=3), eventModeUsed=True)
    assert "neither event mode nor intermediate variables" in said


def test_a_failed_step_says_how_far_the_unit_is(host):
    balls = host(BALLS, {"a_xi": 1e300})
    text = balls.refused(lambda: balls.slave.doStep(0.0, 1.0))
    assert "the weights would need" in text
    assert balls.get("time") == [0.0]
    balls.set({"a_xi": 0.0})
    event, end, early, time = balls.slave.doStep(0.0, 1e-3)
    assert (event, end, early, time) == (False, False, False, 1e-3)
