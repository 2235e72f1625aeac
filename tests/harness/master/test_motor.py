"""A motor of limited power in the coupling: against one integration of all, and by its energy."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from autobalancer.harness import Scene, cosimulate, load_scene
from autobalancer.harness.errors import SceneError
from autobalancer.harness.master.cosimulation import CoSimulation
from autobalancer.harness.master.recorder import Recorder
from tests.studies.truth.judge import deviations, motion

pytestmark = pytest.mark.slow

M, INERTIA, P, C, M1, R, B, KAPPA = 1.0, 0.01, 2.0, 8.0, 0.02, 0.05, 0.05, 1.4
K = np.array([1e4, 1.3e4])
U = 0.002 * np.exp(0.3j)
STALL, TOP, START = 1.0, 200.0, 20.0
SCENE = {
    "rotor": {
        "kind": "planar", "mass": M, "stiffness": K.tolist(), "damping": C, "internal_damping": P,
        "unbalance": 0.002, "unbalance_angle": 0.3,
    },
    "operation": {
        "motor": {"inertia": INERTIA, "stall_torque": STALL, "no_load_speed": TOP, "from": START}
    },
    "balancer": [{
        "kind": "balls", "count": 2, "mass": M1, "track_radius": R, "drag": B, "angles": [0.2, 2.5],
    }],
    "run": {"revolutions": 6.0},
}  # fmt: skip
MOTION = ("x", "y", "vx", "vy")


def test_a_run_with_motor_is_that_of_all_in_one_piece():
    """By integrations whose energy is accounted for in tests/models/test_driven.py."""
    scene = Scene.from_document({**SCENE, "coupling": {"tolerance": 1e-6}})
    result = cosimulate(scene)
    assert max(deviations(result, motion(scene, result)).values()) <= 1e-6


@pytest.mark.parametrize("gravity", [0.0, 9.81])
@pytest.mark.parametrize("kind", ["planar", "two_support", "flexible"])
def test_energy_fed_in_by_the_motor_is_what_is_stored_and_lost(kind, gravity):
    """To 1e-6 of what is fed in; power between the points by cubics through values and slopes."""
    fed, stored, lost, _ = energies(scene_of(kind).replace({"operation.gravity": gravity}))
    assert fed > 3.0 * lost > 0.0
    assert stored + lost == pytest.approx(fed, abs=1e-6 * fed)


def test_what_rolling_resistance_takes_from_a_weight_turns_the_shaft():
    """Energy: what is rolled off is the resistance's share of the load, times the way."""
    [balls] = SCENE["balancer"]
    ball = {**balls, "name": "ball", "count": 1, "weight_radius": 0.005, "angles": [0.2]}
    document = {**SCENE, "balancer": [ball], "run": {"revolutions": 1.0}}
    document["coupling"] = {"steps_per_rev": 800}
    motor = {"stall_torque": 4.0, "inertia": 0.03, "from": 60.0}
    changes = {f"operation.motor.{key}": value for key, value in motor.items()}
    changes |= {"ball.rolling_resistance": 0.1, "rotor.unbalance": 0.01}
    scene = Scene.from_document(document).replace(changes)
    fed, stored, lost, _ = energies(scene)
    names = ["rotor.plane[1].a_xi", "rotor.plane[1].a_eta", "motor.speed"]
    names += ["ball.weight[1].angle", "ball.weight[1].speed"]
    run = cosimulate(scene, record=names)
    along, across, w, angle, rate = (run[name] for name in names)
    load = R * (w + rate) ** 2 - ((along + 1j * across) * np.exp(-1j * angle)).real
    rolled = np.trapezoid(0.1 * M1 * R * np.abs(load * rate), run.time)
    assert rolled > 100e-6 * fed
    assert stored + lost + rolled == pytest.approx(fed, abs=1e-6 * fed)


def test_a_motor_passes_the_resonance_on_energy_that_friction_and_weights_of_finite_size_take():
    """Under gravity; weights on tracks of their own, as collisions take energy too."""
    [balls] = SCENE["balancer"]
    ball = {**balls, "count": 1, "weight_radius": 0.005}
    document = {
        **SCENE,
        "balancer": [
            {**ball, "name": "one", "angles": [0.2]},
            {**ball, "name": "other", "angles": [2.5]},
        ],
        "coupling": {"steps_per_rev": 1600},
        "run": {"revolutions": 10.0},
    }
    motor = {"stall_torque": 4.0, "inertia": 0.03, "from": 60.0}
    changes = {f"operation.motor.{key}": value for key, value in motor.items()}
    changes |= {"operation.gravity": 9.81, "rotor.unbalance": 0.01}
    scene = Scene.from_document(document).replace({**changes, "rotor.friction": [{"limit": 5.0}]})
    fed, stored, lost, rubbed = energies(scene)
    assert min(lost, rubbed) > 0.02 * fed
    assert stored + lost + rubbed == pytest.approx(fed, abs=1e-6 * fed)


