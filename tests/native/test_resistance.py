"""Rolling resistance and track offset against closed forms and SciPy's event integration."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from scipy.integrate import solve_ivp

from autobalancer.models.weights import Weights
from tests.native.equations import STEADY, run, whirling

CHANGING = (3.0, -8.0, 5.0)  # derivatives of w' of order 1 to 3


def still(t):
    return (0j, 0j, 0j, 0j)


def by_scipy(track, angle, rate, signal, speed, seconds):
    """One weight: slide, stick and break away, phase by phase."""
    weights = track.weights
    d, k_r = weights.damping_rate, weights.kappa * weights.track_radius
    mu, radius = track.rolling_resistance, weights.track_radius

    def parts(t, x, v):
        z = signal(t)[0] * cmath.exp(-1j * x)
        return -z.imag / k_r, mu / k_r * abs(radius * (speed + v) ** 2 - z.real)

    t, y, changes = 0.0, [angle, rate], 0
    while t < seconds - 1e-12:
        g, f = parts(t, y[0], 0.0)
        if y[1] == 0.0 and abs(g) <= f * (1 + 1e-9):
            x = y[0]

            def held(t, y, x=x):
                g, f = parts(t, x, 0.0)
                return f * (1 + 1e-9) - abs(g)

            held.terminal, held.direction = True, -1
            found = solve_ivp(
                lambda t, y: [0.0, 0.0], (t, seconds), y, events=held, max_step=0.01, rtol=1e-12
            )
        else:
            sign = math.copysign(1.0, y[1] or g)

            def rhs(t, y, sign=sign):
                g, f = parts(t, *y)
                return [y[1], g - sign * f - d * y[1]]

            def rest(t, y):
                return y[1]

            rest.terminal, rest.direction = True, -sign
            found = solve_ivp(
                rhs, (t, seconds), y, "DOP853", events=rest, rtol=1e-12, atol=1e-14, max_step=0.05
            )
        t, y = found.t[-1], found.y[:, -1].tolist()
        if found.status == 1:
            changes += 1
            if len(found.t_events[0]) and abs(y[1]) < 1e-9:
                y[1] = 0.0
    return y[0], y[1], changes


def test_constant_resistance_stops_a_weight_where_the_closed_form_says(track_of):
    """No forcing, no drag: v' = -(mu/kappa)(w + v)^2, so 1/(w + v) grows linearly until v = 0."""
    mu, kappa, w, v0 = 0.05, 1.4, 3.0, 0.4
    track = track_of(Weights(1, 0.1, 1.0, 0.0, kappa), rolling_resistance=mu)
    c = mu / kappa
    stop = (1 / w - 1 / (w + v0)) / c
    way = math.log((w + v0) / w) / c - w * stop
    before = run(track, [0.2], [v0], still, w, 0.6 * stop, 12)
    assert before[1][0] == pytest.approx(1 / (1 / (w + v0) + c * 0.6 * stop) - w, rel=1e-9)
    after = run(track, [0.2], [v0], still, w, 3.0 * stop, 40)
    assert after[1] == [0.0]
    assert after[0][0] == pytest.approx(0.2 + way, rel=1e-9)
    assert after[4] == 1


@pytest.mark.parametrize("drag", [0.0, 0.05])
def test_stick_and_slip_fall_where_an_independent_event_integration_finds_them(track_of, drag):
    track = track_of(Weights(1, 0.1, 1.0, drag, 1.4), rolling_resistance=0.03)
    signal = whirling(0.8, 1.1)
    x, v, changes = by_scipy(track, 0.4, 0.3, signal, 3.0, 9.0)
    found = run(track, [0.4], [0.3], signal, 3.0, 9.0, 900)
    assert changes >= 3
    assert found[4] == changes
    assert found[0][0] == pytest.approx(x, abs=3e-7)
    assert found[1][0] == pytest.approx(v, abs=3e-7)


def test_a_weight_in_the_dead_zone_does_not_creep_at_all(track_of):
    w, mu = 3.0, 0.01
    track = track_of(Weights(3, 0.1, 1.0, 0.05, 1.4), rolling_resistance=mu)
    pull = (0.4 + 0j, 0j, 0j, 0j)
    # edge of the dead zone about x = 0: 0.4 sin(x) + mu 0.4 cos(x) = mu w^2
    edge = math.asin(mu * w**2 / (0.4 * math.hypot(1.0, mu))) - math.atan(mu)
    start = [0.5 * edge, -0.99 * edge, edge - 1e-5]
    angles, speeds, *_, events = run(track, start, [0.0] * 3, lambda t: pull, w, 1000.0, 500)
    assert angles == start  # to the last digit
    assert (speeds, events) == ([0.0] * 3, 0)
    outside = run(track, [edge + 1e-5, 1.0, 2.0], [0.0] * 3, lambda t: pull, w, 1.0, 10)
    assert outside[1][0] != 0.0


