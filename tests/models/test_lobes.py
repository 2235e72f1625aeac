"""What races that are not round leave, against numbers and an integration of another program."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from autobalancer.models.assembly import Assembly, Mounted
from autobalancer.models.lobes import Lobes, Race, swing
from autobalancer.models.rotor import LinearRotor
from autobalancer.models.weights import Weights


def race(lobes: Lobes | list[Lobes], count: int = 2, kappa: float = 1.0) -> Race:
    rotor = LinearRotor.planar(10.0, 1e4, 60.0, unbalance=0.02)
    weights = Mounted("balls", Weights(count, 0.15, 0.1, 0.6, kappa), 0, (0.0,) * count)
    return Race(Assembly(rotor, (weights,)), 100.0, lobes if isinstance(lobes, list) else [lobes])


def left(found: Race) -> float:
    stable = [rest for rest in found.rests() if rest.growth < 0.0]
    return abs(stable[0].displacement)


@pytest.mark.parametrize(
    ("order", "angle", "millimetres"),
    [(2, 0.0, 0.70193631), (2, math.pi / 4.0, 0.10693227), (1, 0.7, 0.19995759),
     (3, 0.0, 0.23936903)],
)  # fmt: skip
def test_what_two_balls_leave_is_what_sixty_integrated_seconds_end_with(order, angle, millimetres):
    found = race(Lobes(order, 2e-4, angle))
    assert found.alone == pytest.approx(2.2173e-3, rel=1e-4)
    assert 1e3 * left(found) == pytest.approx(millimetres, abs=2e-8)


@pytest.mark.parametrize(
    ("order", "angle", "share"),
    [(2, 0.0, 2.667319), (2, math.pi / 4.0, 0.333345), (3, 0.0, 2.331011)],
)
def test_small_lobes_leave_their_share(order, angle, share):
    assert left(race(Lobes(order, 2e-7, angle))) / 2e-7 == pytest.approx(share, abs=2e-6)


def test_motions_that_are_called_stable_are_reached_and_others_left():
    found = race(Lobes(2, 2e-4, 0.0))
    for rest in found.rests():
        start = np.concatenate([[rest.displacement.real, rest.displacement.imag, 0.0, 0.0],
                                np.add(rest.angles, [1e-4, -2e-4]), [0.0, 0.0]])  # fmt: skip
        end = solve_ivp(lambda _t, s: found.rates(s), (0.0, 12.0), start, "LSODA", rtol=1e-8,
                        atol=1e-11).y[:, -1]  # fmt: skip
        apart = np.abs(np.exp(1j * (end[4:6] - rest.angles)) - 1.0).max()
        assert (apart < 1e-3) == (rest.growth < 0.0)


def test_a_weight_swings_about_a_lobe_of_a_balanced_heavy_rotor():
    lobes = Lobes(2, 2e-4, 0.0)
    assert swing(100.0, lobes, 0.1, 1.0) == pytest.approx(8.944272, abs=1e-6)
    rotor = LinearRotor.planar(1e9, 1e10)
    weight = Mounted("ball", Weights(1, 0.01, 0.1, 0.0), 0, (0.0,))
    alone = Race(Assembly(rotor, (weight,)), 100.0, [lobes])
    state = np.array([0.0, 0.0, 0.0, 0.0, 1e-3, 0.0])
    found = solve_ivp(lambda _t, s: alone.rates(s), (0.0, 3.0), state, "DOP853", rtol=1e-10,
                      atol=1e-14, events=lambda _t, s: s[4])  # fmt: skip
    assert math.pi / np.diff(found.t_events[0]).mean() == pytest.approx(
        100.0 * math.sqrt(4.0 * 2e-4 / 0.1002),
        rel=1e-6,  # the lobe's own radius is R + eps
    )


def test_three_weights_on_a_round_race_have_many_rests_and_lobes_choose_among_them():
    found = [rest for rest in race([Lobes(2, 1e-5, 0.3)], 3).rests() if rest.growth < 1e-6]
    assert 0 < len(found) < 20
    assert abs(found[0].displacement) < 1e-4
