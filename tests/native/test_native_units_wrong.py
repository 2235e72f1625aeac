"""What native units refuse: in the Python units' words, with nothing changed."""

from __future__ import annotations

import math
import re
from functools import partial

import numpy as np
import pytest

pytestmark = pytest.mark.slow

ERROR = 3
LIQUID, BALLS, ROTOR = "LiquidBalancer", "BallBalancer", "RotorOnSupports"
TWO = {"kind": "two_support", "stations": 2, "planes": 1}
FLEXIBLE = {"kind": "flexible", "stations": 4, "planes": 1}
UNLIKE = {"weight_radius": 0.01, "weight[2].radius_ratio": 0.5, "weight[2].angle0": 0.2}
FEET = {"kind": "matrices", "stations": 2, "supports": 1, "feet": 1}


TOGETHER = [  # every value is allowed by itself
    (LIQUID, {}, {"float_radius": 0.05}, "float_radius = 0.05 m: must be smaller than"),
    (ROTOR, FLEXIBLE | {"stations": 2}, {"internal_damping": 1.0}, "supports only cannot bend"),
    (ROTOR, {}, {"stiffness_x": 1e308, "damping_x": 1e308}, "= nan m/s3: must be"),
    (BALLS, {}, {"weight_radius": 0.05}, "weight_radius = 0.05 m: such weights do"),
    (BALLS, {"weights": 3}, {"weight_radius": 0.049}, "the largest that fit have 0.0433013 m"),
    (BALLS, {}, {"restitution": 1.25}, "restitution = 1.25: must be within 0 to 1"),
    (BALLS, {}, {"track_mobility": 50.0}, "track_mobility = 50.0 1/kg: must be 0 or more and less"),
    (BALLS, {}, {"weight_radius": 0.01, "weight[2].angle0": 0.3}, "weights overlap by 0.103"),
    (BALLS, {"unequal": 1}, UNLIKE, "neighbours need 0.301137 rad"),
    (ROTOR, {"sliders": 1}, {"slider[1].support": 2.0}, r"slider[1].support = 2.0: must be 1"),
    (ROTOR, {"cubics": 1}, {"cubic[1].support": 1.5}, "cubic[1].support = 1.5: must be a whole"),
    (ROTOR, {"stops": 1}, {"stop[1].support": 0.5}, "stop[1].support = 0.5: must be a whole"),
    (ROTOR, TWO | {"sliders": 1}, {"slider[1].support": 1.5}, "support = 1.5: must be 1 or 2"),
    (ROTOR, FEET, {"force[2].table": 1.0}, "force[2].table = 1.0: must be a whole number, 0 to 0"),
    (ROTOR, {"sliders": 2}, {"slider[1].limit_x": 1.0, "slider[2].limit_x": 2.0},
     "sliders: two rigid ones at one support and axis are one with the sum of their limits"),
]  # fmt: skip


def reason_of(text: str) -> str:
    """What follows the instance, the time and what was attempted."""
    found = re.fullmatch(r"unit at t = [^ ]+ s: [^:]+: (.*)", text, re.S)
    assert found, text
    return found[1]


@pytest.mark.parametrize(("unit", "options", "values", "reason"), TOGETHER)
def test_parameters_that_do_not_fit_together_are_refused(
    fmus, packaging, unit, options, values, reason
):
    host = packaging.Host(fmus.native(unit, **options))
    assert reason in reason_of(host.refused(lambda: host.begin(values)))
    host.free()


def test_a_step_too_large_for_the_matrices_is_refused_as_in_python(fmus, packaging):
    said = []
    for path in (fmus.python(ROTOR), fmus.native(ROTOR)):
        host = packaging.Host(path).begin({"speed": 1e50})
        said.append(host.refused(lambda host=host: host.step(1e280)))
        host.free()
    assert said[1] == said[0]


