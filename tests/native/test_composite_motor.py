"""The composite under a motor of limited power: as the harness drives the separate units."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from autobalancer.harness import Scene, UserError, cosimulate, cosimulate_many
from autobalancer.harness.master.schedule import end_time
from autobalancer.harness.result.alike import table_of
from autobalancer.models.monolith import simulate
from tests.studies.truth.judge import deviations, motion

RANGE = 1e-11
MOTOR = {"inertia": 0.01, "stall_torque": 1.0, "no_load_speed": 200.0, "from": 20.0}
DOCUMENT = {
    "rotor": {
        "kind": "planar", "mass": 1.0, "stiffness": [1e4, 1.3e4], "damping": 8.0,
        "internal_damping": 2.0, "unbalance": 0.002, "unbalance_angle": 0.3,
    },
    "operation": {"motor": MOTOR},
    "coupling": {"steps_per_rev": 40},
    "balancer": [{
        "name": "balls", "kind": "balls", "count": 2, "mass": 0.02, "track_radius": 0.05,
        "drag": 0.05, "angles": [0.2, 2.5],
    }],
    "run": {"revolutions": 6.0},
}  # fmt: skip
RECORD = ["rotor.x", "rotor.y", "rotor.angle", "motor.speed", "motor.angle", "motor.power"]
CORNERS = {
    "operation.motor.table": [[0.0, 1.0], [30.0, 4.0], [160.0, 0.0], [200.0, -2.0]],
    "operation.motor.stall_torque": None,
    "operation.motor.no_load_speed": None,
}


def test_a_step_ends_at_a_corner_of_the_characteristic(hosted):
    """Against an integration by SciPy that knows nothing of steps."""
    scene = Scene.from_document(DOCUMENT).replace(CORNERS)
    times, names = np.linspace(0.0, end_time(scene), 61), ["rotor.x", "rotor.y", "motor.speed"]
    right = simulate(scene.assembly(), scene.operation.drive(), times, rtol=1e-12)
    expected = np.array([right.signal(name) for name in names]).T
    for tolerance in (1e-3, 1e-6):
        host = hosted(scene.replace({"coupling.tolerance": tolerance}))
        off = np.abs(host.driven(times, names) - expected).max(axis=0)
        assert (off < tolerance * np.abs(expected).max(axis=0)).all()


def test_a_motor_that_comes_to_rest_on_a_corner_ends_no_step_there(hosted):
    """Rounding crosses it for ever."""
    scene = Scene.from_document({**DOCUMENT, "balancer": []}).replace(
        {**CORNERS, "operation.motor.from": 159.0, "rotor.unbalance": 0.0, "run.revolutions": 400}
    )
    host = hosted(scene)
    host.driven(np.linspace(0.0, end_time(scene), 11), ["motor.speed"])
    assert host.get("motor.speed") == [pytest.approx(160.0, abs=1e-9)]
    assert host.get("coupling.steps")[0] < 1.1 * 40 * 400


@pytest.mark.slow
@pytest.mark.parametrize("tolerance", [1e-6, 1e-4])
def test_a_run_over_corners_states_its_error(tolerance):
    scene = Scene.from_document(DOCUMENT).replace(
        {**CORNERS, "coupling.steps_per_rev": None, "coupling.tolerance": tolerance}
    )
    result = cosimulate(scene)
    error = max(deviations(result, motion(scene, result)).values())
    assert error < 3.0 * result.estimated_error
    assert error < tolerance


def test_a_state_within_a_step_is_everything(state_is_everything):
    scene = Scene.from_document(DOCUMENT)
    times = np.linspace(0.0, end_time(scene), 60)
    state_is_everything(scene, {"motor.inertia": 0.02}, times, RECORD)


def test_a_state_goes_into_an_instance_that_has_not_begun(instance):
    """Its motor has made no lines of the characteristic yet, on one of which the state stands."""
    scene = Scene.from_document(DOCUMENT).replace(
        {**CORNERS, "coupling.steps_per_rev": None, "coupling.tolerance": 1e-6}
    )
    times = np.linspace(0.0, end_time(scene), 60)
    host = instance(scene).begin()
    host.driven(times[:20], RECORD)
    kept = host.slave.serializeFMUState(host.slave.getFMUState())
    expected = host.driven(times[19:], RECORD).tolist()
    other = instance(scene)
    other.slave.setFMUState(other.slave.deserializeFMUState(kept))
    assert other.driven(times[19:], RECORD).tolist() == expected


def test_a_force_from_outside_that_begins_within_a_step_moves_rotor_and_shaft(hosted):
    """Against DOP853; the force lies along a fixed axis."""
    scene = Scene.from_document({**DOCUMENT, "balancer": []}).replace(
        {"rotor.internal_damping": 0.0, "coupling.steps_per_rev": 160}
    )
    begins, end, force = 0.07123, 0.15, 25.0
    unbalance = 0.002 * np.exp(0.3j)

    def rate(time, state):
        x, y, vx, vy, angle, w = state
        turn = unbalance * np.exp(1j * angle)
        push = turn * w * w - (1e4 * x + 1.3e4j * y) - 8.0 * (vx + 1j * vy)
        push += force * (time >= begins)
        inertia = np.array(
            [[1.0, 0.0, -turn.imag], [0.0, 1.0, turn.real], [-turn.imag, turn.real, 0.01]]
        )
        right = [push.real, push.imag, 1.0 - w / 200.0]
        return [vx, vy, *np.linalg.solve(inertia, right)[:2], w, np.linalg.solve(inertia, right)[2]]

    def run(span, begin):
        return solve_ivp(rate, span, begin, "DOP853", rtol=1e-11, atol=1e-13).y[:, -1]

    half = run((0.0, np.nextafter(begins, 0.0)), [0.0, 0.0, 0.0, 0.0, 0.0, 20.0])
    expected = run((begins, end), half)
    host = hosted(scene)
    host.step(begins)
    host.set({"rotor.plane[1].F_x": force})
    host.time = begins
    host.step(end - begins)
    found = host.get("rotor.x", "rotor.y", "rotor.vx", "rotor.vy", "motor.angle", "motor.speed")
    assert found == pytest.approx(expected, rel=1e-6, abs=1e-6 * 0.3)


def test_its_speed_is_no_input():
    scene = Scene.from_document(DOCUMENT)
    with pytest.raises(UserError, match="'speed': not known"):
        cosimulate_many(scene, {"speed": [10.0]})
    compensated = {"coupling.scheme": "compensated"}
    with pytest.raises(UserError, match=r"does not support operation\.motor"):
        scene.replace(compensated)


def test_runs_of_many_motors_are_the_single_runs():
    scene = Scene.from_document(DOCUMENT)
    scenes = [
        scene.replace(
            {"operation.motor.stall_torque": torque, "operation.motor.no_load_speed": top}
        )
        for torque, top in ((0.5, 200.0), (1.0, 150.0), (2.0, 250.0))
    ]
    found = cosimulate_many(scenes[0], table_of(scenes), results=["largest", "motor.speed"])
    assert list(found["failure"]) == [""] * 3
    for k, one in enumerate(scenes):
        single = cosimulate(one, record=["rotor.x", "rotor.y", "motor.speed"])
        amplitude = np.hypot(single["rotor.x"], single["rotor.y"])
        assert found["largest"][k] == pytest.approx(amplitude.max(), rel=1e-2)
        assert found["motor.speed"][k] == pytest.approx(single["motor.speed"][-1], rel=1e-5)


def test_the_acceleration_of_a_motor_in_one_file_is_that_of_its_speed(instance):
    """It follows from the torques of all parts where it is read."""
    host = instance(Scene.from_document(DOCUMENT).replace({"coupling.tolerance": 1e-10})).begin()
    host.step(0.1)
    (before,) = host.get("motor.speed")
    host.step(1e-5)
    (found,) = host.get("motor.acceleration")
    host.step(1e-5)
    (after,) = host.get("motor.speed")
    assert found == pytest.approx((after - before) / 2e-5, rel=1e-6)


def test_pendulums_on_a_track_beside_the_axis_brake_the_shaft_as_lagrange_says():
    """Their force on the track has a moment about the shaft; integrated by SciPy."""
    offset, turn, radius, mass, drag = 0.012 - 0.007j, 0.3, 0.05, 0.05, 0.02
    unbalance, damper, spring, inertia = 0.004, 8.0, np.array([1e4, 1.3e4]), 0.01
    balancer = {
        "name": "weights", "kind": "pendulums", "count": 2, "mass": mass, "track_radius": radius,
        "drag": drag, "angles": [0.2, 2.5],
        "track_offset_xi": offset.real, "track_offset_eta": offset.imag,
    }  # fmt: skip
    rotor = {"kind": "planar", "mass": 1.0, "stiffness": list(spring), "damping": damper,
             "unbalance": unbalance, "unbalance_angle": turn}  # fmt: skip
    scene = Scene.from_document(
        {"rotor": rotor, "operation": {"motor": MOTOR | {"inertia": inertia}},
         "coupling": {"tolerance": 1e-10}, "balancer": [balancer], "run": {"revolutions": 8.0}}
    )  # fmt: skip
    run = cosimulate(scene, record=["rotor.x", "rotor.y", "motor.speed"])

    def rates(_, state):
        place, speeds = state[:5], state[5:]
        w, fast = speeds[2], speeds[3:]
        u, o = unbalance * np.exp(1j * (place[2] + turn)), offset * np.exp(1j * place[2])
        arms = radius * np.exp(1j * place[3:])
        # what a point of each mass moves by with x, y, the shaft's angle and the weights' angles
        ways = [np.array([1.0, 1j, 1j * o, *(1j * arms * np.eye(2)[k])]) for k in (0, 1)]
        bent = [-(w**2) * o - fast[k] ** 2 * arms[k] for k in (0, 1)]
        masses = np.diag([1.0, 1.0, inertia, 0.0, 0.0])
        masses[:2, 2] = masses[2, :2] = [-u.imag, u.real]
        masses = masses + sum(mass * (way.conj()[:, None] * way).real for way in ways)
        slid = drag * radius**2 * (fast - w)
        pushed = -spring * place[:2] - damper * speeds[:2] + w**2 * np.array([u.real, u.imag])
        force = np.array([*pushed, 1.0 - w / 200.0 + slid.sum(), *-slid])
        force -= sum(mass * (way.conj() * a).real for way, a in zip(ways, bent, strict=True))
        return [*speeds, *np.linalg.solve(masses, force)]

    start = [0.0, 0.0, 0.0, 0.2, 2.5, 0.0, 0.0, 20.0, 20.0, 20.0]
    times = (0.0, run.time[-1])
    solved = solve_ivp(rates, times, start, "DOP853", run.time, rtol=1e-12, atol=1e-14)
    for name, k in (("rotor.x", 0), ("rotor.y", 1), ("motor.speed", 7)):
        expected = solved.y[k]
        assert np.abs(run[name] - expected).max() <= 1e-8 * np.abs(expected).max(), name
