"""Steps that end behind what happens to weights and sliders: where unit and host allow it."""

from __future__ import annotations

import ctypes
import math

import pytest
from fmpy.fmi1 import FMICallException

pytestmark = pytest.mark.slow

RADIUS, SIZE = 0.05, 0.01
TOUCHING = 2.0 * math.asin(SIZE / RADIUS)
DISCARD, LAST_SUCCESSFUL_TIME = 2, 2
START = {
    "weight_radius": SIZE,
    "restitution": 0.5,
    "weight[1].angle0": 0.0,
    "weight[2].angle0": 0.5,
    "weight[1].speed0": 20.0,
    "speed": 10.0,
    "angle": 0.7,
}
STEP = 0.02  # they meet about a third into it
ANGLES = ("weight[1].angle", "weight[2].angle")


def begun(fmus, packaging, frame: str = "rotor", **values: float | bool):
    host = packaging.Host(fmus.native("BallBalancer", frame=frame))
    return host.begin(START | {f"a_{'xi' if frame == 'rotor' else 'x'}": 0.3} | values)


def last_successful_time(host) -> float:
    value = ctypes.c_double()
    function = host.slave.dll.fmi2GetRealStatus
    assert function(host.slave.component, LAST_SUCCESSFUL_TIME, ctypes.byref(value)) == 0
    return value.value


@pytest.mark.parametrize("frame", ["rotor", "fixed"])
def test_a_step_ends_where_two_weights_have_met(fmus, packaging, frame):
    host = begun(fmus, packaging, frame, stop_at_contact=True)
    status = host.slave.dll.fmi2DoStep(
        host.slave.component, ctypes.c_double(0.0), ctypes.c_double(STEP), 1
    )
    assert status == DISCARD
    assert not host.messages
    met = last_successful_time(host)
    assert 0.0 < met < STEP
    first, second = host.get(*ANGLES)
    assert second - first == pytest.approx(TOUCHING, abs=1e-9)
    # the rest of the step from there leads where the whole step leads
    slow, fast = host.get("weight[1].speed", "weight[2].speed")
    assert fast > slow
    if frame == "fixed":
        host.set({"angle": START["angle"] + START["speed"] * met})
    host.slave.doStep(met, STEP - met)
    whole = begun(fmus, packaging, frame)
    whole.step(STEP)
    assert host.get(*ANGLES) == pytest.approx(whole.get(*ANGLES), abs=1e-5)
    for one in (host, whole):
        one.free()


def test_the_time_of_contact_is_that_of_the_gap(fmus, packaging):
    """A weight that nothing drives or brakes comes 20 rad/s nearer to the other one."""
    host = begun(fmus, packaging, stop_at_contact=True, a_xi=0.0, drag=0.0)
    with pytest.raises(FMICallException):
        host.slave.doStep(0.0, STEP)
    assert last_successful_time(host) == pytest.approx((0.5 - TOUCHING) / 20.0, rel=1e-9)
    slow, fast = host.get("weight[1].speed", "weight[2].speed")
    assert fast - slow == pytest.approx(0.5 * 20.0, rel=1e-9)  # restitution
    host.free()


def test_the_time_of_rest_is_that_of_coulomb_friction(fmus, packaging):
    """Alone on its track: u' = -mu/kappa u^2 for u = w + theta', until it turns with the rotor."""
    mu, speed, ahead = 0.02, 10.0, 0.1
    values = {"a_xi": 0.0, "drag": 0.0, "weight_radius": 0.0, "rolling_resistance": mu}
    values |= {"weight[1].speed0": ahead, "speed": speed, "stop_at_contact": True}
    host = begun(fmus, packaging, **values)
    with pytest.raises(FMICallException):
        host.slave.doStep(0.0, 0.1)
    expected = (1.0 / speed - 1.0 / (speed + ahead)) * 1.4 / mu
    assert last_successful_time(host) == pytest.approx(expected, rel=1e-6)
    assert host.get("weight[1].speed") == [0.0]
    host.free()


