"""Each unit alone: right against closed forms and independent integration, and well behaved."""

from __future__ import annotations

import math
import re
from fractions import Fraction
from functools import partial

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import fmi2Discard, fmi2Error

from autobalancer.fmus.rotor.angle import TURN, turned

DISC = {
    "mass": 2.0,
    "stiffness_x": 8e4,
    "stiffness_y": 8e4,
    "damping_x": 40.0,
    "damping_y": 40.0,
    "internal_damping": 10.0,
    "unbalance": 2e-4,
}


@pytest.fixture
def rotor_of(probe):
    """A planar rotor with start values."""
    return partial(probe, "RotorOnSupports")


@pytest.fixture
def balls_of(probe):
    """Weights with start values."""
    return partial(probe, "BallBalancer")


def slope_error(unit, names, h=1e-4):
    """Largest relative difference of der(output) and the output's central difference."""
    state = unit.saved()
    slopes = np.array(unit.look(*(f"der({n})" for n in names)))
    ends = []
    for part in (1, 2, 3, 4):
        unit.restore(state)
        assert unit.do_step(0.0, h * part)
        ends.append(np.array(unit.look(*names)))
    unit.restore(state)
    begin = np.array(unit.look(*names))
    # one-sided difference of order 4
    change = (-25 * begin + 48 * ends[0] - 36 * ends[1] + 16 * ends[2] - 3 * ends[3]) / (12 * h)
    return np.abs(change - slopes).max() / np.abs(slopes).max()


@pytest.mark.parametrize("frame", ["rotor", "fixed"])
@pytest.mark.parametrize("spin_up", [0.0, 500.0])
def test_slope_outputs_are_the_outputs_derivatives(frame, spin_up, probe, rotor_of, balls_of):
    xi, eta = ("xi", "eta") if frame == "rotor" else ("x", "y")
    wavy = [3.0, 2.0, -40.0, 90.0, 3e3, -2e3, 1e4, 2e4]
    turning = {"speed": 120.0, "acceleration": spin_up}
    rotor = rotor_of({**DISC, **turning, "x0": 1e-4}, frame=frame)
    rotor.put(f"plane[1].F_{xi}", *wavy)
    assert slope_error(rotor, [f"plane[1].a_{xi}", f"plane[1].a_{eta}"]) < 2e-5
    for force in (False, True):
        balls = balls_of(
            {**turning, "inertia_as_force": force, "weight[1].speed0": 5.0, "angle": 0.4},
            frame=frame,
        )
        balls.put(f"a_{xi}", *wavy)
        # the angle input belongs to the start of the step, so the end of a step keeps its own
        assert slope_error(balls, [f"F_{xi}", f"F_{eta}"]) < 2e-5
        liquid = probe("LiquidBalancer", {"inertia_as_force": True}, frame=frame)
        liquid.put(f"a_{xi}", *wavy)
        assert slope_error(liquid, [f"F_{xi}", f"F_{eta}"]) < 1e-9
        ring = probe(
            "RingBalancer",
            {
                **turning,
                "inertia_as_force": force,
                "viscosity": 1e-4,
                "wave_xi0": 1e-3,
                "angle": 0.4,
            },
            frame=frame,
        )
        ring.put(f"a_{xi}", *wavy)
        assert slope_error(ring, [f"F_{xi}", f"F_{eta}"]) < 2e-5


def test_liquid_leaves_by_the_port_or_in_the_force_but_not_by_both(probe):
    added = 1000.0 * math.pi * 0.05**2 * 0.02
    for as_force in (False, True):
        unit = probe("LiquidBalancer", {"inertia_as_force": as_force}, frame="rotor")
        unit.put("a_xi", 3.0, -2.0, 10.0, 0.0)
        force = unit.look("F_xi", "F_eta", "der(F_xi)")
        assert force == pytest.approx([-3 * added, 2 * added, -10 * added] if as_force else [0] * 3)
        assert unit.look("added_mass")[0] == pytest.approx(0.0 if as_force else added)
        mass = 1000.0 * math.pi * (0.05**2 - 0.04**2) * 0.02
        assert unit.look("liquid_mass")[0] == pytest.approx(mass)


