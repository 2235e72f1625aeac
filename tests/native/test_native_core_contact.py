"""What the functions of a track answer to: changes of the force, early ends, refusals."""

from __future__ import annotations

import math

import numpy as np
import pytest

from autobalancer.models.weights import Weights

STEP = 5e-3


def _start(random, track):
    """Weights apart by random gaps, some of which are closed."""
    n, alpha = track.weights.count, track.alpha
    gaps = random.dirichlet(np.ones(n)) * (math.tau - 2.0 * n * alpha)
    if n > 2 and alpha and random.random() < 0.5:
        gaps[random.integers(n)] += gaps[0]
        gaps[0] = 0.0
    angles = np.cumsum(gaps + 2.0 * alpha) + random.uniform(-20.0, 20.0)
    speeds = np.where(random.random(n) < 0.3, 0.0, random.normal(size=n) * 20.0)
    order = random.permutation(n)
    angles, speeds = angles[order].tolist(), speeds[order].tolist()
    return angles, speeds, track.first_contacts(angles, speeds)


def _signal(random, size):
    return (random.normal(size=(2, 2)) @ [1.0, 1.0j] * size * np.array([1.0, 30.0])).tolist()


#: count, radius of the weights over the largest that fit, rolling resistance, offset
TRACKS = {
    "point": (3, 0.0, 0.0, 0j),
    "offset": (3, 0.0, 0.0, 2e-5 - 1e-5j),
    "plastic": (4, 0.4, 0.0, 0j),
    "offset_packs": (4, 0.5, 0.0, 1e-5j),
    "crowded": (8, 0.95, 0.0, 0j),
    "full": (5, 1.0, 1e-3, 0j),
    "sticking": (2, 0.0, 2e-3, 0j),
    "sticking_alone": (1, 0.3, 2e-2, 1e-5 + 0j),
    "sticking_packs": (6, 0.7, 2e-3, 1e-5j),
}


def test_a_step_may_end_behind_its_first_collision(track_of):
    track = track_of(Weights(2, 0.01, 0.05, 0.0, 1.4), 0.005, 0.5)
    state = [0.0, 2.0 * track.alpha + 0.01], [3.0, -2.0], [0.0, 0.0]
    quiet = [0j] * 4
    moved = track.advance(*state, quiet, 100.0, 0.0, 1e-2, stop=1)
    # 0.01 rad at 5 rad/s, and with the rotor held half of it back
    assert moved.reached == pytest.approx(0.002, abs=1e-13)
    assert moved.events == 1
    assert moved.angles[1] - moved.angles[0] == pytest.approx(2.0 * track.alpha, abs=1e-13)
    assert moved.speeds == pytest.approx([-0.75, 1.75], abs=1e-13)
    whole = track.advance(*state, quiet, 100.0, 0.0, 1e-2)
    rest = track.advance(*moved[:3], quiet, 100.0, 0.0, 1e-2 - moved.reached)
    assert rest.angles == pytest.approx(whole.angles, abs=1e-12)
    assert (whole.reached, whole.events) == (1e-2, 1)


def test_weights_that_touch_and_move_alike_are_in_contact_from_the_start(track_of):
    track = track_of(Weights(3, 0.01, 0.05, 0.05, 1.4), 0.005)
    reach = 2.0 * track.alpha
    assert track.first_contacts([3.0 + reach, 0.5, 3.0], [1.0, 0.0, 1.0]) == [0.0, 0.0, 1.0]
    assert track.first_contacts([3.0 + reach, 0.5, 3.0], [1.0, 0.0, 1.5]) == [0.0] * 3
    assert track.first_contacts([3.0 + reach + 1e-9, 0.5, 3.0], [1.0, 0.0, 1.0]) == [0.0] * 3


@pytest.mark.parametrize(
    ("values", "code", "name"),
    [
        ({"weight_radius": -1.0}, "FAILURE_NEGATIVE", "weight_radius"),
        ({"weight_radius": math.inf}, "FAILURE_NEGATIVE", "weight_radius"),
        ({"weight_radius": 0.036}, "FAILURE_WEIGHT_RADIUS", "weight_radius"),
        ({"restitution": 1.1}, "FAILURE_RESTITUTION", "restitution"),
        ({"restitution": math.nan}, "FAILURE_RESTITUTION", "restitution"),
        ({"rolling_resistance": -1e-9}, "FAILURE_NEGATIVE", "rolling_resistance"),
        ({"offset": complex(0.0, math.inf)}, "FAILURE_NOT_FINITE", "offset"),
    ],
)
def test_impossible_tracks_are_refused(core, track_of, values, code, name):
    points = Weights(4, 0.01, 0.05, 0.05, 1.4)
    found, failure = core.refusal(lambda: track_of(points, **values))
    assert (found, failure.name.decode()) == (code, name)


def test_weights_that_overlap_and_steps_that_fail_are_refused(core, track_of):
    track = track_of(Weights(2, 0.01, 0.05, 0.05, 1.4), 0.005, 0.0, 1e-3)
    quiet, zeros = [0j] * 4, [0.0, 0.0]
    overlap = [0.0, 0.1], zeros, zeros
    for call in (
        lambda: track.advance(*overlap, quiet, 100.0, 0.0, STEP),
        lambda: track.reaction(*overlap, 0j, 0j, 100.0, 0.0),
        lambda: track.first_contacts(*overlap[:2]),
    ):
        code, failure = core.refusal(call)
        assert code == "FAILURE_OVERLAP"
        assert failure.value[:2] == pytest.approx((2.0 * track.alpha - 0.1, 0.200335), rel=1e-5)
    apart = [0.0, 3.0], [0.0, 1.0], zeros
    for signal, step, code in (
        ([1e9, 0j, 0j, 0j], 10.0, "FAILURE_SUBSTEPS"),
        ([1.0, 0j, 0j, 1e30], STEP, "FAILURE_SLIDE"),
    ):
        assert core.refusal(track.advance, *apart, signal, 100.0, 0.0, step)[0] == code