def test_a_step_ends_where_a_weight_breaks_away(fmus, packaging):
    """At angle 0, pulled along the track by s t: t = mu R w^2/s."""
    mu, speed, rate = 0.02, 10.0, 3.0
    values = {"a_xi": 0.0, "der(a_eta)": rate, "weight_radius": 0.0, "rolling_resistance": mu}
    values |= {"weight[1].speed0": 0.0, "speed": speed, "stop_at_contact": True}
    host = begun(fmus, packaging, **values)
    with pytest.raises(FMICallException):
        host.slave.doStep(0.0, 1.0)
    assert last_successful_time(host) == pytest.approx(mu * RADIUS * speed**2 / rate, rel=1e-9)
    host.free()


@pytest.mark.parametrize("drag", [0.0, 100.0])
def test_a_weight_in_heavy_drag_breaks_away_from_its_changing_load(fmus, packaging, drag):
    """At angle 0, pulled along by s t, inwards by c t: s t = mu (R w^2 - c t)."""
    mu, speed, along, inwards = 0.2, 10.0, 3.0, -4.0
    values = {"a_xi": 0.0, "der(a_eta)": along, "der(a_xi)": inwards, "weight_radius": 0.0}
    values |= {"rolling_resistance": mu, "weight[1].speed0": 0.0, "speed": speed, "drag": drag}
    values["weight[2].angle0"] = 0.0  # as the other one
    host = begun(fmus, packaging, stop_at_contact=True, **values)
    with pytest.raises(FMICallException):
        host.slave.doStep(0.0, 1.0)
    expected = mu * RADIUS * speed**2 / (along + mu * inwards)
    assert last_successful_time(host) == pytest.approx(expected, rel=1e-8)
    host.free()


@pytest.mark.parametrize("more", [{"weight_radius": SIZE}, {"rolling_resistance": 1e-12}])
def test_weights_with_events_follow_a_changing_acceleration(fmus, packaging, more):
    """As one does that can neither meet another nor stick: nothing happens to it here."""
    seen = []
    plain = {"weight_radius": more.get("weight_radius", 0.0), "weight[1].speed0": 0.3}
    for weights, values in ((1, plain), (2, plain | more)):
        host = packaging.Host(fmus.native("BallBalancer", weights=weights))
        host.begin({"speed": 10.0, "a_xi": 0.3} | values)
        host.set({"acceleration": 30.0, "der(acceleration)": -4e3, "der(acceleration,2)": 1e6})
        host.step(STEP)
        seen.append(host.get("weight[1].angle", "weight[1].speed"))
        host.free()
    assert seen[1] == pytest.approx(seen[0], rel=1e-8)


def test_outputs_are_those_of_the_contact(fmus, packaging):
    """What a host reads after an early end is what a state restored there gives."""
    host = begun(fmus, packaging, stop_at_contact=True, inertia_as_force=True)
    with pytest.raises(FMICallException):
        host.slave.doStep(0.0, STEP)
    met = last_successful_time(host)
    forces = host.get("F_xi", "F_eta", "der(F_xi)", "der(F_eta)")
    host.set({"a_xi": 0.3})  # the acceleration there, as it is constant
    assert host.get("F_xi", "F_eta", "der(F_xi)", "der(F_eta)") == pytest.approx(forces, rel=1e-12)
    host.slave.doStep(met, 1e-4)
    host.free()