def energies(scene):
    """Fed in by the motor, stored since the start, lost to damping and drag, rubbed off [J]."""
    prefixes = ["rotor."]
    if len(scene.rotor.stations) > 1:
        prefixes = [f"rotor.station[{k + 1}]." for k in range(len(scene.rotor.stations))]
    balls = [(b, f"{b.label}.weight[{k + 1}].") for b in scene.balancer for k in range(b.count)]
    names = [f"{prefix}{what}" for prefix in prefixes for what in MOTION]
    names += [f"{prefix}{what}" for _, prefix in balls for what in ("angle", "speed")]
    result = cosimulate(scene, record=[*names, "motor.speed", "motor.power", "motor.angle"])
    signals = [np.array([result[p + what] for p in prefixes]) for what in MOTION]
    q, v = signals[0] + 1j * signals[1], signals[2] + 1j * signals[3]
    w, rotor = result["motor.speed"], scene.assembly().loaded_rotor
    gravity, turn = scene.operation.gravity, np.exp(1j * result["motor.angle"])
    swing = np.einsum("it,ij,jt->t", v.conj(), rotor.mass, v).real / 2
    stretched = [
        np.einsum("it,ij,jt->t", part, stiffness, part) / 2
        for part, stiffness in ((q.real, rotor.stiffness_x), (q.imag, rotor.stiffness_y))
    ]
    dragged = (v.conj() * 1j * w * rotor.unbalance[:, None] * turn).sum(axis=0).real
    kinetic = swing + dragged + scene.operation.motor.inertia * w * w / 2
    lost = np.einsum("it,ij,jt->t", v.real, rotor.damping_x, v.real)
    lost += np.einsum("it,ij,jt->t", v.imag, rotor.damping_y, v.imag)
    sheared = v - 1j * w * q
    lost += np.einsum("it,ij,jt->t", sheared.conj(), rotor.internal_damping, sheared).real
    heavy = rotor.mass.sum(axis=0) @ q + rotor.unbalance.sum() * turn
    for balancer, prefix in balls:
        at = rotor.planes[balancer.at - 1] @ v
        theta, rate = (result[f"{prefix}{what}"] for what in ("angle", "speed"))
        ahead = R * (w + rate)
        rim = R * rate - (balancer.weight_radius or 0.0) * w  # speed of the surface that rolls
        heavy += M1 * R * np.exp(1j * theta) * turn
        kinetic += M1 * (ahead**2 + (KAPPA - 1.0) * rim**2) / 2
        kinetic += M1 * (at.conj() * 1j * ahead * np.exp(1j * theta) * turn).real
        lost += B * (R * rate) ** 2
    stored = kinetic + sum(stretched) + gravity * heavy.imag
    fed, gone = (integral(result.time, power) for power in (result["motor.power"], lost))
    rubbed = sum(
        slider.limit * path(result.time, places[slider.station], speeds[slider.station])
        for slider in rotor.sliders
        for places, speeds in [(signals[slider.axis], signals[2 + slider.axis])]
    )
    return fed, stored[-1] - stored[0], gone, rubbed


def path(times, places, speeds):
    """Length of the way to and fro; where a step turns round, at one rate and on at another."""
    step, way = np.diff(times), np.diff(places)
    begin, end = speeds[:-1], speeds[1:]
    turns = begin * end < 0.0
    until = np.divide(2.0 * way - end * step, begin - end, out=np.zeros_like(way), where=turns)
    out = np.where(turns, begin * until / 2.0, 0.0)
    return float((np.abs(out) + np.abs(way - out)).sum())


def scene_of(kind):
    rotors = {
        "planar": SCENE["rotor"],
        "two_support": {
            "kind": "two_support", "mass": 5.0, "inertia": 0.1, "polar_inertia": 0.05, "span": 0.4,
            "stiffness": [[1e4, 1.2e4], 2e4], "damping": [20.0, 30.0], "planes": [0.1],
            "unbalances": [{"position": 0.05, "amount": 0.004, "angle": 0.4}],
        },
        "flexible": {
            "kind": "flexible", "stations": [0.0, 0.2, 0.4], "masses": [0.5, 2.0, 0.5],
            "supports": [1, 3], "support_stiffness": [[1e4, 1.2e4], 2e4],
            "support_damping": [20.0, 30.0], "bending_stiffness": 20.0, "internal_damping": 3.0,
            "unbalances": [{"position": 0.2, "amount": 0.004, "angle": 0.4}],
        },
    }  # fmt: skip
    balancer = {**SCENE["balancer"][0], "at": 2 if kind == "flexible" else 1}
    document = {**SCENE, "rotor": rotors[kind], "balancer": [balancer]}
    document["coupling"] = {"steps_per_rev": 400}
    return Scene.from_document(document)