@pytest.mark.parametrize("unit", [LIQUID, BALLS, ROTOR])
def test_every_limit_is_told_by_the_setter_and_changes_nothing(fmus, packaging, unit):
    """Name, value and what is allowed as the Python unit tells them, at once and for each."""
    options = {ROTOR: {"planes": 2}}.get(unit, {})
    layout = fmus.layout(unit, **options)
    host = packaging.Host(fmus.native(unit, **options)).begin()
    fresh = packaging.Host(fmus.native(unit, **options))
    for v in layout.reals[: layout.inputs.stop]:
        wrong = [math.nan, math.inf, -math.inf]
        if v.minimum is not None:
            wrong.append(v.minimum - 1e-3)
            if v.above:
                wrong.append(v.minimum)
        target = host if v.causality == "input" else fresh
        for value in wrong:
            before = target.get(v.name)
            text = target.refused(partial(target.set, {v.name: value}))
            assert reason_of(text) == v.problem(value)
            assert target.get(v.name) == before
    host.free()
    fresh.free()


def test_several_wrong_values_are_all_named_and_none_is_set(fmus, packaging):
    host = packaging.Host(fmus.native(ROTOR))
    names = ["mass", "stiffness_x", "unbalance_angle", "damping_x"]
    references = [host.variables[name].valueReference for name in names]
    before = host.get(*names)
    text = host.refused(lambda: host.slave.setReal(references, [-1.0, 5.0, math.nan, -2.5]))
    assert reason_of(text) == (
        "mass = -1.0 kg: must be a finite number above 0 kg; unbalance_angle = nan rad: must be a "
        "finite number; damping_x = -2.5 N.s/m: must be a finite number, at least 0 N.s/m"
    )
    assert host.get(*names) == before
    host.free()


@pytest.mark.parametrize(
    ("call", "reason"),
    [
        (lambda h: h.slave.setReal([0], [1.0]), "mass: fixed once initialisation has ended"),
        (lambda h: h.set({"plane[1].a_xi": 1.0}), "plane[1].a_xi: outputs cannot be set"),
        (lambda h: h.set({"bending": 1.0}), "bending: outputs cannot be set"),
        (lambda h: h.slave.getReal([0, 45, 46]), "value references [45, 46]: unknown, there are 0 "
         "to 44"),
        (lambda h: h.slave.setReal([99], [1.0]), "value references [99]: unknown, there are 0 to "
         "44"),
        (lambda h: h.slave.getBoolean([0]), "value references [0]: unknown, there are none"),
        (lambda h: h.slave.getInteger([0]), "the unit has Reals and Booleans only"),
        (lambda h: h.slave.setInteger([0], [1]), "the unit has Reals and Booleans only"),
        (lambda h: h.slave.getString([0]), "the unit has Reals and Booleans only"),
        (lambda h: h.slave.setString([0], ["a"]), "the unit has Reals and Booleans only"),
    ],
)  # fmt: skip
def test_access_that_is_not_allowed_while_running(fmus, packaging, call, reason):
    host = packaging.Host(fmus.native(ROTOR)).begin()
    assert reason_of(host.refused(lambda: call(host))) == reason
    host.step(1e-3)
    host.free()


@pytest.mark.parametrize("step", [0.0, -1e-3, math.nan, math.inf])
def test_a_step_must_go_forward(fmus, packaging, step):
    for path in (fmus.python(BALLS), fmus.native(BALLS)):
        host = packaging.Host(path).begin({"a_xi": 5.0})
        host.step(1e-3)
        before = host.outputs()
        text = host.refused(lambda host=host: host.slave.doStep(host.time, step))
        assert text == (
            f"unit at t = 0.001 s: step of {step:.6g} s failed: "
            f"communication step size = {step!r} s: must be above 0 s"
        )
        assert host.messages[-1][0] == ERROR
        assert host.outputs() == before
        host.free()


