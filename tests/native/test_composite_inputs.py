"""What a tool does to the composite from outside: its drive, and forces on the rotor."""

from __future__ import annotations

import math

import numpy as np
import pytest
from fmpy import platform_tuple

from autobalancer.harness import Scene, cosimulate, load_scene
from autobalancer.harness.export.one_file import build_one_file
from autobalancer.harness.master.one_file_run import OneFileRun
from autobalancer.harness.master.recorder import Recorder
from tests.native.packaging import Host

RISE, STAY = 300, 200  # steps


@pytest.mark.parametrize("told", [True, False])
def test_a_drive_that_jumps_moves_as_the_harness_moves_it(hosted, told):
    """The acceleration jumps to 0 at the end of a rise of the speed, by the tool or by itself."""
    top, steps = 300.0, 40
    step = 2.0 * math.pi / (top * steps)
    rise = RISE * step
    turned = 0.5 * (200.0 + top) * rise + top * STAY * step
    scene = load_scene("run_up").replace(
        {
            "operation.run_up.from": 200.0,
            "operation.run_up.to": top,
            "operation.run_up.seconds": rise,
            "coupling.scheme": "iterated",
            "coupling.tolerance": 1e-8,
            "run.revolutions": turned / (2.0 * math.pi),
        }
    )
    expected, profile = cosimulate(scene), scene.profile()
    host = hosted(scene, {"rise_time": 0.0, "coupling.top_speed": top} if told else {})
    names = list(expected.signals)
    rows = [host.get(*names)]
    for begin, end in zip(expected.time[:-1], expected.time[1:], strict=True):
        if told:
            host.set({"speed": profile.speed(begin), "acceleration": profile.acceleration(begin)})
        host.time = begin
        host.step(end - begin)
        rows.append(host.get(*names))
    assert host.get("rotor.speed") == [pytest.approx(top, rel=1e-12)]
    for k, signal in enumerate(names):
        error = np.abs(np.array(rows)[:, k] - expected[signal]).max()
        assert error <= 1e-6 * np.ptp(expected[signal]), signal


def sprung(**coupling) -> Scene:
    """An undamped rotor with an unbalance of nothing, that carries a liquid."""
    return Scene.from_document(
        {
            "rotor": {
                "kind": "planar",
                "mass": 2.0,
                "stiffness": [1e4, 4e4],
                "damping": [0.0, 0.0],
                "unbalance": 0.0,
            },
            "balancer": [
                {
                    "kind": "liquid",
                    "chamber_radius": 0.04,
                    "float_radius": 0.03,
                    "height": 0.05,
                    "density": 1000.0,
                    "inertia_as_force": True,
                }
            ],
            "operation": {"speed": 250.0},
            "coupling": {"tolerance": 1e-8, **coupling},
        }
    )


@pytest.mark.slow
@pytest.mark.parametrize("tool", [1.0, 0.37, 2.6])
def test_a_force_from_outside_moves_the_rotor_as_a_closed_form_says(hosted, tool):
    """x = F/k (1 - cos w t) from when it comes on, which need not be the end of a step."""
    scene = sprung()
    mass = 2.0 + 1000.0 * math.pi * 0.04**2 * 0.05
    step = tool * 2.0 * math.pi / 250.0 / 80
    host = hosted(scene)
    for _ in range(7):
        host.step(step)
    assert host.get("rotor.x", "rotor.y") == [0.0, 0.0]
    begin = host.time
    host.set({"rotor.plane[1].F_x": 3.0, "rotor.plane[1].F_y": -5.0})
    found, time = [], []
    for _ in range(round(200 / tool)):
        host.step(step)
        found.append(host.get("rotor.x", "rotor.y"))
        time.append(host.time - begin)
    for k, (force, stiffness) in enumerate([(3.0, 1e4), (-5.0, 4e4)]):
        moved = force / stiffness * (1.0 - np.cos(math.sqrt(stiffness / mass) * np.array(time)))
        assert np.abs(np.array(found)[:, k] - moved).max() < 1e-6 * np.abs(moved).max()


