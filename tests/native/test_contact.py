"""Contacts against event integrations by SciPy, conservation laws and known packed positions."""

from __future__ import annotations

import cmath
import math
import random

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from autobalancer.models.papers.capacity import packed_angles
from autobalancer.models.weights import Weights
from tests.native.equations import discharge, run, whirling

pytestmark = pytest.mark.slow


def by_scipy(track, angles, speeds, signal, seconds):
    """Angles and rates by DOP853 between collisions of pairs, each located by SciPy."""
    weights, n, gap0 = track.weights, track.weights.count, 2.0 * track.alpha
    d, scale = weights.damping_rate, -1.0 / (weights.kappa * weights.track_radius)

    def rhs(t, y):
        a = signal(t)[0]
        bends = [
            scale * (a * cmath.exp(-1j * x)).imag - d * v for x, v in zip(y[:n], y[n:], strict=True)
        ]
        return [*y[n:], *bends]

    def gap(k):
        def event(t, y):
            ahead = y[k + 1] if k + 1 < n else y[0] + 2 * math.pi
            return ahead - y[k] - gap0

        event.terminal, event.direction = True, -1
        return event

    t, y, hits = 0.0, [*angles, *speeds], 0
    while t < seconds:
        found = solve_ivp(
            rhs, (t, seconds), y, "DOP853", events=[gap(k) for k in range(n)], rtol=1e-12,
            atol=1e-13, max_step=0.05,
        )  # fmt: skip
        t, y = found.t[-1], found.y[:, -1].tolist()
        for k, times in enumerate(found.t_events):
            if len(times):
                hits += 1
                i, j = n + k, n + (k + 1) % n
                mean, half = (y[i] + y[j]) / 2.0, (y[i] - y[j]) / 2.0 * track.restitution
                y[i], y[j] = mean - half, mean + half
    return y[:n], y[n:], hits


@pytest.mark.parametrize("restitution", [1.0, 0.6])
def test_collisions_fall_where_an_independent_event_integration_finds_them(track_of, restitution):
    track = track_of(Weights(3, 0.1, 1.0, 0.02, 1.4), 0.25, restitution)
    angles, speeds, signal = [0.5, 2.0, 4.0], [1.2, -0.8, -1.5], whirling(0.4, 0.9, 0.2)
    x, v, hits = by_scipy(track, angles, speeds, signal, 6.0)
    found = run(track, angles, speeds, signal, 3.0, 6.0, 600)
    assert hits == found[4] >= 4
    assert found[0] == pytest.approx(x, abs=1e-7)
    assert found[1] == pytest.approx(v, abs=1e-7)


def test_motion_between_collisions_keeps_order_four(track_of):
    track = track_of(Weights(3, 0.1, 1.0, 0.02, 1.4), 0.25, 0.8)
    angles, speeds, signal = [0.5, 2.0, 4.0], [0.3, -0.1, -0.3], whirling(0.2, 2.0)
    exact = by_scipy(track, angles, speeds, signal, 12.0)
    assert exact[2] >= 2
    errors = []
    for steps in (20, 40, 80):
        found = run(track, angles, speeds, signal, 3.0, 12.0, steps)
        errors.append(max(abs(a - b) for a, b in zip(found[0], exact[0], strict=True)))
    assert errors[0] / errors[1] > 10.0
    assert errors[1] / errors[2] > 10.0