def integral(times, values):
    """Of a smooth function known at equal steps: Boole's rule."""
    step, whole = times[1] - times[0], (len(times) - 1) // 4 * 4
    weights = np.array([14.0, 32.0, 12.0, 32.0])
    head = values[: whole + 1]
    found = 2.0 * step / 45.0 * (weights @ head[:-1].reshape(-1, 4).sum(axis=0))
    found += 2.0 * step / 45.0 * 7.0 * (head[-1] - head[0])
    # the rest of fewer than four steps, by Gregory's end corrections of a cubic
    tail = np.polynomial.polynomial.polyfit(np.arange(-5.0, 1.0), values[-6:], 5)
    rest = np.polynomial.polynomial.polyint(tail)
    return found - step * np.polynomial.polynomial.polyval(float(whole - len(times) + 1), rest)


WRONG = [
    ({"operation.motor.inertia": 1e-6}, "operation.motor.inertia = 1e-06 kg m^2: must be above"),
    ({"coupling.scheme": "compensated"}, "does not support operation.motor"),
    ({"operation.motor.table": [[0.0, 1.0], [9.0, 0.0]]}, "give either table, or stall_torque"),
]


@pytest.mark.parametrize(("changes", "words"), WRONG)
def test_what_a_motor_cannot_drive_is_refused(changes, words):
    with pytest.raises(SceneError, match=words.replace("^", r"\^")):
        Scene.from_document(SCENE).replace(changes)


def test_weights_of_finite_size_that_do_not_meet_move_as_points():
    points = Scene.from_document({**SCENE, "coupling": {"tolerance": 1e-7}})
    record = ["motor.speed", "balls.weight[1].angle"]
    exact = cosimulate(points, record=record)
    found = cosimulate(points.replace({"balls.weight_radius": 1e-9}), record=record)
    for name in record:
        assert found[name][-1] == pytest.approx(exact[name][-1], rel=1e-6)


def differences(run, fine):
    """Largest difference of every signal from the finer run, of its largest value, or in rad."""
    found = {}
    for name, values in run.signals.items():
        expected = CubicSpline(fine.time, fine[name])(run.time)
        size = 1.0 if name.endswith("angle") else np.abs(expected).max()
        found[name] = np.abs(values - expected).max() / size
    return found


def in_one_piece(scene, record):
    """The machine in one piece, at points that are close together."""
    plain = {"coupling.scheme": None, "coupling.order": None, "coupling.tolerance": None}
    steps = {"coupling.steps_per_rev": 400, "coupling.corrections": None}
    fine = cosimulate(scene.replace({**plain, **steps}), record=record)
    assert fine.series_order > 0
    return fine


@pytest.mark.parametrize("kind", ["planar", "two_support", "flexible", "offset", "sommerfeld"])
def test_separate_units_with_a_motor_move_as_the_machine_in_one_piece(kind):
    """The master predicts and corrects the shaft's acceleration; in one piece there is no loop."""
    if kind == "sommerfeld":
        scene = load_scene("sommerfeld").replace({"run.revolutions": 20})
    elif kind == "offset":
        scene = scene_of("planar").replace({"balls.track_offset_xi": 1e-3})
    else:
        scene = scene_of(kind).replace({"operation.gravity": 9.81})
    scene = scene.replace({"coupling.steps_per_rev": None, "coupling.tolerance": 1e-5})
    first = "rotor." if len(scene.rotor.stations) == 1 else "rotor.station[1]."
    record = [f"{first}x", f"{first}y", "motor.speed", "motor.angle"]
    record += [f"{scene.balancer[0].label}.weight[{k}].angle" for k in (1, 2)]
    run = cosimulate(scene, record=record, separate=True)
    found = differences(run, in_one_piece(scene, record))
    assert max(found.values()) <= min(1e-5, 3.0 * run.estimated_error), found