def test_a_force_that_changes_in_every_step_of_the_tool_is_held_between(hosted):
    """Of no matter how often the tool sets what it was."""
    runs = []
    for again in (1, 5):
        host = hosted(sprung())
        for k in range(60):
            host.set({"rotor.plane[1].F_x": 3.0 * math.sin(0.1 * k)})
            for _ in range(again):
                host.step(2.0 * math.pi / 250.0 / 31 / again)
        runs.append(host.get("rotor.x", "rotor.vx"))
    assert runs[0] == pytest.approx(runs[1], rel=1e-9)


def test_a_force_that_rises_shows_as_it_is_between_the_ends_of_a_step(hosted):
    """Newton's law for the plane, m a = F(t) - k x, at any point within the machine's own step."""
    mass, force, slope = 2.0 + 1000.0 * math.pi * 0.04**2 * 0.05, 3.0, 1e4
    for time in (5e-4, 2e-3, 5e-3):
        host = hosted(sprung())
        names = host.references("rotor.plane[1].F_x")
        host.set({"rotor.plane[1].F_x": force})
        host.slave.setRealInputDerivatives(names, [1], [slope])
        host.step(time)
        xi, eta, x, angle = host.get(
            "rotor.plane[1].a_xi", "rotor.plane[1].a_eta", "rotor.x", "rotor.angle"
        )
        acceleration = xi * math.cos(angle) - eta * math.sin(angle)
        assert acceleration == pytest.approx((force + slope * time - 1e4 * x) / mass, rel=1e-9)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_a_force_that_goes_on_as_it_was_told_begins_nothing_anew(hosted, order):
    """The tool tells the same polynomial again: the steps are as many as if it said nothing."""
    told, steps = [40.0, 3e3, 2e5, 3e7][: order + 1], {}
    for again in (False, True):
        host = hosted(sprung())
        names = host.references("rotor.plane[1].F_x")
        for k in range(20 if again else 1):
            t = 1e-4 * k
            now = [
                sum(f * t ** (j - d) / math.factorial(j - d) for j, f in enumerate(told) if j >= d)
                for d in range(order + 1)
            ]
            host.set({"rotor.plane[1].F_x": now[0]})
            for d, value in enumerate(now[1:], 1):
                host.slave.setRealInputDerivatives(names, [d], [value])
            host.step(1e-4 if again else 2e-3)
        steps[again] = host.get("coupling.steps", "rotor.x")
    assert steps[True][0] == steps[False][0]
    assert steps[True][1] == pytest.approx(steps[False][1], rel=1e-9)


def test_a_speed_that_jumps_between_steps_turns_the_rotor_from_there(hosted):
    host = hosted(sprung())
    host.step(0.01)
    host.set({"speed": 260.0})  # by 4 %, and no acceleration
    host.step(0.01)
    assert host.get("rotor.angle", "rotor.speed") == pytest.approx([5.1, 260.0], rel=1e-12)


@pytest.mark.parametrize("steps", [20, 60, 200])
def test_the_vibration_is_seen_though_the_tool_changes_an_input_in_every_step(hosted, steps):
    """Steps of the tool that are shorter than the distance of two looks at the motion."""
    settled = sprung().replace(
        {"rotor.unbalance": 1e-3, "rotor.damping": [100.0, 100.0], "operation.speed": 250.0}
    )
    host, length, turns = hosted(settled), 2.0 * math.pi / 250.0 / steps, 40
    places = []
    for k in range(turns * steps):
        host.set({"rotor.plane[1].F_x": 1e-6 * math.sin(k)})
        host.step(length)
        places.append(host.get("rotor.x", "rotor.y"))
    moved = 0.5 * np.ptp(places[-steps:], axis=0).max()
    assert host.get("vibration") == [pytest.approx(moved, rel=0.02)]


