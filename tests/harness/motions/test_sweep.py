"""Hysteresis of a slow sweep, against an integration that holds the speed as well."""

import json

import numpy as np
import pytest

from autobalancer import Scene
from autobalancer.harness.motions.held import Held, Settled, hold
from autobalancer.harness.motions.kinds import Kind, Motion
from autobalancer.harness.motions.sweep import Branch, Sweep
from tests.studies.left_behind import machine

LOW, HIGH = 0.3, 3.6
UNBALANCE, MASS = 0.01, 0.03267


def light_balls(drag, damping):
    rotor = {"kind": "planar", "mass": 1.0, "stiffness": 1.0, "damping": damping}
    balls = {"name": "balls", "kind": "balls", "count": 2, "mass": MASS, "track_radius": 1.0}
    return Scene(
        rotor={**rotor, "unbalance": UNBALANCE},
        balancer=[{**balls, "drag": drag}],
        operation={"speed": 3.0},
    )


def held_by_integration(drag, damping, first, speed):
    """Vibration after a slow change from the first speed and a long hold [m]."""
    rotor = machine.planar(1.0, 1.0, damping, UNBALANCE)
    drags = drag * np.array([1.0 - 5e-5, 1.0 + 5e-5])
    weights = [machine.Weight(0, MASS, 1.0, one) for one in drags]
    changing, held = 600.0 * abs(speed - first), 6000.0
    corners = [(0.0, first), (300.0, first), (300.0 + changing, speed)]
    end = corners[-1][0] + held
    windows, _ = machine.run(rotor, weights, corners, [0.3, 2.0], [first, first], end, 100, 40)
    return windows[-5:, 1].max()


@pytest.mark.parametrize(
    ("drag", "damping", "speed"),
    [
        (0.0101, 0.1, 1.42),
        (0.0101, 0.1, 1.54),
        (0.0101, 0.1, 2.86),
        (0.03, 0.1, 1.45),
        (0.03, 0.1, 2.4),
        (0.3, 0.3, 1.2),
    ],
)
def test_ways_settle_to_different_vibrations_where_an_integration_finds_them(drag, damping, speed):
    found = light_balls(drag, damping).sweep(LOW, HIGH)
    up, down = (held_by_integration(drag, damping, first, speed) for first in (LOW, HIGH))
    alone = np.interp(speed, found.branches[0].speed, found.alone)
    differ = max(up, down) > max(1.5 * min(up, down), 0.05 * alone)
    assert differ == any(low <= speed <= high for low, high in found.ranges)


def test_weights_that_balance_slowly_are_no_hysteresis():
    found = light_balls(0.3, 0.3).sweep(LOW, HIGH)
    up, down = found.branches
    back = np.interp(up.speed, down.speed[::-1], down.vibration[::-1])
    moving = (np.maximum(up.vibration, back) > 1.5 * np.minimum(up.vibration, back)).any()
    assert moving
    assert found.hysteresis is None
    assert "but only while the speed moves" in found.sentence()
    assert all(one.is_settled and not one.differs for one in found.held)
    json.dumps(found.as_json(), allow_nan=False)


SETTLED = Settled(Motion(Kind.BALANCED), 1e-5)
OPEN = Settled(Motion(Kind.UNDECIDED), 1.0)
BEHIND = Settled(Motion(Kind.BEHIND, 2, 2, 1.0), 1.0)


@pytest.mark.parametrize(
    ("rising", "falling", "is_settled", "differs"),
    [
        (BEHIND, SETTLED, True, True),
        (BEHIND, BEHIND, True, False),
        (OPEN, SETTLED, False, False),
        (BEHIND, OPEN, False, False),
    ],
)
def test_only_two_settled_motions_differ(rising, falling, is_settled, differs):
    held = Held(2.0, rising, falling, 0.1)
    assert (held.is_settled, held.differs) == (is_settled, differs)


def test_a_motion_that_has_not_settled_is_named():
    up = Branch("rising", np.array([1.0, 2.0]), np.array([1.0, 1.0]))
    held = (Held(1.0, OPEN, SETTLED, 0.1), Held(2.0, BEHIND, SETTLED, 0.1))
    said = Sweep("one", (up, up), np.ones(2), 9.0, held).sentence()
    assert "different vibrations at 2 rad/s" in said
    assert "Cannot tell at 1 rad/s" in said


def test_where_both_ways_begin_to_agree_is_found_between_speeds_that_were_held():
    def at(row):
        return Held(float(row), BEHIND, SETTLED if row >= 37 else BEHIND, 0.1)

    found = hold(np.arange(100), at)
    first = next(one.speed for one in found if one.differs)
    assert 37 <= first <= 38
    assert len(found) < 20
    assert hold(np.arange(0), at) == ()
