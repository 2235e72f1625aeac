"""The reference of what sticks and slips, against closed forms and the units' own step."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from autobalancer.models.assembly import Assembly, Mounted, SpeedProfile
from autobalancer.models.monolith import simulate
from autobalancer.models.reference.coupled import Start
from autobalancer.models.rotor import LinearRotor, Slider
from autobalancer.models.weights import Weights
from tests.native.equations import Excitation

pytestmark = pytest.mark.slow

SPEED = SpeedProfile.constant(30.0)


def test_a_free_vibration_loses_four_limits_over_the_stiffness_a_period_and_stays():
    rotor = replace(LinearRotor.planar(2.0, (8e3, 1e4)), sliders=(Slider(0, 0, 3.0),))
    period = math.tau / math.sqrt(8e3 / 2.0)
    times = period * np.arange(9)
    run = simulate(Assembly(rotor), SPEED, times, initial=Start(0.01), rtol=1e-11)
    lost = 4.0 * 3.0 / 8e3
    np.testing.assert_allclose(run.x[:7, 0], 0.01 - lost * np.arange(7), atol=1e-11)
    assert run.x[7, 0] == run.x[8, 0] == pytest.approx(run.x[6, 0] - 2.0 * (0.001 - 3.0 / 8e3))


SLIDERS = (Slider(0, 0, 1.0), Slider(0, 1, 0.7, 2e4), Slider(1, 0, 0.5, 4e4), Slider(1, 1, 2.0))


@pytest.mark.parametrize(("gravity", "ramp"), [(0.0, 0.0), (4.0 - 9.81j, 0.0), (0.0, 400.0)])
def test_sliders_are_those_of_the_units_step(friction_of, gravity, ramp):
    body = LinearRotor.two_support(
        mass=1.28, inertia=0.0138, polar_inertia=0.00124, span=0.26, com=0.11, planes=[0.1],
        stiffness=[(2e4, 3e4), (1.5e4, 2e4)], damping=[(4.0, 6.0), (3.0, 5.0)],
        unbalances=[(0.05, 2e-4, 0.5)],
    )  # fmt: skip
    body = replace(body, gravity=gravity, sliders=SLIDERS)
    start = Start((2e-4, -1e-4), (1e-4, 2e-4), (0.05, -0.02), (0.01, 0.04), 0.3)
    times = np.linspace(0.0, 0.1, 41)
    profile = SpeedProfile.run_up(150.0, 150.0 + 0.2 * ramp, 0.2 if ramp else 0.0)
    run = simulate(Assembly(body), profile, times, initial=start, rtol=1e-11)
    method = friction_of(body)
    pairs = np.array([[start.x, start.y], [start.vx, start.vy]])
    pairs[0] += body.rest_position(150.0)
    state = pairs.transpose(0, 2, 1).ravel()
    held, found = method.at_start(state), [state]
    for begin, end in pairwise(times):
        angle, speed = 0.3 + profile.angle(begin), profile.speed(begin)
        excitation = Excitation(np.zeros((4, 1), complex), angle, speed, (ramp, 0.0, 0.0, 0.0))
        state, held = method.advance(state, held, excitation, end - begin)
        found.append(state)
    places = np.stack([run.x, run.y], axis=2).reshape(len(times), -1)
    assert np.abs(places - np.array(found)[:, :4]).max() < 1e-8 * np.abs(places).max()


def test_a_weight_coasts_to_rest_under_its_own_load():
    """u' = -c R u^2 with u = w + theta', so u = u0/(1 + c R u0 t) until u = w."""
    w, rate, mu, kappa, radius = 30.0, 20.0, 0.02, 1.4, 0.1
    device = Weights(1, 1e-9, radius, 0.0, kappa)
    ball = Mounted("ball", device, 0, (0.3,), (rate,), rolling_resistance=mu)
    assembly = Assembly(LinearRotor.planar(1.0, (1e4, 1e4)), (ball,))
    lost, u = mu / kappa, w + rate
    rest = (u / w - 1.0) / (lost * u)
    times = rest * np.array([0.25, 0.5, 1.0, 2.0])
    run = simulate(assembly, SPEED, times, rtol=1e-11)
    t = np.minimum(times, rest)
    theta = 0.3 + np.log(1.0 + lost * u * t) / lost - w * t
    np.testing.assert_allclose(run.theta["ball"][:, 0], theta, atol=1e-7)
    assert run.angle_rate["ball"][-1, 0] == 0.0


def test_weights_without_a_load_stay_in_space_when_the_rotor_starts_to_turn():
    """Nothing holds what does not press: theta = theta_0 - a t^2/2, though the race's rate is 0."""
    angles = (2.3, 1.3, 0.9, 3.9)
    mounted = Mounted("w", Weights(4, 0.06, 0.03, 0.0, 1.0), 0, angles, rolling_resistance=0.003)
    rotor = LinearRotor.planar(7.0, (800.0, 1250.0), unbalance=1e-6)
    times, rise = np.linspace(0.0, 0.3, 13), 270.0
    run = simulate(
        Assembly(rotor, (mounted,)), SpeedProfile.run_up(0.0, 100.0, 100.0 / rise), times
    )
    right = np.array(angles) - 0.5 * rise * times[:, None] ** 2
    np.testing.assert_allclose(run.theta["w"], right, atol=1e-3)  # the rotor moves by 1e-6 m


def test_weights_that_collide_and_stick_are_refused():
    device = Weights(2, 0.01, 0.1, 0.0, 1.4, 0.01)
    balls = Mounted("b", device, 0, (0.0, 2.0), half_angle=0.1, rolling_resistance=0.01)
    assembly = Assembly(LinearRotor.planar(1.0, (1e4, 1e4)), (balls,))
    with pytest.raises(ValueError, match="collide"):
        simulate(assembly, SPEED, [1.0])