@pytest.mark.parametrize(("resistance", "rate"), [(0.0, 0.0), (0.03, 0.8)])
def test_a_plastic_pair_moves_as_one_until_it_is_pulled_apart(track_of, resistance, rate):
    """Driven by 0.5 e^{0.9 i t}: the pair opens where the pressure of its two weights ends."""
    track = track_of(Weights(2, 0.1, 1.0, 0.3, 1.4), 0.25, 0.0, resistance)
    signal = whirling(0.5, 0.9)
    reach, d = 2 * track.alpha, track.weights.damping_rate
    start = [3.0, 3.0 + reach]
    factor = math.cos(track.alpha)

    def seen(t, y):
        return signal(t)[0] * cmath.exp(-1j * y[0])

    def rhs(t, y):  # the pair slides forward; the race carries it on its outer side
        z = factor * seen(t, y)
        load = (3.0 + y[1]) ** 2 - z.real
        return [y[1], -(z.imag + resistance * load) / 1.4 - d * y[1]]

    def pressure(t, y):  # drive of the first less that of the second, over two
        return seen(t, y).real + resistance * seen(t, y).imag

    # weights turn to where the driven force pulls them together (Re < 0) until the signal turns
    pressure.terminal, pressure.direction = True, 1
    alone = solve_ivp(
        rhs, (0, 60), [3.0 + track.alpha, rate], "DOP853", events=pressure, rtol=1e-12, atol=1e-13
    )
    opened = alone.t[-1]
    assert 0.5 < opened < 20.0
    assert resistance == 0.0 or alone.y[1].min() > 0.0
    before = run(track, start, [rate] * 2, signal, 3.0, opened - 1e-6, 100, [1.0, 0.0])
    assert before[2] == [1.0, 0.0]
    middle = (before[0][0] + before[0][1]) / 2.0
    assert middle == pytest.approx(alone.y[0, -1], abs=1e-5)
    assert before[0][1] - before[0][0] == pytest.approx(reach, abs=1e-12)
    after = run(track, start, [rate] * 2, signal, 3.0, opened + 0.2, 100, [1.0, 0.0])
    assert after[2] == [0.0, 0.0]
    assert after[0][1] - after[0][0] > reach + 1e-5


def test_bouncing_comes_to_an_end_in_contact(track_of):
    """Two elastic-enough weights driven together: infinitely many bounces in finite time."""
    track = track_of(Weights(2, 0.1, 1.0, 0.0, 1.0), 0.25, 0.5)
    pressed = (1.0 + 0j, 0j, 0j, 0j)  # the drive -Im(a e^{-i x}) pulls to the angle pi
    x, v, contacts, _, events = run(
        track, [math.pi - 0.6, math.pi + 0.6], [0.0, 0.0], lambda t: pressed, 3.0, 6.0, 60
    )
    assert contacts == [1.0, 0.0]
    assert 10 < events < 60
    assert v == pytest.approx([0.0, 0.0], abs=1e-12)
    assert x == pytest.approx([math.pi - track.alpha, math.pi + track.alpha], abs=1e-12)


def test_sixty_four_packed_weights_stay_packed(track_of):
    weights = Weights(64, 0.01, 1.0, 0.005, 1.4)
    radius = math.sin(math.pi / 128)  # half of the track
    track = track_of(weights, radius, 0.7)
    start = packed_angles(weights, radius, 0.3)
    toward = lambda t: (cmath.rect(0.5, 0.3), 0j, 0j, 0j)  # noqa: E731
    contacts = [1.0] * 63 + [0.0]
    angles, speeds, contacts, impulse, events = run(
        track, start, [0.0] * 64, toward, 3.0, 20.0, 200, contacts
    )
    assert contacts == [1.0] * 63 + [0.0]
    assert (events, impulse) == (0, 0j)
    assert angles == pytest.approx(start, abs=1e-12)
    assert speeds == pytest.approx([0.0] * 64, abs=1e-12)


def test_weights_thrown_together_stand_at_the_packed_angles(track_of):
    """At the place where the acceleration of an unbalance that is too large drives them."""
    weights = Weights(5, 0.1, 1.0, 0.1, 1.4)
    track = track_of(weights, 0.2, 0.4)
    angles, _, contacts, _, _ = run(
        track, [0.1, 1.3, 2.6, 3.8, 5.0], [0.0] * 5,
        lambda t: (cmath.rect(2.0, 0.7), 0j, 0j, 0j), 3.0, 80.0, 800,
    )  # fmt: skip
    assert sum(contacts) == 4.0
    expected = packed_angles(weights, 0.2, 0.7)
    turned = sorted((x - expected[0] + 0.1) % math.tau for x in angles)
    assert turned == pytest.approx([x - expected[0] + 0.1 for x in expected], abs=1e-8)


