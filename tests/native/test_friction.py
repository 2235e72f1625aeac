"""Dry friction in the supports against closed forms, an energy balance and SciPy's integration."""

from __future__ import annotations

import math
import operator
from dataclasses import replace

import numpy as np
import pytest

from autobalancer.models.rotor import LinearRotor, Slider
from tests.native.equations import Excitation

pytestmark = pytest.mark.slow

MASS, STIFFNESS, LIMIT = 2.0, 8.0e3, 3.0
NATURAL = math.sqrt(STIFFNESS / MASS)
NO_FORCE = np.zeros((4, 1), complex)
REST = Excitation(NO_FORCE, 0.0, 0.0)


@pytest.fixture
def planar(friction_of):
    """A disc on springs with sliders; its forces in fixed axes."""

    def make(*sliders, unbalance=0.0):
        rotor = LinearRotor.planar(MASS, (STIFFNESS, 1.3 * STIFFNESS), unbalance=unbalance)
        return friction_of(replace(rotor, sliders=sliders), turning_force=False)

    return make


def run(method, state, seconds, steps, excitation=REST, held=None):
    """States and friction at the ends of equal steps, the start included."""
    state = np.array(state, float)
    held = method.at_start(state) if held is None else held
    step = seconds / steps
    found = [(state, held)]
    for k in range(steps):
        t = k * step
        angle, w, *spin_up = later([excitation.angle, excitation.speed, *excitation.spin_up], t)
        now = Excitation(np.array(later(excitation.forces, t)), angle, w, tuple(spin_up))
        state, held = method.advance(state, held, now, step)
        found.append((state, held))
    return found


def later(derivatives, t):
    """Value and derivatives of a polynomial at a time, from those at 0."""
    terms = [t**k / math.factorial(k) for k in range(len(derivatives))]
    return [sum(map(operator.mul, derivatives[k:], terms)) for k in range(len(derivatives))]


@pytest.mark.parametrize("steps", [1, 7, 40])
def test_free_vibration_loses_four_limits_over_the_stiffness_a_period(planar, steps):
    period = 2.0 * math.pi / NATURAL
    found = run(planar(Slider(0, 0, LIMIT)), [0.01, 0.0, 0.0, 0.0], 6 * period, 6 * steps)
    left = [state[0] for state, _ in found[::steps]]
    lost = 4.0 * LIMIT / STIFFNESS
    np.testing.assert_allclose(left, 0.01 - lost * np.arange(7), rtol=1e-12)


def test_it_stays_where_the_spring_cannot_move_it_and_goes_where_it_can(planar):
    inside, outside = 0.999 * LIMIT / STIFFNESS, 1.001 * LIMIT / STIFFNESS
    method = planar(Slider(0, 0, LIMIT))
    for sign in (1.0, -1.0):
        stays, held = run(method, [sign * inside, 0.0, 0.0, 0.0], 1.0, 10)[-1]
        assert stays[0] == sign * inside
        assert stays[2] == 0.0
        assert held[0, 1] == pytest.approx(sign * STIFFNESS * inside, rel=1e-14)
        half = math.pi / NATURAL
        goes, held = run(method, [sign * outside, 0.0, 0.0, 0.0], 1.5 * half, 3)[-1]
        assert goes[0] == pytest.approx(sign * (2 * LIMIT / STIFFNESS - outside), rel=1e-12)
        assert goes[2] == 0.0
        assert held[0, 0] == 0.0


@pytest.mark.parametrize("steps", [1, 3, 20])
def test_a_growing_force_moves_it_from_the_limit_on(planar, steps):
    growth, seconds = 40.0, 0.2  # N/s
    forces = NO_FORCE.copy()
    forces[1] = growth
    excitation = Excitation(forces, 0.0, 0.0)
    (state, _) = run(planar(Slider(0, 0, LIMIT)), [0.0] * 4, seconds, steps, excitation)[-1]
    since = seconds - LIMIT / growth
    expected = growth / STIFFNESS * (since - math.sin(NATURAL * since) / NATURAL)
    assert state[0] == pytest.approx(expected, rel=1e-11)


@pytest.mark.parametrize("ratio", [0.6, 0.9, 1.2, 2.0])
def test_forced_vibration_is_that_of_den_hartog(planar, ratio):
    """Den Hartog 1931: amplitude and phase of motion without a stop, force P cos(w t)."""
    speed = ratio * NATURAL
    pull = 5.0 * LIMIT
    response = 1.0 / (1.0 - ratio**2)
    turn = math.pi / ratio
    damping = math.sin(turn) / (ratio * (1.0 + math.cos(turn)))
    share = LIMIT / pull
    amplitude = pull / STIFFNESS * math.sqrt(response**2 - (share * damping) ** 2)
    behind = math.asin(share * damping / response) if ratio < 1 else math.pi - math.asin(
        share * damping / -response)  # fmt: skip
    method = planar(Slider(0, 0, LIMIT), unbalance=pull / speed**2)
    # at a turning point the mass is at its amplitude, with the force ahead by the phase
    for lead in (behind, -behind):
        excitation = Excitation(NO_FORCE, lead, speed)
        found = run(method, [amplitude, 0.0, 0.0, 0.0], 2.0 * math.pi / speed, 2, excitation)
        if abs(found[1][0][0] + amplitude) < 1e-6 * amplitude:
            break
    for turn_point, sign in ((1, -1.0), (2, 1.0)):
        state = found[turn_point][0]
        assert state[0] == pytest.approx(sign * amplitude, rel=1e-10)
        assert abs(state[2]) < 1e-9 * speed * amplitude