def test_resting_weights_break_away_at_the_edge_of_the_dead_zone(track_of):
    """A forcing that grows linearly: the time of breaking away is a root of a linear equation."""
    w, mu = 3.0, 0.02
    track = track_of(Weights(1, 0.1, 1.0, 0.0, 1.0), rolling_resistance=mu)
    when = mu * w**2  # at x = pi/2 the signal a = t drives by t and does not load

    def grow(t):
        return (complex(t), 1 + 0j, 0j, 0j)

    assert run(track, [math.pi / 2], [0.0], grow, w, when - 1e-9, 7)[1] == [0.0]
    late = 0.03
    found = run(track, [math.pi / 2], [0.0], grow, w, when + late, 7)
    # x'' = t - when - 2 mu w x' to leading order
    assert found[1][0] == pytest.approx(late**2 / 2, rel=5e-3)


def test_a_row_of_resting_weights_holds_until_one_end_can_move(track_of):
    w, mu, alpha = 3.0, 0.02, 0.2
    weights = Weights(3, 0.1, 1.0, 0.0, 1.4)
    track = track_of(weights, math.sin(alpha), 0.0, mu)
    middle = 0.02  # near the angle from which an acceleration along 0 drives away
    angles = [middle - 2 * alpha, middle, middle + 2 * alpha]

    def held(pull):
        drives = [pull * math.sin(x) / 1.4 for x in angles]
        limits = [mu / 1.4 * abs(w * w - pull * math.cos(x)) for x in angles]
        ends = [sum(limits[:k]) + sum(drives[:k]) for k in (1, 2, 3)]
        ends += [sum(limits[k:]) - sum(drives[k:]) for k in (0, 1, 2)]
        return min(ends) > 0.0

    for pull in np.linspace(0.05, 1.0, 20):
        signal = (complex(pull), 0j, 0j, 0j)
        found = run(track, angles, [0.0] * 3, lambda t, s=signal: s, w, 0.2, 4, [1.0, 1.0, 0.0])
        assert (found[1] == [0.0] * 3) == held(pull)
        if held(pull):
            assert found[0] == angles
    assert held(0.05)
    assert not held(1.0)


@pytest.mark.parametrize("x", [0.01, -0.01])
def test_a_weight_pressed_to_the_inner_wall_rests_within_its_dead_zone(track_of, x):
    """Its track falls away faster than it turns: the load w^2 - a cos(x) is below 0."""
    w, mu = 3.0, 0.02
    track = track_of(Weights(1, 0.1, 1.0, 0.0, 1.4), rolling_resistance=mu)
    rests = []
    for pull in (12.0, 15.0, 17.0, 19.0, 25.0, 40.0):
        signal = (complex(pull), 0j, 0j, 0j)
        rests.append(mu * abs(w**2 - pull * math.cos(x)) > pull * abs(math.sin(x)))
        angles, speeds, *_ = run(track, [x], [0.0], lambda t, s=signal: s, w, 0.1, 4)
        assert (angles == [x], speeds == [0.0]) == (rests[-1], rests[-1])
    assert rests == [False, False, False, True, True, True]