def test_several_planes_of_the_disc_add_up(rotor_of):
    one = rotor_of({**DISC, "plane[1].added_mass": 0.5})
    two = rotor_of({**DISC, "plane[1].added_mass": 0.2, "plane[2].added_mass": 0.3}, planes=2)
    one.put("plane[1].F_xi", 3.0, 1.0)
    two.put("plane[1].F_xi", 2.0, 0.25, 1.0, 0.75)
    for unit in (one, two):
        assert unit.do_step(0.0, 1e-3)
    assert two.look("x", "y", "plane[2].a_xi") == pytest.approx(
        one.look("x", "y", "plane[1].a_xi"), rel=1e-12
    )


def test_angle_keeps_its_digits_over_ten_million_turns():
    angle, by, count = [0.0, 0.0, 0.0], 0.3 * TURN * 1e4, 3333
    for _ in range(count):
        angle = turned(angle, by)
    pi = Fraction("3.14159265358979323846264338327950288419716939937510")
    exact = Fraction(by) * count
    whole = round(exact / (2 * pi))
    assert angle[0] == whole
    assert angle[1] == pytest.approx(float(exact - whole * 2 * pi), abs=2e-15)


def test_outputs_follow_inputs_set_during_initialisation(rotor_of):
    """A rotor in the middle, at rest: a = F/m + U w^2/m, at once and after every change."""
    unit = rotor_of(begin=False)
    unit.put("speed", 10.0)
    for mass, force in ((2.0, 0.0), (4.0, 8.0), (4.0, 6.0)):
        unit.put("mass", mass)
        unit.put("plane[1].F_xi", force)
        assert unit.look("plane[1].a_xi")[0] == pytest.approx((force + 2e-4 * 100.0) / mass)


@pytest.mark.parametrize("unit", ["RotorOnSupports", "LiquidBalancer", "BallBalancer"])
def test_unit_runs_alone_with_an_input_file(fmus, unit, backend):
    path = str(getattr(fmus, backend)(unit))
    name = {"RotorOnSupports": "plane[1].F_xi", "BallBalancer": "a_eta"}.get(unit, "a_xi")
    samples = np.array([(0.0, 0.0), (0.05, 2.0), (0.1, -2.0)], dtype=[("time", "f8"), (name, "f8")])
    starts = {"inertia_as_force": True} if unit == "LiquidBalancer" else {}
    output = {"RotorOnSupports": "x", "BallBalancer": "weight[1].angle"}.get(unit, "F_xi")
    run = fmpy.simulate_fmu(
        path,
        stop_time=0.1,
        step_size=1e-3,
        output_interval=1e-3,
        input=samples,
        start_values=starts,
        output=[output, name],
    )
    assert len(run) == 101
    assert np.isfinite(run[output]).all()
    assert np.ptp(run[output]) > 0.0
    if unit == "LiquidBalancer":
        added = 1000.0 * math.pi * 0.05**2 * 0.02
        # fmpy holds the input over a step
        held = np.interp(run["time"][:-1], samples["time"], samples[name])
        assert run[output][1:] == pytest.approx(-added * held, abs=1e-12)


PERTURBED = {
    "RotorOnSupports": {"plane[1].F_xi": 3.0, "der(plane[1].F_eta)": 20.0, "x0": 1e-4},
    "LiquidBalancer": {"a_xi": 3.0, "x": 1e-3, "chamber_radius": 0.06},
    "RingBalancer": {"a_xi": 3.0, "der(a_eta)": 20.0, "wave_speed_xi0": 0.3},
    "BallBalancer": {"a_xi": 3.0, "der(a_eta)": 20.0, "weight[1].speed0": 3.0},
}