def test_a_rotor_that_speeds_up_by_itself_takes_no_speed(hosted):
    host = hosted(load_scene("run_up"))
    host.step(1.0)
    assert host.get("rotor.speed") == [pytest.approx(75.0, rel=1e-12)]
    host.set({"speed": 30.0})
    assert "rise_time is above 0 s" in host.refused(lambda: host.step(0.1))
    host.set({"speed": 0.0})
    host.step(2.0)  # over the end of the rise
    assert host.get("rotor.speed") == [pytest.approx(150.0, rel=1e-12)]
    assert host.get("rotor.angle") == [pytest.approx(150.0 + 150.0, rel=1e-9)]


def test_an_unbalance_tuned_before_the_event_of_a_step_moves_the_rotor_from_then_on(hosted):
    """Of a step whose ball comes to rest later; as a scene's unbalance that changes by itself."""
    times, after = (
        [0.003697, 0.008904, 0.01006],
        [(0.005093, 3.553), (0.005229, 1.487), (0.001231, 2.247)],
    )
    rotor = {
        "kind": "planar",
        "mass": 3.078,
        "stiffness": [11136.0, 11136.0],
        "unbalance": 0.004551,
    }
    ball = {"kind": "balls", "count": 1, "mass": 0.2968, "track_radius": 0.02479, "drag": 0.0}
    ball |= {"angles": [4.847], "rolling_resistance": 0.006717}
    tuned = {"rotor": rotor, "balancer": [ball], "operation": {"speed": 179.5}}
    tuned |= {"run": {"revolutions": 0.4849}, "coupling": {"tolerance": 1e-8}}
    changes = [
        {"time": time, "amount": amount, "angle": angle}
        for time, (amount, angle) in zip(times, after, strict=True)
    ]
    operation = {"speed": 179.5, "unbalance_changes": changes}
    expected = cosimulate(Scene.from_document({**tuned, "operation": operation}))
    host = hosted(Scene.from_document(tuned))
    for end, (amount, angle) in zip(times, after, strict=True):
        host.step(end - host.time)
        host.set({"rotor.unbalance": amount, "rotor.unbalance_angle": angle})
    host.step(expected.time[-1] - host.time)
    found = host.get("rotor.x", "rotor.y")
    assert found == pytest.approx([expected["rotor.x"][-1], expected["rotor.y"][-1]], rel=1e-6)


def test_an_unbalance_tuned_at_the_event_of_a_step_leaves_the_rotor_where_it_is(tmp_path):
    """Where a ball comes to rest, to the last digits of the time; read before the next step or not.

    Parts that were placed once more by the step that is over stood where it leads with the new
    unbalance.
    """
    rotor = {"kind": "planar", "mass": 3.0, "stiffness": [1.1e4, 1.1e4], "unbalance": 0.0045}
    ball = {"kind": "balls", "count": 1, "mass": 0.3, "track_radius": 0.025, "drag": 0.0}
    ball |= {"angles": [4.847], "speeds": [20.0], "rolling_resistance": 0.05}
    scene = Scene.from_document(
        {"rotor": rotor, "balancer": [ball], "operation": {"speed": 179.5},
         "run": {"revolutions": 0.5}, "coupling": {"tolerance": 1e-8}}
    )  # fmt: skip
    with OneFileRun(scene) as run:
        recorder = Recorder(run.units, ["rotor.x"])
        run.start()
        run.record(recorder, None)
        at = int(np.argmax(run.events > 0))
        event = recorder.columns()[0][at - 1]
    path = build_one_file(scene, tmp_path / "one.fmu", platforms=[platform_tuple])
    for time in event * (1.0 + np.arange(-3, 4) * 2.0**-53):
        untuned, unread, read = (Host(path).begin() for _ in range(3))
        for host in (untuned, unread, read):
            host.step(time)
        unread.set({"rotor.unbalance": 0.02})
        read.set({"rotor.unbalance": 0.02})
        place = untuned.get("rotor.x", "rotor.y")
        assert read.get("rotor.x", "rotor.y") == pytest.approx(place, rel=1e-12)
        for host in (unread, read):
            host.step(1e-3)
        assert read.get("rotor.x", "rotor.y") == unread.get("rotor.x", "rotor.y")
