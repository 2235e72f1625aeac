"""What the functions of a track answer to: changes of the force, early ends, refusals."""

from __future__ import annotations

import pytest

from autobalancer.models.weights import Weights

STEP = 5e-3


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


def test_weights_that_overlap_and_steps_that_fail_are_refused(core, track_of):
    track = track_of(Weights(2, 0.01, 0.05, 0.05, 1.4), 0.005, 0.0, 1e-3)
    quiet, zeros = [0j] * 4, [0.0, 0.0]
    overlap = [0.0, 0.1], zeros, zeros
    for call in (
        lambda: track.advance(*overlap, quiet, 100.0, 0.0, STEP),
        lambda: track.reaction(*overlap, 0j, 0j, 100.0, 0.0),
        lambda: track.first_contacts(*overlap[:2]),
    ):
        assert core.refusal(call) == "weights overlap by 0.1 rad: neighbours need 0.200335 rad"
    apart = [0.0, 3.0], [0.0, 1.0], zeros
    for signal, step, words in (
        ([1e9, 0j, 0j, 0j], 10.0, "the weights would need "),
        ([1.0, 0j, 0j, 1e30], STEP, "the sliding weights' step of 0.005 s did not converge"),
    ):
        assert core.refusal(track.advance, *apart, signal, 100.0, 0.0, step).startswith(words)