@pytest.mark.parametrize(("offset", "resistance", "rates", "packed"), [
    (0.03 - 0.02j, 0.08, STEADY, False), (0.03 - 0.02j, 0.0, CHANGING, False),
    (0j, 0.0, CHANGING, False), (0.03 - 0.02j, 0.0, STEADY, True),
])  # fmt: skip
def test_force_of_weights_is_that_of_their_moment(track_of, offset, resistance, rates, packed):
    """Sliding, resting, touching, off centre, as w' changes: F = -(d/dt)^2 of the moment."""
    weights, radius = Weights(3 if packed else 2, 0.1, 1.0, 0.02, 1.4), 0.25 if packed else 0.0
    track = track_of(weights, radius, rolling_resistance=resistance, offset=offset)
    w, spin, h, signal = 3.0, 0.2, 2e-3, whirling(0.3, 0.9)
    turning = Polynomial([w, spin, *np.array(rates) / [2, 6, 24]])  # the speed, by time
    state, moments, forces = ([0.1, 2.0], [0.0, 0.5], [0.0, 0.0]), [], []
    if packed:
        state = [2.8 + 2.0 * k * track.alpha for k in range(3)], [0.3] * 3, [1.0, 1.0, 0.0]
    touching = list(state[2])
    for k in range(7):
        t = k * h
        speed, spin_up, change = (float(turning.deriv(j)(t)) for j in range(3))
        turn = cmath.exp(1j * turning.integ()(t))
        moments.append(track.static_moment(state[0]) * turn)
        force, slope = track.reaction(*state, *signal(t)[:2], speed, spin_up, change)
        forces.append((force * turn, (slope + 1j * speed * force) * turn))
        now = [float(turning.deriv(j)(t)) for j in (2, 3, 4)]
        state = track.advance(*state, signal(t), speed, spin_up, h, now)[:3]
    assert state[2] == touching
    if resistance:
        assert state[1][0] == 0.0
        assert state[1][1] > 0.1
    second = (-moments[5] + 16 * moments[4] - 30 * moments[3] + 16 * moments[2] - moments[1]) / 12
    assert forces[3][0] == pytest.approx(-second / h**2, rel=1e-7)
    slope = (forces[1][0] - 8 * forces[2][0] + 8 * forces[4][0] - forces[5][0]) / (12 * h)
    assert forces[3][1] == pytest.approx(slope, rel=1e-6)


def test_sliding_keeps_order_four_between_events(track_of):
    track = track_of(Weights(1, 0.1, 1.0, 0.05, 1.4), rolling_resistance=0.03)
    signal = whirling(0.8, 1.1)
    exact = by_scipy(track, 0.4, 0.3, signal, 3.0, 9.0)
    errors = [
        abs(run(track, [0.4], [0.3], signal, 3.0, 9.0, n)[0][0] - exact[0]) for n in (15, 30, 60)
    ]
    assert errors[0] / errors[1] > 8.0
    assert errors[1] / errors[2] > 8.0


def test_an_offset_track_leaves_its_centre_on_the_axis_of_rotation(track_of):
    """Planar rotor above its critical speed: at rest in the rotor frame where z = -offset."""
    mass, stiffness, damping, w = 0.9, 1.0, 0.3, 3.0
    weights, offset, unbalance = Weights(2, 0.05, 1.0, 0.05, 1.4), 0.004 + 0.003j, 0.03
    track, z = track_of(weights, offset=offset), -offset
    # force on the rotor: unbalance + weights' moment - spring - damper - inertia = 0
    dynamic = stiffness - w**2 * (mass + weights.added_mass) + 1j * w * damping
    moment = dynamic * z / w**2 - unbalance - weights.added_mass * offset
    half, middle = math.acos(abs(moment) / 0.1), cmath.phase(moment)
    angles = [middle - half, middle + half]
    acceleration = -(w**2) * z
    force, slope = track.reaction(angles, [0, 0], [0, 0], acceleration, 0j, w, 0.0)
    assert force + unbalance * w**2 == pytest.approx(dynamic * z, abs=1e-14)
    assert abs(slope) < 1e-14
    moved = track.advance(angles, [0, 0], [0, 0], (acceleration, 0j, 0j, 0j), w, 0.0, 1.0)
    assert moved.angles == pytest.approx(angles, abs=1e-14)
    plain = track_of(weights)
    moved = plain.advance(angles, [0, 0], [0, 0], (acceleration, 0j, 0j, 0j), w, 0.0, 1.0)
    assert abs(moved.angles[0] - angles[0]) > 1e-3


def test_very_large_drag_needs_no_smaller_steps(track_of):
    """Drag 1e6: the weight creeps with (g - sign c n)/d while forcing exceeds resistance."""
    track = track_of(Weights(1, 0.1, 1.0, 1.4e5, 1.4), rolling_resistance=0.02)
    pull = (1.0 + 0j, 0j, 0j, 0j)
    found = run(track, [1.0], [0.0], lambda t: pull, 3.0, 10.0, 50)
    creep = (math.sin(1.0) - 0.02 * (9.0 - math.cos(1.0))) / 1.4 / 1e6
    assert found[0][0] - 1.0 == pytest.approx(10.0 * creep, rel=1e-4)
