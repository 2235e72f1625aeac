"""Laws that every collision of touching weights keeps, for any rates (Moreau's impact law)."""

from __future__ import annotations

import math

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from autobalancer.models.weights import Weights

RATES = st.lists(
    st.floats(-100.0, 100.0).filter(lambda v: v == 0.0 or abs(v) > 1e-6), min_size=2, max_size=12
)
STILL, MOMENT = (0j, 0j, 0j, 0j), 1e-9  # s: nothing else happens in it
RESTITUTION = st.one_of(st.sampled_from([0.0, 1.0]), st.floats(0.0, 1.0))


ALPHA = 0.15  # half the angle between weights that touch [rad]


@pytest.fixture(scope="session")
def collided(track_of):
    """Rates of a row of touching weights on a rotor that is held, just behind their collisions."""

    def move(rates, restitution):
        n = len(rates)
        track = track_of(Weights(n, 0.3, 1.0), math.sin(ALPHA), restitution)
        angles = [2.0 * ALPHA * k for k in range(n)]
        return track.advance(angles, rates, [0.0] * n, STILL, 0.0, 0.0, MOMENT).speeds

    return move


def size_of(rates):
    return max(map(abs, rates)) or 1.0


@given(RATES, RESTITUTION)
def test_weights_that_do_not_approach_are_left_alone(collided, rates, restitution):
    assert collided(sorted(rates), restitution) == sorted(rates)


@given(RATES, RESTITUTION)
def test_the_mirror_image_of_a_collision_is_the_collision_of_the_mirror_image(
    collided, rates, restitution
):
    mirrored = [-v for v in reversed(rates)]
    expected = [-v for v in reversed(collided(rates, restitution))]
    assert collided(mirrored, restitution) == pytest.approx(expected, abs=1e-9 * size_of(rates))


@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
def test_blows_from_both_sides_at_once_are_answered_symmetrically(collided, restitution):
    found = collided([1.0, 0.0, -1.0], restitution)
    assert found == pytest.approx([-restitution, 0.0, restitution], abs=1e-12)


def test_a_row_of_elastic_weights_takes_the_blow_as_one(collided):
    """All pairs that touch take part at once: no Newton's cradle, whose balls do not touch."""
    found = collided([1.0, 0.0, 0.0, 0.0], 1.0)
    assert found == pytest.approx([-0.5, 0.5, 0.5, 0.5])


@settings(derandomize=True)  # some drawn motions take minutes
@given(
    st.lists(st.floats(0.0, 1.0), min_size=2, max_size=6),
    st.lists(st.floats(-3.0, 3.0), min_size=6, max_size=6),
    st.floats(0.0, 0.9),
    st.floats(0.0, 5.0),
)
# weights meet after a time whose cube is not told from 0
@example([0.0, 4.39906940434022e-08, 0.0], [0.0, 2.027278654931918e-287, 0.0] + [0.0] * 3, 0.0, 1.0)
def test_the_order_on_the_track_is_kept(track_of, gaps, rates, restitution, pull):
    n = len(gaps)
    track = track_of(Weights(n, 0.1, 1.0, 0.05, 1.4), 0.15, restitution)
    room = math.tau / n - 2.0 * track.alpha
    angles = [2.0 * track.alpha * k + room * math.fsum(gaps[:k]) for k in range(n)]
    moved = track.advance(angles, rates[:n], [0.0] * n, (complex(pull), 0j, 0j, 0j), 3.0, 0.0, 0.2)
    following = [*moved.angles[1:], moved.angles[0] + math.tau]
    for here, after in zip(moved.angles, following, strict=True):
        assert after - here >= 2.0 * track.alpha - 1e-12