@pytest.mark.parametrize("unit", PERTURBED)
def test_restored_state_of_a_python_unit_continues_bit_by_bit(unit, host_of):
    """Of native units: `tests/native/test_native_units_state.py`."""
    host = host_of(unit, "python").begin(PERTURBED[unit])
    other = host_of(unit, "python").begin()
    host.run(20)
    state, other.time = host.slave.getFMUState(), host.time
    data = host.slave.serializeFMUState(state)
    expected = host.run(20)
    host.slave.setFMUState(state)
    host.time = other.time
    assert host.run(20) == expected
    foreign = other.slave.deserializeFMUState(data)
    other.slave.setFMUState(foreign)
    assert other.run(20) == expected
    for each, kept in ((host, state), (other, foreign)):
        each.slave.freeFMUState(kept)
        each.free()


def test_state_survives_json_with_infinities(balls_of):
    unit, other = balls_of(), balls_of()
    unit.put("a_xi", math.inf, math.nan)
    other.restore(unit.packed())
    assert repr(other.saved()) == repr(unit.saved())
    assert math.isinf(other.real[other.layout.index["a_xi"]])


def test_state_of_another_size_is_refused(balls_of):
    with pytest.raises(RuntimeError, match="belongs to"):
        balls_of(weights=3).restore(balls_of(weights=2).saved())
    for data in (b"\xff\x00", b"[1, 2]", b'{"real": []}'):
        with pytest.raises(RuntimeError, match="belongs to"):
            balls_of().restore(data)


@pytest.mark.parametrize("unit", PERTURBED)
def test_reset_and_instantiate_again_start_afresh(unit, host_of, backend):
    host = host_of(unit, backend).begin(PERTURBED[unit])
    expected = host.run(10)
    host.slave.terminate()
    host.slave.reset()
    assert host.begin(PERTURBED[unit]).run(10) == expected
    host.slave.terminate()
    host.slave.fmi2FreeInstance(host.slave.component)
    host.instantiate()
    assert host.begin(PERTURBED[unit]).run(10) == expected
    host.free()


def test_after_a_failed_step_the_state_can_be_restored_and_stepped(host_of, backend):
    host = host_of("BallBalancer", backend).begin({"a_xi": 3.0})
    host.run(3)
    state, time = host.slave.getFMUState(), host.time
    expected = host.run(3)
    host.set({"a_xi": 1e300})
    with pytest.raises(FMICallException) as failed:
        host.step(1.0)
    # pythonfmu knows no status between discarded and fatal, after which no unit is left
    assert failed.value.status == (fmi2Error if backend == "native" else fmi2Discard)
    host.slave.setFMUState(state)
    host.set({"a_xi": 3.0})
    host.time = time
    assert host.run(3) == expected
    host.slave.freeFMUState(state)
    host.free()


