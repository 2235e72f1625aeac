"""Gravity across the axis: closed forms, energy, and an independent integration."""

from __future__ import annotations

import math

import numpy as np
import pytest

from autobalancer.harness import Scene, SceneError, cosimulate, load_scene, speeds
from autobalancer.harness.checks.runner import check
from autobalancer.models.monolith import simulate

pytestmark = pytest.mark.slow

G = 9.81
RUNTIMES = ("native", "python")
STILL = {"mass": 1e9, "stiffness": 1e13, "damping": 0.0}


def scene_of(balancers: list[dict], operation: dict, **tables: dict) -> Scene:
    rotor = {"kind": "planar", "mass": 2.0, "stiffness": 8e3, "damping": 30.0}
    return Scene.from_document(
        {
            "rotor": rotor | tables.pop("rotor", {}),
            "balancer": balancers,
            "operation": {"gravity": G} | operation,
            **tables,
        }
    )


def weights(kind: str = "pendulums", **keys) -> dict:
    return {"kind": kind, "name": "weights", "mass": 0.05, "track_radius": 0.1, "count": 1} | keys


def still(w: float, **keys) -> Scene:
    """One weight on a rotor too heavy to move, from the lowest place in space."""
    start = {"angles": [-0.5 * math.pi], "speeds": [-w]}
    run = {"revolutions": keys.pop("revolutions")}
    return scene_of([weights(**start, **keys)], {"speed": w}, rotor=STILL, run=run)


def turned(scene: Scene) -> np.ndarray:
    """Angle of the weight in space, from the lowest place on."""
    run = cosimulate(scene, record=["rotor.angle", "weights.weight[1].angle"])
    return run["rotor.angle"] + run["weights.weight[1].angle"] + 0.5 * math.pi


LIQUID = {"kind": "liquid", "chamber_radius": 0.05, "float_radius": 0.03, "height": 0.05}
LIQUID |= {"density": 900.0}


@pytest.mark.parametrize("units", RUNTIMES)
@pytest.mark.parametrize("as_force", [False, True])
@pytest.mark.parametrize("angle", [None, 0.3])
def test_a_rotor_sags_by_the_weight_of_all_it_carries(units, as_force, angle):
    carried = [weights(count=2, inertia_as_force=as_force), LIQUID | {"inertia_as_force": as_force}]
    scene = scene_of(
        carried,
        {"speed": 300.0, "gravity_angle": angle},
        rotor={"unbalance": 0.0, "damping": 300.0},
        coupling={"units": units},
        run={"revolutions": 20, "record": ["rotor.x", "rotor.y"]},
    )
    mass = 2.0 + 2 * 0.05 + 900.0 * math.pi * 0.05**2 * 0.05
    run = cosimulate(scene)
    mean = (run["rotor.x"] + 1j * run["rotor.y"])[-1]
    direction = -1j if angle is None else np.exp(1j * angle)
    # weights that gravity swings shake the rotor a little
    assert mean == pytest.approx(mass * G / 8e3 * direction, rel=5e-3)


@pytest.mark.parametrize("kind", ["planar", "two_support", "flexible"])
def test_a_rotor_left_alone_falls_onto_its_sag_and_stays(kind):
    name = {"planar": "two_balls", "two_support": "drum", "flexible": "three_mass_shaft"}[kind]
    scene = load_scene(name).without_balancers()
    speed = scene.profile().end
    names = [f"rotor.plane[1].{name}" for name in ("y", "a_xi", "a_eta")]
    changes = {"operation.gravity": G, "run.revolutions": 5, "run.record": names}
    scene = scene.replace(changes | {"coupling.steps_per_rev": 40})
    rotor = scene.assembly().rotor
    total = float(rotor.mass.sum()) * G
    sag = rotor.sag(speed)
    y = sag.imag if rotor.isotropic else sag[rotor.stations :]
    assert float((rotor.stiffness_y @ y).sum()) == pytest.approx(-total, rel=1e-12)
    run = cosimulate(scene)
    motion = simulate(scene.assembly(), scene.profile(), run.time, rtol=1e-11)
    for name in names:
        scale = np.ptp(motion.signal(name))
        assert np.abs(run[name] - motion.signal(name)).max() < 1e-8 * scale