SLIDING = {
    "mass": 2.0, "stiffness_x": 50.0, "damping_x": 0.0, "unbalance": 0.0,
    "slider[1].limit_x": 0.03, "shortest_stopped_step": 1e-6, "speed": 7.0,
}  # fmt: skip


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ({"x0": 0.01}, math.pi / math.sqrt(50.0 / 2.0)),  # half a period: it turns round
        ({"der(plane[1].F_x)": 0.4}, 0.03 / 0.4),  # a force that grows to what it holds
        ({"vx0": 0.001, "stiffness_x": 0.0}, 2.0 * 0.001 / 0.03),  # slows down, and sticks
    ],
    ids=["turns", "lets go", "sticks"],
)
def test_a_step_of_the_rotor_ends_at_an_event_of_a_slider(fmus, packaging, values, expected):
    host = packaging.Host(fmus.native("RotorOnSupports", frame="fixed", sliders=1))
    host.begin(SLIDING | values)
    with pytest.raises(FMICallException):
        host.slave.doStep(0.0, 1.0)
    assert last_successful_time(host) == pytest.approx(expected, rel=1e-9)
    # output and state are those of the event
    assert host.get("angle")[0] == pytest.approx(7.0 * expected, rel=1e-9)
    assert host.get("vx")[0] == pytest.approx(0.0, abs=1e-12)
    host.slave.reset()
    host.time = 0.0
    host.begin(SLIDING | values | {"shortest_stopped_step": 2.0})
    host.step(1.0)
    assert last_successful_time(host) == 1.0
    host.free()


@pytest.mark.parametrize("allowed", [True, False])
def test_fmi_3_returns_early_where_the_host_allows_it(fmus, packaging, allowed):
    host = packaging.Host(fmus.native("BallBalancer", fmi=3), earlyReturnAllowed=allowed)
    host.begin(START | {"stop_at_contact": True})
    event, end, early, time = host.slave.doStep(0.0, STEP)
    assert (event, end, early) == (False, False, allowed)
    assert (0.0 < time < STEP) == allowed
    first, second = host.get(*ANGLES)
    assert (second - first == pytest.approx(TOUCHING, abs=1e-9)) == allowed
    host.free()


def test_impulses_on_the_shaft_are_given_whole_where_steps_end_at_collisions(fmus, packaging):
    """Of rolling bodies of unlike size; a second pair meets while the impulse of the first is due.

    What each leaves is (kappa - 1) m R (R + r) times the jump of its rate; nothing else turns the
    shaft.
    """
    kappa, mass, ratios, sizes = 1.4, 0.1, (1.0, 0.5, 2.0), (1.0, 0.6, 1.3)
    values = {"kappa": kappa, "mass": mass, "track_radius": RADIUS, "weight_radius": SIZE}
    values |= {"restitution": 1.0, "drag": 0.0, "stop_at_contact": True, "weight[1].speed0": 20.0}
    for k, angle in enumerate((0.0, 0.6, 1.1), start=1):
        values |= {f"weight[{k}].angle0": angle, f"weight[{k}].mass_ratio": ratios[k - 1]}
        values |= {f"weight[{k}].radius_ratio": sizes[k - 1]}
    host = packaging.Host(fmus.native("BallBalancer", weights=3, unequal=1)).begin(values)
    time, total, ends = 0.0, 0.0, 0
    (before,) = host.get("torque")
    while time < 0.1:
        step = ctypes.c_double(STEP), 1
        status = host.slave.dll.fmi2DoStep(host.slave.component, ctypes.c_double(time), *step)
        end = last_successful_time(host) if status == DISCARD else time + STEP
        (now,) = host.get("torque")
        total += 0.5 * (before + now) * (end - time)
        time, before, ends = end, now, ends + (status == DISCARD)
    assert ends >= 2
    assert before == 0.0
    speeds = host.get(*(f"weight[{k}].speed" for k in (1, 2, 3)))
    left = [
        ratio * (RADIUS + SIZE * size) * (speed - first)
        for ratio, size, speed, first in zip(ratios, sizes, speeds, (20.0, 0.0, 0.0), strict=True)
    ]
    assert total == pytest.approx((kappa - 1.0) * mass * RADIUS * sum(left), rel=1e-9)
    host.free()