@pytest.mark.parametrize(
    ("unit", "options", "name", "value", "message"),
    [
        ("RotorOnSupports", {}, "mass", -1.0, r"mass = -1.0 kg: .*above 0 kg"),
        ("RotorOnSupports", {}, "mass", 0.0, r"mass = 0.0 kg: .*above 0 kg"),
        ("RotorOnSupports", {}, "stiffness_x", math.nan, r"stiffness_x = nan N/m: .*finite"),
        ("RotorOnSupports", {}, "speed", math.inf, r"speed = inf rad/s: .*finite"),
        ("RotorOnSupports", {}, "plane[1].added_mass", -1.0, r"plane\[1\].added_mass = -1.0 kg"),
        ("LiquidBalancer", {}, "float_radius", 0.06, r"float_radius = 0.06 m: .*smaller than"),
        ("LiquidBalancer", {}, "density", 0.0, r"density = 0.0 kg/m3: .*above 0"),
        ("RingBalancer", {}, "inner_radius", 0.2, r"inner_radius = 0.2 m: .*smaller than"),
        ("RingBalancer", {}, "viscosity", -1.0, r"viscosity = -1.0 m2/s: .*at least 0"),
        ("BallBalancer", {}, "kappa", 0.5, r"kappa = 0.5: .*at least 1"),
        ("BallBalancer", {}, "drag", -0.1, r"drag = -0.1 N.s/m: .*at least 0"),
        ("BallBalancer", {}, "weight_radius", 0.01, r"weight_radius = 0.01 m: must be 0.0 m in a"),
        ("BallBalancer", {}, "restitution", 0.5, "restitution = 0.5: must be 0.0 in a Python unit"),
        ("BallBalancer", {}, "rolling_resistance", 1e-3, "rolling_resistance = 0.001: must be 0.0"),
        ("BallBalancer", {}, "track_offset_xi", 1e-4, "track_offset_xi = 0.0001 m: must be 0.0 m"),
        ("BallBalancer", {}, "track_offset_eta", 1e-4, "track_offset_eta = 0.0001 m: must be 0.0"),
        ("BallBalancer", {}, "stop_at_contact", True, "stop_at_contact = True: must be False in a"),
        ("BallBalancer", {}, "der(acceleration)", 3.0, r"= 3.0 rad/s3: must be"),
    ],
)
def test_bad_value_fails_initialisation_and_is_named(unit, options, name, value, message, probe):
    unit = probe(unit, begin=False, **options)
    unit.put(name, value)
    with pytest.raises(RuntimeError, match=message):
        unit.exit_initialization_mode()
    assert unit.log_queue[-1].status == 3
    assert unit.log_queue[-1].msg.startswith("unit at t = 0 s: initialisation failed")


@pytest.mark.filterwarnings("ignore:.*encountered in dot")
@pytest.mark.parametrize(
    ("name", "value", "step", "message"),
    [
        ("plane[1].F_xi", math.nan, 1e-3, r"plane\[1\].F_xi = nan N: must be a finite"),
        ("acceleration", math.inf, 1e-3, "acceleration = inf rad/s2"),
        ("plane[1].added_mass", -0.5, 1e-3, r"added_mass = -0.5 kg"),
        ("plane[1].F_xi", 1e308, 1e3, "not finite|finite number"),
        ("der(acceleration)", 2.0, 1e-3, r"= 2.0 rad/s3: must be 0.0 rad/s3 in a Python unit"),
        ("speed", 10.0, 0.0, "step size = 0.0 s"),
        ("speed", 10.0, math.nan, "step size = nan s"),
    ],
)
def test_bad_step_is_refused_with_its_reason_and_leaves_the_state(
    name, value, step, message, rotor_of
):
    unit = rotor_of(DISC)
    assert unit.do_step(0.0, 1e-3)
    before = list(unit.memory)
    unit.put(name, value)
    assert unit.do_step(1e-3, step) is False
    assert unit.memory == before
    (report,) = unit.log_queue
    assert report.status == 3
    assert re.search(message, report.msg)
    assert "t = 0.001 s" in report.msg


def test_parameters_are_fixed_once_running_and_outputs_never_settable(rotor_of, balls_of):
    unit = rotor_of(DISC)
    with pytest.raises(RuntimeError, match="mass: fixed once"):
        unit.put("mass", 3.0)
    with pytest.raises(RuntimeError, match="angle: outputs cannot be set"):
        unit.put("angle", 3.0)
    with pytest.raises(RuntimeError, match=r"value references \[999\]: unknown"):
        unit.get_real([0, 999])
    with pytest.raises(RuntimeError, match="inertia_as_force: fixed once"):
        balls_of().set_boolean([0], [True])


def test_reading_scattered_references_equals_reading_slices(rotor_of):
    unit = rotor_of(DISC)
    count = len(unit.layout.reals)
    everything = unit.get_real(list(range(count)))
    odd = list(range(count - 1, 0, -3))
    assert unit.get_real(odd) == [everything[vr] for vr in odd]