def test_a_full_track_turns_as_one_body_under_drag_alone(track_of):
    n = 6
    track = track_of(Weights(n, 0.1, 1.0, 0.14, 1.4), math.sin(math.pi / n), 0.5)
    start = [0.4 + math.tau * k / n for k in range(n)]
    angles, speeds, contacts, _, _ = run(track, start, [0.5] * n, whirling(4.0, 1.0), 3.0, 2.0, 20)
    assert contacts == [1.0] * n
    assert speeds == pytest.approx([0.5 * math.exp(-2.0)] * n, rel=1e-12)
    turned = 0.5 * (1.0 - math.exp(-2.0))
    assert angles == pytest.approx([x + turned for x in start], rel=1e-12)


def test_impulse_and_force_together_account_for_the_momentum_of_the_weights(track_of):
    """Integral of F over a run with collisions and bounces equals the change of momentum."""
    track = track_of(Weights(3, 0.1, 1.0, 0.02, 1.4), 0.25, 0.6)
    signal, w = whirling(0.4, 0.9, 0.2), 3.0

    def momentum(state, t):
        total = sum(
            1j * (v + w) * cmath.exp(1j * (x + w * t))
            for x, v in zip(state[0], state[1], strict=True)
        )
        return 0.1 * total

    state, h = ([0.5, 2.0, 4.0], [1.2, -0.8, -1.5], [0.0] * 3), 2.5e-4
    first, smooth, blows = momentum(state, 0.0), 0j, 0j
    for k in range(12000):
        turn = cmath.exp(1j * w * k * h), cmath.exp(1j * w * (k + 1) * h)
        begin = track.reaction(*state, *signal(k * h)[:2], w, 0.0)[0] * turn[0]
        moved = track.advance(*state, signal(k * h), w, 0.0, h)
        state = moved.angles, moved.speeds, moved.contacts
        end = track.reaction(*state, *signal((k + 1) * h)[:2], w, 0.0)[0] * turn[1]
        smooth += 0.5 * h * (begin + end)
        blows += moved.impulse * turn[1]
    change = momentum(state, 3.0) - first
    assert abs(blows) > 0.02  # without it the account would be off by this
    # the trapezoidal rule errs by half a step of the force's jump, at most 1 N, at each collision
    assert smooth + blows == pytest.approx(-change, abs=0.5 * h * 1.0)


LOBES = [(2, 0.03, 0.3)]


@pytest.mark.parametrize(
    ("offset", "lobes", "mobility"),
    [(0j, (), 0.0), (0.03 - 0.02j, (), 0.0), (0.03 - 0.02j, LOBES, 0.0), (0.1 + 0.05j, (), 0.4)],
    ids=["centred", "off-centre", "lobes", "plane that gives way"],
)
def test_impulses_on_the_shaft_account_for_the_angular_momentum_of_the_weights(
    track_of, offset, lobes, mobility
):
    """A weight at y from the plane's centre turns the rotor by

        T = -m Im(y* (A + y'')) + (kappa - 1) m r eta',   eta = l theta' - r w,

    by its force on the race and the moment of momentum that its body has.  Over a step T h and the
    impulse are what y and eta change by.  A plane that gives way to the impulse J also gains
    `mobility` J; that part of T is in the impulse.
    """
    mass, own = np.array([0.1, 0.06, 0.15]), np.array([0.25, 0.2, 0.1])
    kappa, w = 1.4, 3.0
    weights = Weights(3, 0.1, 1.0, 0.02, kappa, 0.25, tuple(mass), (), tuple(own))
    track = track_of(weights, 0.25, 0.6, offset=offset, lobes=lobes, mobility=mobility)
    signal = whirling(0.4, 0.9, 0.2)

    def moved_by(state):
        """Of each weight in the rotor's axes: y, its velocity, and eta."""
        x, v = np.array(state[0]), np.array(state[1])
        rho, slope = np.ones(3), np.zeros(3)
        for n, size, at in lobes:
            rho, slope = rho + size * np.cos(n * (x - at)), slope - n * size * np.sin(n * (x - at))
        unit = np.exp(1j * x)
        y = offset + rho * unit
        along = (slope + 1j * rho) * unit
        return y, along * v + 1j * w * y, np.abs(along) * v - own * w

    def momentum(state):
        y, velocity, eta = moved_by(state)
        return np.sum(mass * ((y.conj() * velocity).imag - (kappa - 1.0) * own * eta))

    state, h = ([0.5, 2.0, 4.0], [1.2, -0.8, -1.5], [0.0] * 3), 1e-3
    told, given, blows = 0.0, 0.0, []
    first = momentum(state)
    for k in range(3000):
        ends = []
        for i in (0, 1):
            a = signal((k + i) * h)
            pulled = np.sum(mass * (moved_by(state)[0].conj() * a[0]).imag)
            ends.append(track.torque(*state, *a[:2], w, 0.0) + pulled)
            if not i:
                moved = track.advance(*state, a, w, 0.0, h)
                state = moved.angles, moved.speeds, moved.contacts
        told += 0.5 * h * sum(ends)
        if moved.impulse:
            answer = mobility * moved.impulse
            given += np.sum(mass * (moved_by(state)[0].conj() * answer).imag)
            blows.append(moved.turning)
    assert len(blows) >= 3
    assert abs(sum(blows)) > 5e-4
    change = momentum(state) - first + given
    # the trapezoidal rule errs by half a step of the torque's jump at a collision, some 0.01 N m
    assert told + sum(blows) == pytest.approx(-change, abs=3e-5)


