"""Machines with and without their balancers, and machines whose weights are left behind."""

import numpy as np
import pytest

from autobalancer import Scene, load

GREEN = {"kind": "planar", "mass": 1.0, "stiffness": 1.0, "damping": 0.02, "unbalance": 0.01}
BALLS = {"name": "balls", "kind": "balls", "count": 2, "mass": 0.03267, "track_radius": 1.0,
         "drag": 0.001, "angles": [0.3, 2.1], "speeds": [-3.0, -3.0]}  # fmt: skip


def test_a_machine_whose_balls_are_left_behind_has_not_settled():
    scene = Scene(rotor=GREEN, balancer=[BALLS], speed=3.0, run={"revolutions": 400})
    found = scene.scatter({"rotor.unbalance": "normal(0.01,1%)"}, n=4)
    assert (found.behind == 2.0).all()
    assert (found.settled == 0.0).all()
    assert (found.residual > 10.0 * found.alone).all()
    said = found.as_json()
    assert said["left_behind"] == 4
    assert said["without_balancers"]["vibrate_more"] == 4


@pytest.mark.parametrize(
    ("rotor", "balls", "speed", "says"),
    [
        ({}, {"drag": 0.01}, 0.6, "synchronous, below the natural frequency"),
        ({"damping": 0.1, "unbalance": 0.03},
         {"count": 3, "mass": 0.03, "drag": 0.003, "angles": [0.3, 2.1, 4.0]}, 1.1, "irregular"),
        ({"damping": [0.1, 0.2], "stiffness": [1.0, 4.0]}, {"mass": 0.0327, "drag": 0.006}, 2.2,
         "irregular, between two natural frequencies"),
    ],
)  # fmt: skip
def test_a_machine_in_another_motion_than_the_balanced_one_has_not_settled(
    rotor, balls, speed, says
):
    """Motions named by an integration from 100 random starts, all of which end in them."""
    own = {**GREEN, **rotor}
    turning = {**BALLS, **balls}
    del turning["speeds"]
    scene = Scene(rotor=own, balancer=[turning], speed=speed, run={"revolutions": 250})
    found = scene.scatter({"rotor.unbalance": f"normal({own['unbalance']},1%)"}, n=3)
    assert (found.residual > found.alone).all(), says
    assert (found.settled == 0.0).all()
    said = found.as_json()
    assert said["other_motion"] + said["left_behind"] == 3
    if speed < 1.0:
        assert said["other_motion"] == 3


def test_without_balancers_the_amplitude_is_that_of_the_response_to_unbalance():
    scene = load("two_balls").replace({"run.revolutions": 60})
    found = scene.scatter({"weights.drag": "normal(0.06,10%)"}, n=3)
    rotor = scene.without_balancers().rotor
    (kx, ky), (cx, cy), w = rotor.stiffness, rotor.damping, 3.0
    parts = [
        w * w * rotor.unbalance / abs(k - rotor.mass * w * w + 1j * c * w)
        for k, c in ((kx, cx), (ky, cy))
    ]
    assert (found.alone >= max(parts) * (1.0 - 1e-9)).all()
    assert (found.alone <= np.hypot(*parts)).all()
    assert found.behind.tolist() == [0.0, 0.0, 0.0]
    assert list(found.to_pandas())[-2] == "largest without balancers [m]"


def test_the_command_compares_with_the_machines_without_balancers(invoke, tmp_path):
    outcome = invoke(
        "scatter", "two_balls", "--vary", "weights.drag=normal(0.06,10%)", "-n", "4",
        "--set", "run.revolutions=60",
    )  # fmt: skip
    assert outcome.exit_code == 0, outcome.output
    assert "0 of 4 machines vibrate more with balancers than without" in " ".join(
        outcome.output.split()
    )
    assert "left behind" not in outcome.output


def test_a_machine_that_has_not_settled_is_said_to_vibrate_more_for_the_time_being(invoke):
    """Its ring leaves 76 % of the vibration in the steady motion, with a time constant of 24 s."""
    outcome = invoke("scatter", "washing_machine_ring", "--vary", "ring.fill=normal(0.5,1%)",
                     "-n", "2")  # fmt: skip
    said = " ".join(outcome.output.split())
    assert "2 of 2 machines vibrate more with balancers than without at the end, 2 of them " in said
    assert "before they have settled" in said


def test_weights_that_swing_between_two_frequencies_are_neither_settled_nor_left_behind():
    """Between two natural frequencies; an integration calls 16 to 29 of 100 starts so."""
    rotor = {**GREEN, "damping": [0.1, 0.2], "stiffness": [1.0, 4.0]}
    balls = {**BALLS, "mass": 0.0327, "drag": 0.006, "angles": [3.2159, 5.9719]}
    del balls["speeds"]
    scene = Scene(rotor=rotor, balancer=[balls], speed=2.2, run={"revolutions": 1500})
    rates, lags = ([f"balls.weight[{k}].{what}" for k in (1, 2)] for what in ("speed", "mean_lag"))
    ends = scene.run.many({"rotor.unbalance": [0.01]}, results=[*rates, *lags])
    assert min(ends[name][0] for name in rates) < -0.02 * 2.2  # slow at this moment
    assert max(abs(ends[name][0]) for name in lags) < 0.01 * 2.2
    found = scene.scatter({"rotor.unbalance": "normal(0.01,0.0001%)"}, n=1)
    assert found.behind.tolist() == [0.0]
    assert found.settled.tolist() == [0.0]
    assert found.as_json()["other_motion"] == 1