def test_a_plane_at_rest_feels_gravity_turn_backwards_once_a_revolution():
    run = {"revolutions": 3}
    scene = scene_of([], {"speed": 50.0}, rotor=STILL, run=run)
    names = ["rotor.plane[1].a_xi", "rotor.plane[1].a_eta"]
    run = cosimulate(scene, record=names)
    felt = run[names[0]] + 1j * run[names[1]]
    assert np.abs(felt - 1j * G * np.exp(-50j * run.time)).max() < 1e-6 * G


@pytest.mark.parametrize(
    "name", ["two_balls", "drum", "two_plane_rodrigues", "balls_and_liquid", "run_up"]
)
def test_a_scene_moves_as_an_independent_integration(name):
    changes = {"operation.gravity": G, "run.revolutions": 8, "coupling.tolerance": 1e-6}
    scene = load_scene(name).replace(changes)
    run = cosimulate(scene)
    start = scene.run.initial.motion()
    motion = simulate(scene.assembly(), scene.profile(), run.time, initial=start, rtol=1e-11)
    for signal in run.signals:
        if signal.endswith((".x", ".y", ".angle")):
            right = motion.signal(signal)
            assert np.abs(run[signal] - right).max() < 1e-6 * np.ptp(right), signal


@pytest.mark.parametrize("drag", [1.0, 3.0])
def test_a_ball_rests_in_space_below_the_speed_at_which_drag_lifts_its_weight(drag):
    """b R w = m g sin(psi): the race slips under it, up to w = m g/(b R)."""
    limit = 0.05 * G / (drag * 0.1)
    below = turned(still(0.95 * limit, drag=drag, kind="balls", revolutions=40))
    assert below[-1] == pytest.approx(math.asin(0.95), rel=1e-4)
    above = turned(still(1.05 * limit, drag=drag, kind="balls", revolutions=40))
    assert above[-1] > 4.0 * math.pi


def test_a_ball_under_heavy_drag_runs_round_at_adlers_rate():
    """phi' = w - w_g sin(psi) gives sqrt(w^2 - w_g^2) on the average."""
    drag, turns = 50.0, 5
    w = 2.0 * 0.05 * G / (drag * 0.1)
    revolutions = turns / math.sqrt(0.75)
    ran = turned(still(w, drag=drag, revolutions=revolutions))
    assert ran[-1] == pytest.approx(2.0 * math.pi * turns, rel=1e-4)


def test_a_ball_that_holds_on_falls_behind_by_what_gravitys_swing_costs():
    """Mean power: w <phi'> = <phi'^2>, so <theta'> = -g^2/(2 w (kappa R)^2 (w^2 + d^2))."""
    w, drag, kappa = 150.0, 0.5, 1.4
    scene = still(w, drag=drag, kind="balls", revolutions=120)
    scene = scene.replace({"weights.speeds": [0.0]})
    scene = scene.replace({"coupling.steps_per_rev": 40})
    run = cosimulate(scene, record=["weights.weight[1].angle"])
    angle, d = run["weights.weight[1].angle"], drag / (kappa * 0.05)
    drift = (angle[-1] - angle[80 * 40]) / (run.time[-1] - run.time[80 * 40])
    expected = -(G**2) / (2 * w * (kappa * 0.1) ** 2 * (w**2 + d**2))
    assert drift == pytest.approx(expected, rel=5e-3)


def test_weights_that_touch_stay_in_contact_as_an_independent_integration_has_it():
    scene = scene_of(
        [weights("balls", count=2, weight_radius=0.02, drag=0.3, angles=[0.0, 0.6])],
        {"speed": 30.0},
        rotor={"unbalance": 3e-3},
        coupling={"steps_per_rev": 400},
        run={"revolutions": 6},
    )
    run = cosimulate(scene)
    motion = simulate(scene.assembly(), scene.profile(), run.time, rtol=1e-10)
    apart = motion.signal("weights.weight[2].angle") - motion.signal("weights.weight[1].angle")
    assert apart.min() == pytest.approx(2.0 * math.asin(0.2), abs=1e-6)
    for signal in ("rotor.x", "rotor.y", "weights.weight[1].angle"):
        right = motion.signal(signal)
        assert np.abs(run[signal] - right).max() < 2e-2 * np.ptp(right), signal


def test_what_asks_for_rest_refuses_gravity_and_says_why():
    heavy = load_scene("two_balls").replace({"operation.gravity": G})
    with pytest.raises(SceneError, match="gravity swings them once per revolution"):
        speeds(heavy, (1.0, 8.0))
    with pytest.raises(SceneError, match=r"check\[1\].kind = \"\w+\": its theory has no gravity"):
        check(load_scene("drum").replace({"operation.gravity": G}))