def test_a_collision_on_a_race_with_faint_lobes_strikes_the_rotor_as_on_a_circle(track_of):
    weights, state = Weights(2, 0.1, 1.0, 0.02, 1.4), ([0.5, 1.1], [1.2, -0.8], [0.0, 0.0])
    struck = []
    for lobes in ((), [(3, 1e-9, 0.4)]):
        track = track_of(weights, 0.25, 0.6, lobes=lobes)
        moved = track.advance(*state, [0.4, 0.1, 0.0, 0.0], 3.0, 0.0, 0.1)
        assert moved.events == 1
        struck.append((moved.impulse, moved.turning))
    assert abs(struck[0][0]) > 0.01
    assert struck[1] == pytest.approx(struck[0], rel=1e-6, abs=1e-9)


def test_after_a_collision_within_a_step_the_speed_goes_on_changing(track_of):
    """One step over a speed whose rate changes, and many: the rate is told anew in each of them."""
    track = track_of(Weights(2, 0.1, 1.0, 0.5, 1.4), 0.25, 0.6)
    start, rates, seconds = ([0.5, 1.1], [1.2, -0.8], [0.0, 0.0]), [1.0, 40.0, -90.0, 300.0], 0.2

    def told(t):
        w = 3.0 + sum(r * t ** (k + 1) / math.factorial(k + 1) for k, r in enumerate(rates))
        return w, *(
            sum(r * t**k / math.factorial(k) for k, r in enumerate(rates[j:])) for j in range(4)
        )

    once = track.advance(*start, [0.0] * 4, told(0.0)[0], rates[0], seconds, rates[1:])
    assert once.events == 1
    state, steps = start, 100
    for k in range(steps):
        w, first, *rest = told(k * seconds / steps)
        moved = track.advance(*state, [0.0] * 4, w, first, seconds / steps, rest)
        state = moved.angles, moved.speeds, moved.contacts
    assert once.angles == pytest.approx(state[0], abs=1e-10)
    assert once.speeds == pytest.approx(state[1], abs=1e-10)


def test_pulses_give_the_rotor_exactly_what_is_owed_whatever_the_steps(core):
    rng = random.Random(3)
    w, owed, pulse, given, struck = 3.0, 0j, 0j, 0j, 0j
    t = 0.0
    for k in range(40):
        h = rng.uniform(0.02, 0.2)
        impulse = complex(rng.gauss(0, 1), rng.gauss(0, 1)) if k in (3, 4, 9) else 0j
        begin, start = pulse, t
        t += h
        owed, pulse = discharge(core, owed, pulse, impulse, w * h, h)
        struck += impulse * cmath.exp(1j * w * t)

        def force(s, begin=begin, start=start, end=pulse, h=h):
            hat = s * s * (3 - 2 * s)
            return (begin * (1 - hat) + end * hat) * cmath.exp(1j * w * (start + s * h))

        nodes, shares = np.polynomial.legendre.leggauss(12)
        given += h / 2 * sum(c * force((x + 1) / 2) for x, c in zip(nodes, shares, strict=True))
    assert abs(struck) > 0.1
    assert abs(owed) < 1e-9
    assert given == pytest.approx(struck, abs=1e-9)
    half = core("hat_half", 0.0)
    assert complex(half.re, half.im) == pytest.approx(0.5)
