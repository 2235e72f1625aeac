"""A ring of liquid on a rotor in supports of rubber."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import brentq

import autobalancer as ab
from autobalancer.harness import cosimulate
from autobalancer.harness.stability.boundaries import is_provable
from autobalancer.models.monolith import simulate
from autobalancer.models.rubber import zener
from autobalancer.models.stability import growth_rates

FREQUENCY = 50.0  # rad/s
WAVE_DAMPING = 1.2
TABLES = {
    "rotor": {"kind": "planar", "mass": 10.0, "stiffness": 2.5e4, "damping": 20.0,
              "unbalance": 0.02, "support_loss_factor": 0.2, "loss_frequency": FREQUENCY},
    "balancer": [{"name": "ring", "kind": "ring", "wall_radius": 0.25, "inner_radius": 0.2,
                  "height": 0.05, "density": 1000.0, "wave_damping": WAVE_DAMPING}],
}  # fmt: skip


def machine(operation, **run):
    return ab.Scene(**TABLES, operation=operation, run=run)


def whirls(speed: float) -> np.ndarray:
    """Whirl speeds nu of the free machine [rad/s]: roots of a polynomial written anew.

    (K(i nu) + i c nu - M nu^2) g(nu) = m_L nu^2 h(nu), with rubber K(i nu) by (1 + i nu tau).
    """
    rubber, p = zener(2.5e4, 0.2, FREQUENCY), np.poly1d
    f, mass = 0.64, 1000.0 * math.pi * (0.25**2 - 0.2**2) * 0.05
    late = p([1j * rubber.time, 1.0])
    spring = rubber.static * late + p([1j * rubber.branch * rubber.time, 0.0])
    support = spring + late * p([-10.0, 20.0j, 0.0])
    damped = -1j * WAVE_DAMPING * p([1.0, -speed])
    wave = p([1.0 + f, -4.0 * speed, 2.0 * speed**2]) + damped
    liquid = p([1.0, -4.0 * speed, 2.0 * speed**2]) + damped
    return (support * wave - late * mass * p([1.0, 0.0, 0.0]) * liquid).roots


@pytest.mark.parametrize(
    "operation",
    [{"speed": 40.0}, {"run_up": {"from": 0, "to": 60.0, "seconds": 1.5}}],
    ids=["constant", "run-up"],
)
def test_both_engines_move_as_an_independent_integration(operation):
    scene = machine(operation, duration=1.5)
    one, several = (cosimulate(scene, separate=choice) for choice in (False, True))
    right = simulate(
        scene.assembly(), scene.operation.drive(), one.time, method="odeint", rtol=1e-10
    )
    for name in ("rotor.station[1].x", "rotor.station[1].y"):
        size = np.abs(right.signal(name)).max()
        assert one[name] == pytest.approx(right.signal(name), abs=3.0 * one.estimated_error * size)
        assert several[name][-1] == pytest.approx(one[name][-1], abs=1e-4 * size)


@pytest.mark.parametrize("speed", [20.0, 45.0, 60.0, 120.0])
def test_growth_is_that_of_the_polynomial(speed):
    (found,) = growth_rates(machine({"speed": speed}).assembly(), np.array([speed]))
    assert found == pytest.approx(-whirls(speed).imag.min(), abs=1e-9 * speed)


def test_the_critical_speed_is_where_spring_and_liquid_answer_alike():
    rubber, mass = zener(2.5e4, 0.2, FREQUENCY), 1000.0 * math.pi * (0.25**2 - 0.2**2) * 0.05
    turned = brentq(
        lambda w: rubber.dynamic(w).real - w**2 * (10.0 + mass / (1.0 - 0.64)), 5.0, 100.0
    )
    assert machine({"speed": 60.0}).rotor().critical_loaded == pytest.approx([turned], rel=1e-9)


@pytest.mark.skipif(not is_provable(), reason="the extra `proof` is not installed")
def test_the_limit_of_the_polynomial_is_proved():
    limit = brentq(lambda speed: whirls(speed).imag.min(), 20.0, 35.0)
    bands = machine({"speed": 60.0}).speeds(20.0, 60.0, "proved", narrowest=0.01).proof.bands
    assert [band.state for band in bands] == ["stable", "undecided", "unstable"]
    assert bands[0].high < limit < bands[2].low
    assert bands[2].low - bands[0].high < 0.03
