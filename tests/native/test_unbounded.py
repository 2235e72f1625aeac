"""A rotor that whirls without bound, or starts so fast that its weights cannot be followed.

Weights swing in its field at the root of acceleration over radius.  Without a bound a run took ever
shorter steps.  A rotor without weights is linear and followed at any size.
"""

import numpy as np
import pytest

from autobalancer.harness import Scene
from autobalancer.harness.errors import SimulationError

BALLS = {
    "kind": "balls", "name": "balls", "count": 2, "mass": 0.01, "track_radius": 0.05, "drag": 0.02,
    "angles": [0.2, 2.5],
}  # fmt: skip
ROTOR = {
    "kind": "planar", "mass": 1.0, "stiffness": 1e4, "damping": 0.5, "internal_damping": 20.0,
    "unbalance": 1e-4,
}  # fmt: skip
DOCUMENT = {
    "rotor": ROTOR,
    "balancer": [BALLS],
    "operation": {"speed": 300.0},
    "run": {"revolutions": 100.0},
}
WHIRLING = Scene.from_document(DOCUMENT)
STEADY = WHIRLING.replace({"rotor.internal_damping": 0.0, "run.revolutions": 3})
# internal damping c_i feeds whirl at w_n by (c_i w/w_n - c_i - c)/(2 m), from some 1 mm at first
GROWTH = (20.0 * 3.0 - 20.5) / 2.0
MOST = 1e6 * 0.05 * 300.0  # m/s
WORDS = "cannot be followed: it vibrates more and more by itself, or starts too fast"


@pytest.mark.parametrize("touching", [None, 0.005])
def test_a_rotor_that_whirls_without_bound_ends_where_its_weights_cannot_be_followed(touching):
    with pytest.raises(SimulationError, match=WORDS) as failure:
        WHIRLING.replace({"balls.weight_radius": touching}).run()
    words = str(failure.value)
    assert "more than 1e6 times as fast as what swings on it (15 m/s)" in words
    reached = float(words.split("at t = ")[1].split(" s")[0])
    grown = np.log(MOST / (1e-3 * 100.0)) / GROWTH
    assert reached == pytest.approx(grown, rel=0.2)


def test_the_same_rotor_is_followed_as_far_as_a_large_vibration():
    """Whirl grows by e^12, as far as it is compared with an independent integration elsewhere."""
    run = WHIRLING.replace({"run.revolutions": 12.0 / GROWTH * 300.0 / (2.0 * np.pi)}).run()
    assert np.abs(run["rotor.x"]).max() > 10.0


def test_a_rotor_without_weights_may_grow_as_far_as_it_does():
    run = Scene.from_document({**DOCUMENT, "balancer": []}).run()
    assert 1e12 < np.abs(run["rotor.x"]).max() < np.inf


def test_a_start_of_a_million_times_the_weights_speed_is_refused_and_one_below_is_not():
    with pytest.raises(SimulationError, match="the rotor moves at 1e\\+16 m/s at t = 0 s"):
        STEADY.replace({"run.initial.vx": 1e16}).run()
    assert STEADY.replace({"run.initial.vx": 1e6}).run().error_known


def test_a_motor_s_shaft_swings_by_its_unbalance_as_weights_do():
    """As a pendulum of length I/U."""
    motor = {"inertia": 0.01, "stall_torque": 5.0, "no_load_speed": 300.0, "from": 100.0}
    scene = Scene.from_document(
        {"rotor": ROTOR, "operation": {"motor": motor}, "run": {"revolutions": 1.0}}
    )
    start = {"run.initial.vx": 2e6 * motor["inertia"] / ROTOR["unbalance"] * 300.0}
    with pytest.raises(SimulationError, match=WORDS):
        scene.replace(start).run()


def test_of_many_machines_those_without_bound_fail_with_the_reason():
    found = WHIRLING.run.many({"rotor.internal_damping": [0.0, 20.0, 18.0, 0.1]})
    assert [WORDS in reason for reason in found["failure"]] == [False, True, True, False]
    assert np.isfinite(found["residual"]).tolist() == [True, False, False, True]


def test_of_machines_that_scatter_those_without_bound_are_rows_with_the_reason():
    found = WHIRLING.scatter({"rotor.internal_damping": "uniform(0,20)"}, n=16)
    failed = [WORDS in reason for reason in found.failure]
    assert 0 < sum(failed) < 16


def test_a_host_is_told_with_the_reason(instance):
    host = instance(WHIRLING).begin()
    host.step(0.5)
    assert WORDS in host.refused(lambda: host.step(1.0))
