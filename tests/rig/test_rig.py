"""The measured rig of Rodrigues et al. 2010: its data, its model, in what the two must agree."""

from __future__ import annotations

import math

import numpy as np
import pytest

from autobalancer.harness import SceneError, check, load_scene
from autobalancer.harness.checks.registry import parts_of
from autobalancer.harness.checks.rig import BALLS_SETTLE, BANDS, CRITICAL, HIGH
from autobalancer.harness.checks.rig_data import (
    at,
    bearings,
    chosen,
    response,
    steady,
    swept,
    with_washers,
)
from autobalancer.harness.checks.rig_sweeps import gained, lost
from autobalancer.harness.units import RPM
from autobalancer.models.harmonic_balance import largest_displacement, unbalance_response
from autobalancer.models.papers.influence import influence
from tests.studies.rig import quantities

pytestmark = pytest.mark.slow


@pytest.fixture
def rig():
    return load_scene("bristol")


def test_amplitudes_with_balls_are_those_of_the_authors_simulation(rig):
    """Fig. 13, below and above the resonances, to 1 %."""
    points = rig.replace({"balls.kind": "pendulums", "balls.weight_radius": None})
    table = chosen("simulated", washers=3, balls=2)
    some = table[np.isin(table["speed_rpm"], (900.0, 2700.0, 4500.0))]
    assert len(some) >= 3
    found = steady(points, 3, some["speed_rpm"], BALLS_SETTLE)
    assert found == pytest.approx(some["amplitude_mm"], rel=0.01)


def test_bearings_without_balls_move_as_the_equations_of_the_rotor_say(rig):
    speeds = np.array([1460.0, 2280.0, 4500.0])
    rotor = with_washers(rig, 4).assembly().rotor
    turn = np.exp(1j * np.linspace(0.0, math.tau, 721))
    expected = []
    for speed in speeds:
        amplitude = influence(rotor, speed * RPM, np.eye(2)) @ rotor.unbalance
        orbit = np.real(amplitude[..., None] * turn)
        expected.append(1e3 * np.hypot(*orbit).max(axis=1))
    found = bearings(rig.without_balancers(), 4, speeds)
    assert found == pytest.approx(np.array(expected), rel=4e-3)  # 40 points per revolution


def test_bearings_with_friction_move_as_harmonic_balance_says():
    scene = with_washers(load_scene("bristol_friction"), 3)
    speeds = np.array([1400.0, 1700.0, 2300.0, 4500.0])
    expected = largest_displacement(unbalance_response(scene.assembly().rotor, speeds * RPM))
    found = steady(scene.replace({"coupling.steps_per_rev": 20}), 3, speeds, 150)
    mean = 1e3 * expected[:, [0, 2]].mean(axis=1)
    assert found == pytest.approx(mean, rel=0.015)  # 20 points per revolution


def test_a_slow_sweep_meets_the_amplitudes_at_constant_speed(rig):
    plain = rig.without_balancers()
    for falling in (False, True):
        speeds, amplitude = swept(plain, [3], 2600.0, 3000.0, falling)[3]
        late = (speeds > 2700.0) & (speeds < 2900.0)  # 4 s after the start from rest
        found = steady(plain, 3, speeds[late])
        assert amplitude[late] == pytest.approx(found, rel=0.01)


def test_the_data_are_those_of_the_figures():
    """Fig. 9a and 11d at 4500 rpm; 7 b to e: amplitude of a bearing over the other's."""
    assert at(response(3, 0), [4500.0])[0] == pytest.approx(0.0430, abs=2e-4)
    assert at(response(3, 2), [4500.0])[0] == pytest.approx(0.0060, abs=4e-4)
    orbits = chosen("orbits", speed_rpm=1415.0)
    sizes = [np.hypot(orbits[f"x{n}_mm"], orbits[f"y{n}_mm"]).max() for n in (1, 2)]
    assert sizes[1] / sizes[0] == pytest.approx(2.12, abs=5e-3)
    assert np.mean(sizes) == pytest.approx(
        at(response(3, 0, falling=0), [1415.0], 10.0)[0], rel=0.1
    )


def test_balance_is_gained_where_balls_begin_to_help_and_lost_where_they_end():
    speeds = np.arange(1200.0, 2700.0, 5.0)
    plain = np.ones_like(speeds)
    balls = np.where((speeds > 1490.0) | (abs(speeds - 1300.0) < 15.0), 0.5, 2.0)
    assert gained((speeds, balls), (speeds, plain)) == 1500.0  # one lucky point does not count
    assert lost((speeds, balls), (speeds, plain)) == 1480.0
    assert math.isnan(gained((speeds, 2.0 * plain), (speeds, plain)))
    assert math.isnan(lost((speeds, 0.5 * plain), (speeds, plain)))


def test_what_was_fitted_to_one_and_three_washers_holds_for_the_others(monkeypatch):
    """Which quantities do not, and what is known of them: harness/manual/results/bristol.md.

    Every tenth speed, and the first mode; the others and with balls: `python -m
    tests.studies.rig.quantities`.
    """
    some, grid, last = quantities.WHOLE[::10], quantities.GRID, BANDS["cylindrical y"][1]
    monkeypatch.setattr(quantities, "WHOLE", some)
    monkeypatch.setattr(quantities, "CURVE", some)
    monkeypatch.setattr(quantities, "GRID", grid[grid <= last + 40.0])
    scene = load_scene("bristol_friction")
    found = list(quantities.without_balls(scene))
    errors = {one.label.removeprefix("critical speed, "): one.errors[1:].max() for one in found}
    assert errors["cylindrical y"] < CRITICAL
    assert max(errors[f"no balls, {speed:g} rpm"] for speed in HIGH) < 0.12
    whole = found[-1]  # from 1260 rpm on; of the 36 speeds from 1100 rpm on it does not hold
    assert whole.rms(quantities.OTHERS) < 1.5 * whole.rms(quantities.FITTED)


def test_a_scene_that_is_not_of_the_rig_is_refused():
    with pytest.raises(SceneError, match="unknown"):
        check(load_scene("two_balls").with_check({"kind": "rig"}))


def test_the_self_check_leaves_the_rig_out(rig):
    assert rig.on_request
    assert len(parts_of(rig)) > 1  # side by side