@pytest.mark.parametrize("point", [0.0, 2e-3, 1.1e-3, math.nan, -1.0])
def test_a_step_begins_where_the_unit_is(fmus, packaging, point):
    host = packaging.Host(fmus.native(BALLS)).begin({"a_xi": 5.0})
    host.step(1e-3)
    before = host.outputs()
    text = host.refused(lambda: host.slave.doStep(point, 1e-3))
    assert reason_of(text) == (
        f"communication point = {point!r} s: must be where the unit is, 0.001 s"
    )
    assert host.outputs() == before
    host.slave.doStep(np.nextafter(1e-3, 1.0), 1e-3)
    host.free()


def test_a_step_ends_at_the_stop_time_at_the_latest(fmus, packaging):
    host = packaging.Host(fmus.native(LIQUID))
    host.slave.setupExperiment(startTime=1.0, stopTime=1.3)
    host.slave.enterInitializationMode()
    host.slave.exitInitializationMode()
    for k in range(3):
        host.slave.doStep(1.0 + 0.1 * k, 0.1)  # sums of tenths are not exact
    text = host.refused(lambda: host.slave.doStep(1.3, 0.1))
    assert "step of 0.1 s failed: end of the step = 1.4 s" in text
    assert text.endswith("must not be beyond the stop time, 1.3 s")
    host.free()


@pytest.mark.parametrize(
    ("inputs", "step"),
    [
        ({"a_xi": 1e300}, 1.0),
        ({"a_xi": 1e9, "acceleration": 7.0}, 100.0),
    ],
)
def test_weights_that_cannot_be_moved_stay_where_they_are(fmus, packaging, inputs, step):
    said = []
    for path in (fmus.python(BALLS), fmus.native(BALLS)):
        host = packaging.Host(path).begin({"weight[1].angle0": 0.3})
        host.step(1e-3)
        before = host.get("weight[1].angle", "weight[2].speed")
        host.set(inputs)
        said.append(host.refused(lambda host=host: host.step(step)))
        assert host.messages[-1][0] == ERROR
        assert host.get("weight[1].angle", "weight[2].speed") == before
        host.set(dict.fromkeys(inputs, 0.0))
        host.step(1e-3)
        host.free()
    assert said[1] == said[0]


def test_one_weight_may_have_a_size(fmus, packaging):
    """It meets nobody."""
    packaging.Host(fmus.native(BALLS, weights=1)).begin({"weight_radius": 0.005}).free()


def test_the_float_that_touches_is_told_once(fmus, packaging):
    said = []
    for path in (fmus.python(LIQUID), fmus.native(LIQUID)):
        host = packaging.Host(path).begin()
        host.set({"x": 0.011, "y": -0.002})
        host.step(1e-3)
        host.step(1e-3)
        said.append([m for m in host.messages if m[0] == 1])
        host.free()
    assert said[1] == said[0]
    assert len(said[0]) == 1


@pytest.mark.parametrize("name", ["%s%n%x", "a#b", "Jörg [1] 100%", "x" * 5000, ""])
def test_a_name_is_no_format(fmus, packaging, name):
    host = packaging.Host(fmus.native(LIQUID), name)
    text = host.refused(lambda: host.set({"density": -1.0}))
    doubled = name.replace("%", "%%").replace("#", "##")  # as the logger's format wants it
    assert text.startswith(doubled[:2000])
    host.free()


OVERFLOWS = [
    ("power", {"speed0": 1e160}, 1e-200),
    ("angle", {"speed0": 1e308, "point[1].torque": 0.0}, 1e3),
]


@pytest.mark.parametrize(("output", "values", "step"), OVERFLOWS)
def test_an_output_that_overflows_is_an_error(fmus, packaging, output, values, step):
    host = packaging.Host(fmus.native("Motor", points=2)).begin(values)
    host.step(step)
    reason = reason_of(host.refused(lambda: host.get(output)))
    assert re.match(rf"{output} = -?(inf|nan) .*: is not finite", reason)
    host.free()