def slip_work(method, sliders, begin, seconds, excitation=REST, depth=5):
    """State and friction at the end, and the work of the sliders [J]: slip times limit.

    Stretches within which a slider has turned round are divided until they do not matter.
    """
    state, held = method.advance(*begin, excitation, seconds)
    if depth == 5 or (depth and (held[:, 0] != begin[1][:, 0]).any()):
        total, now, part = 0.0, begin, seconds / 20
        for k in range(20):
            later = excitation._replace(angle=excitation.angle + excitation.speed * k * part)
            *now, work = slip_work(method, sliders, now, part, later, depth - 1)
            total += work
        return *now, total
    spring = np.array([s.stiffness or np.inf for s in sliders])
    at = [2 * s.station + s.axis for s in sliders]
    slipped = (state - begin[0])[at] + (held - begin[1])[:, 1] / spring
    return state, held, float(np.array([s.limit for s in sliders]) @ np.abs(slipped))


def test_jenkins_hysteresis_loses_four_limits_times_the_slip(planar):
    """4 F (A - F/k) a cycle, by the slip of the slider, in steady forced vibration."""
    spring, speed = 2.0e4, 0.8 * NATURAL
    slider = Slider(0, 0, LIMIT, spring)
    method = planar(slider, unbalance=5.0 * LIMIT / speed**2)
    period, excitation = 2.0 * math.pi / speed, Excitation(NO_FORCE, 0.0, speed)
    settled = run(method, [0.0] * 4, 200 * period, 200, excitation)[-1]
    found = run(method, settled[0], period, 1000, excitation, settled[1])
    assert abs(found[-1][0][0] - settled[0][0]) < 1e-12
    amplitude = max(abs(state[0]) for state, _ in found)
    *_, lost = slip_work(method, [slider], settled, period, excitation)
    assert lost == pytest.approx(4.0 * LIMIT * (amplitude - LIMIT / spring), rel=2e-5)


BODY = LinearRotor.two_support(
    mass=1.28, inertia=0.0138, polar_inertia=0.00124, span=0.26, com=0.11,
    stiffness=((21500.0, 15800.0), (21500.0, 15800.0)), planes=(0.13,),
    unbalances=((0.14, 37.2e-6, 0.0), (0.0, 3.0e-6, 1.0)),
)  # fmt: skip
SLIDERS = (
    Slider(0, 0, 0.8), Slider(0, 1, 0.6, 3.0e4), Slider(1, 0, 0.5, 2.0e4), Slider(1, 1, 0.7),
    Slider(0, 0, 0.3, 1.0e4), Slider(1, 0, 0.4),
)  # fmt: skip


def test_energy_goes_into_the_slip_alone(friction_of):
    method = friction_of(replace(BODY, sliders=SLIDERS))
    start = np.array([2e-4, 1e-4, -1e-4, 2e-4, 0.05, 0.01, -0.02, 0.04])

    def energy(state, held):
        x, y, vx, vy = state[:4:2], state[1:4:2], state[4::2], state[5::2]
        springs = np.array([s.stiffness for s in SLIDERS])
        bent = np.divide(held[:, 1] ** 2, springs, out=np.zeros(6), where=springs > 0)
        return 0.5 * (vx @ BODY.mass @ vx + vy @ BODY.mass @ vy + x @ BODY.stiffness_x @ x
                      + y @ BODY.stiffness_y @ y + bent.sum())  # fmt: skip

    *now, lost = slip_work(method, SLIDERS, (start, method.at_start(start)), 0.08)
    first, last = energy(start, method.at_start(start)), energy(*now)
    assert last < 0.3 * first
    assert first - last == pytest.approx(lost, rel=1e-10)


@pytest.mark.parametrize("rates", [(0.0, 0.0, 0.0), (-8e3, 3e5, -5e6)])
@pytest.mark.parametrize("spin_up", [0.0, 300.0])
def test_the_step_does_not_depend_on_how_it_is_divided(friction_of, spin_up, rates):
    method = friction_of(replace(BODY, sliders=SLIDERS))
    excitation = Excitation(NO_FORCE, 0.3, 150.0, (spin_up, *rates))
    start = [2e-4, 1e-4, -1e-4, 2e-4, 0.05, 0.01, -0.02, 0.04]
    once, often = (run(method, start, 0.1, steps, excitation)[-1] for steps in (3, 211))
    np.testing.assert_allclose(once[0], often[0], atol=1e-11 * np.abs(once[0]).max())
    np.testing.assert_allclose(once[1], often[1], atol=1e-9)


@pytest.mark.parametrize(
    ("coefficients", "expected"),
    [
        ([1.0, -2.0], 0.5),
        ([0.0, -1.0], 0.0),  # has just reached the limit
        ([0.0, 1.0, -2.0], 0.5),  # leaves it and comes back
        ([0.0, 1e-17, 0.3, -1.0], 0.3),  # but for rounding, too
        ([0.0, -1e-17, 0.3, -1.0], 0.3),
        ([0.250001, -1.0, 1.0], math.inf),  # all but touches
        ([0.24, -1.0, 1.0], 0.4),  # a dip between
        ([0.0, 0.0, 0.0], math.inf),
    ],
)
def test_first_fall_of_a_polynomial(core, coefficients, expected):
    rounding = np.array([0.0, 1e-15, 0.0])
    found = core("find_first_fall", np.array(coefficients), len(coefficients), 1.0, rounding)
    assert found == pytest.approx(expected, abs=1e-14)