def test_separate_units_state_their_error_where_the_characteristic_has_corners():
    table = [[0.0, 1.0], [30.0, 4.0], [160.0, 0.0], [200.0, -2.0]]
    line = dict.fromkeys(["operation.motor.stall_torque", "operation.motor.no_load_speed"])
    scene = scene_of("planar").replace({"operation.motor.table": table, **line})
    scene = scene.replace({"coupling.steps_per_rev": None, "coupling.tolerance": 1e-4})
    record = ["rotor.x", "rotor.y", "motor.speed", "balls.weight[1].angle"]
    run = cosimulate(scene, record=record, separate=True)
    found = differences(run, in_one_piece(scene, record))
    assert max(found.values()) <= 1e-4, found
    assert max(found.values()) <= 3.0 * max(run.estimated_error, 1e-5), found


@pytest.mark.parametrize(("scheme", "order"), [("gauss-seidel", 3), ("jacobi", 3)])
def test_explicit_schemes_follow_a_motor_with_their_order(scheme, order):
    """A rotor alone: only the shaft's acceleration is assumed for a step.

    The schemes extrapolate it by cubics, whose error at the end of the step is of order 4; the
    speed's is then at least of order 3.
    """
    scene = Scene.from_document({**SCENE, "balancer": []})
    fine = in_one_piece(scene, ["motor.speed"])
    errors = []
    for steps in (100, 200):
        given = {"coupling.scheme": scheme, "coupling.steps_per_rev": steps}
        run = cosimulate(scene.replace(given), record=["motor.speed"], separate=True)
        errors.append(differences(run, fine)["motor.speed"])
    assert errors[1] <= errors[0] / 2**2.7 or errors[1] <= 1e-9, errors


EVENTS = {
    "touching": {"angles": [0.2, 0.41]},
    "bouncing": {"angles": [0.2, 0.6], "restitution": 0.5},
    "rolling": {"rolling_resistance": 0.02},
}


@pytest.mark.parametrize("kind", EVENTS)
def test_separate_weights_with_events_follow_a_changing_acceleration_of_the_shaft(kind):
    """As the machine in one piece; told the mean of each step they are off by 1e-6 and more."""
    [balls] = SCENE["balancer"]
    scene = Scene.from_document(
        {**SCENE, "balancer": [{**balls, "weight_radius": 0.005, **EVENTS[kind]}]}
    )
    record = ["rotor.x", "rotor.y", "motor.speed", "balls.weight[1].angle"]
    given = scene.replace({"coupling.tolerance": None, "coupling.steps_per_rev": 50})
    run = cosimulate(given, record=record, separate=True)
    found = differences(run, in_one_piece(scene, record))
    assert max(found.values()) <= 1e-7, found


COLLISIONS = {
    "rolling balls": {"mass": [0.1, 0.06, 0.15], "weight_radius": [0.008, 0.005, 0.01]},
    "rollers that stay together": {
        "kind": "rollers", "mass": [0.1, 0.06, 0.15], "restitution": 0.0,
    },
    "off-centre track": {"track_offset_xi": 0.003},
}  # fmt: skip


@pytest.mark.parametrize("kind", COLLISIONS)
def test_a_collision_of_separate_weights_turns_the_shaft_as_in_one_piece(kind):
    """Without the impulse on the shaft its speed is off by 7e-4 and more, at any step."""
    balls = {
        "kind": "balls", "count": 3, "mass": 0.1, "track_radius": 0.06, "drag": 0.05,
        "angles": [0.5, 2.0, 4.5], "speeds": [20.0, -15.0, -5.0], "weight_radius": 0.008,
        "restitution": 0.5,
    }  # fmt: skip
    rotor = {"mass": 5.0, "stiffness": [2000.0, 2500.0], "damping": 5.0, "unbalance": 0.005}
    motor = {"inertia": 0.004, "stall_torque": 0.5, "no_load_speed": 60.0, "from": 30.0}
    scene = Scene.from_document(
        {
            "rotor": {"kind": "planar", **rotor},
            "operation": {"motor": motor},
            "balancer": [{**balls, **COLLISIONS[kind]}],
            "run": {"revolutions": 0.8},
        }
    )
    given = scene.replace({"coupling.tolerance": None, "coupling.steps_per_rev": 800})
    run = cosimulate(given, record=["motor.speed"], separate=True)
    fine = cosimulate(scene.replace({"coupling.tolerance": 1e-7}), record=["motor.speed"])
    assert run["motor.speed"][-1] == pytest.approx(fine["motor.speed"][-1], rel=3e-6)


def test_a_motor_s_scene_begins_again_with_its_speed():
    scene = scene_of("planar").replace({"run.revolutions": 1.0})
    with CoSimulation(scene) as cosim:
        ends = []
        for _ in range(2):
            cosim.start()
            recorder = Recorder(cosim.units, ["motor.speed", "rotor.x"])
            cosim.record(recorder, None)
            ends.append({name: values.tolist() for name, values in recorder.columns()[1].items()})
    assert ends[0] == ends[1]
