"""Laws that every collision of touching weights keeps, for any rates (Moreau's impact law)."""

from __future__ import annotations

import cmath
import math
from itertools import pairwise

import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from autobalancer.models.contact.contact import Pools, collide, expand, pool, strike
from autobalancer.models.contact.motion import advance
from autobalancer.models.contact.track import Track
from autobalancer.models.weights import Weights

RATES = st.lists(
    st.floats(-100.0, 100.0).filter(lambda v: v == 0.0 or abs(v) > 1e-6), min_size=2, max_size=12
)
RESTITUTION = st.one_of(st.sampled_from([0.0, 1.0]), st.floats(0.0, 1.0))


def collided(rates, restitution):
    after = list(rates)
    collide(after, len(after), restitution, Pools(len(after)))
    return after


def size_of(rates):
    return max(map(abs, rates)) or 1.0


@given(RATES, RESTITUTION)
def test_the_sum_of_rates_is_kept(rates, restitution):
    after = collided(rates, restitution)
    assert math.fsum(after) == pytest.approx(math.fsum(rates), abs=1e-11 * size_of(rates))


@given(RATES, RESTITUTION)
def test_energy_does_not_grow(rates, restitution):
    before, after = (math.fsum(v * v for v in r) for r in (rates, collided(rates, restitution)))
    assert after <= before * (1.0 + 1e-12)


@given(RATES)
def test_elastic_collisions_keep_the_energy(rates):
    before, after = (math.fsum(v * v for v in r) for r in (rates, collided(rates, 1.0)))
    assert after == pytest.approx(before, rel=1e-9)


@given(RATES, RESTITUTION)
def test_nobody_runs_into_the_next_one_afterwards(rates, restitution):
    after = collided(rates, restitution)
    slack = 1e-11 * size_of(rates)
    assert all(second >= first - slack for first, second in pairwise(after))


@given(RATES, RESTITUTION)
def test_weights_that_do_not_approach_are_left_alone(rates, restitution):
    assert collided(sorted(rates), restitution) == sorted(rates)


@given(st.floats(-10.0, 10.0), st.floats(-10.0, 10.0), RESTITUTION)
def test_a_pair_leaves_with_newtons_restitution(first, second, restitution):
    assume(first - second > 1e-3)
    after = collided([first, second], restitution)
    assert after[1] - after[0] == pytest.approx(restitution * (first - second), abs=1e-12)


@given(RATES, RESTITUTION)
def test_the_mirror_image_of_a_collision_is_the_collision_of_the_mirror_image(rates, restitution):
    mirrored = [-v for v in reversed(rates)]
    expected = [-v for v in reversed(collided(rates, restitution))]
    assert collided(mirrored, restitution) == pytest.approx(expected, abs=1e-9 * size_of(rates))


@given(RATES, st.floats(0.0, 3.0))
def test_the_rotor_is_struck_by_what_the_weights_lose(rates, angle):
    """m R sum i v e^{i theta} is the momentum of the weights in the rotor."""
    angles = [angle + 0.1 * k for k in range(len(rates))]
    after = collided(rates, 0.5)
    changes = [b - a for a, b in zip(rates, after, strict=True)]
    before, end = (
        sum(0.3j * v * cmath.exp(1j * x) for x, v in zip(angles, r, strict=True))
        for r in (rates, after)
    )
    assert strike(0.3, angles, changes) == pytest.approx(before - end, abs=1e-10 * size_of(rates))


@given(RATES, st.data())
def test_pooled_accelerations_ascend_and_keep_the_sum_of_the_drives(drives, data):
    n = len(drives)
    limits = data.draw(st.lists(st.floats(0.0, 50.0), min_size=n, max_size=n))
    pools, free, held = Pools(n), [0.0] * n, [0.0] * n
    pool(pools, drives, None, n, 0.0)
    expand(pools, free)
    assert math.fsum(free) == pytest.approx(math.fsum(drives), abs=1e-11 * size_of(drives))
    pool(pools, drives, limits, n, 0.0)
    expand(pools, held)
    for values in (free, held):
        assert values == sorted(values)
    # resistance never drives
    assert max(map(abs, held)) <= max(map(abs, free)) + 1e-12


@given(
    st.lists(st.floats(0.0, 1.0), min_size=2, max_size=6),
    st.lists(st.floats(-3.0, 3.0), min_size=6, max_size=6),
    st.floats(0.0, 0.9),
    st.floats(0.0, 5.0),
)
# weights meet after a time whose cube is not told from 0
@example([0.0, 4.39906940434022e-08, 0.0], [0.0, 2.027278654931918e-287, 0.0] + [0.0] * 3, 0.0, 1.0)
def test_the_order_on_the_track_is_kept(gaps, rates, restitution, pull):
    n = len(gaps)
    track = Track(Weights(n, 0.1, 1.0, 0.05, 1.4), 0.15, restitution)
    room = math.tau / n - 2.0 * track.alpha
    angles = [2.0 * track.alpha * k + room * math.fsum(gaps[:k]) for k in range(n)]
    moved = advance(track, angles, rates[:n], [0.0] * n, (complex(pull), 0j, 0j, 0j), 3.0, 0.0, 0.2)
    following = [*moved.angles[1:], moved.angles[0] + math.tau]
    for here, after in zip(moved.angles, following, strict=True):
        assert after - here >= 2.0 * track.alpha - 1e-12
