"""Weights that touch as single ones: motion, force, slow root, and co-simulation."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest

from autobalancer.harness import cosimulate, load_scene
from autobalancer.models.assembly import Assembly, Mounted, SpeedProfile
from autobalancer.models.linear.floquet import exponents
from autobalancer.models.linear.linearised import linearise
from autobalancer.models.monolith import simulate
from autobalancer.models.papers.capacity import largest_alignment
from autobalancer.models.papers.settling import critical_drag_factor, slow_root
from autobalancer.models.papers.touching import Packed, joint_alignment, merged, packed_groups
from autobalancer.models.reference.coupled import Start
from autobalancer.models.rotor import LinearRotor
from autobalancer.models.steps.weights import advance as point_advance
from autobalancer.models.steps.weights import reaction as point_reaction
from autobalancer.models.weights import Weights, alignment
from tests.studies.papers import completed_angles

ALPHA = 0.25
SPEED = 30.0


def test_groups_are_found_across_the_turn_and_in_any_order():
    angles = [0.1, 3.0, 0.1 - 2 * ALPHA, 3.0 + 2 * ALPHA, 0.1 + 2 * ALPHA]
    (first, second) = sorted(packed_groups(angles, ALPHA))
    assert (first.size, second.size) == (2, 3)
    assert first.middle == pytest.approx(3.0 + ALPHA)
    assert cmath.exp(1j * second.middle) == pytest.approx(cmath.exp(0.1j))
    assert len(packed_groups(angles, 0.0)) == 5
    full = [2 * math.pi * k / 6 for k in range(6)]
    assert [g.size for g in packed_groups(full, math.pi / 6)] == [6]


def test_a_packed_group_moves_and_pulls_like_the_single_weight(track_of):
    """Against the unit's contacts, which find the pressure by themselves."""
    weights = Weights(3, 0.02, 0.1, 0.01, 1.4)
    track = track_of(weights, 0.1 * math.sin(ALPHA))
    middle, h = math.pi - 0.3, 2e-3
    angles = [middle - 2 * ALPHA, middle, middle + 2 * ALPHA]
    contacts = [1.0, 1.0, 0.0]
    rotor = LinearRotor.planar(1.0, 100.0)
    whole = merged(Assembly(rotor, (Mounted("b", weights),)), ALPHA, [Packed(3, middle)])
    single = whole.balancers[0].device
    assert whole.added_mass == pytest.approx([weights.added_mass])
    signal = (20.0 + 1j, 3j, 0j, 0j)  # drives the group to pi: pressed together
    state, point = (angles, [1.0] * 3, contacts), ([middle], [1.0])
    for _ in range(50):
        state = track.advance(*state, signal, SPEED, 0.0, h)[:3]
        point = point_advance(single, *point, signal, 0.0, h)
    assert state[0][1] == pytest.approx(point[0][0], abs=1e-9)
    found = track.reaction(*state, *signal[:2], SPEED, 0.0)
    expected = point_reaction(single, *point, *signal[:2], SPEED, 0.0)
    assert found == pytest.approx(expected, rel=1e-8)


def test_joint_spread_is_p_without_contact_and_1_for_groups_face_to_face():
    angles = [0.2, 1.7, 3.3, 4.9]
    number, p = joint_alignment(packed_groups(angles, ALPHA), ALPHA)
    assert (number, p) == pytest.approx((4.0, alignment(angles)))
    one, two = Packed(1, 0.4), Packed(2, 0.4 + math.pi)
    number, p = joint_alignment([one, two], ALPHA)
    assert number == pytest.approx(1 + 2 * math.cos(ALPHA) ** 2)
    # Goncharov's position of largest p for 3 weights (13): pressed together, nothing drives them
    assert p == pytest.approx(1.0)
    assert largest_alignment(3, ALPHA) < 0.98
    weights = Weights(3, 1e-3, 1.0, 2e-3, 1.4)
    limit = critical_drag_factor(LinearRotor.planar(1.0, 1.0), 2.0, 1.4)
    assert abs(slow_root(weights, p, limit, number)) < 1e-12


def test_slow_root_with_contact_is_the_limit_of_the_spectrum_for_light_weights():
    errors = []
    for mass in (4e-3, 1e-3):
        weights = Weights(4, mass, 1.0, 2.0 * mass, 1.4)
        # a pair in contact and two more that balance what it leaves
        pair = [2.0 - ALPHA, 2.0 + ALPHA]
        angles = completed_angles(weights, math.sin(ALPHA), 0.4 * mass, pair)
        rotor = LinearRotor.planar(1.0, 1.0, unbalance=0.4 * mass)
        assembly = Assembly(rotor, (Mounted("b", weights, 0, tuple(angles), (0.0,) * 4),))
        groups = packed_groups(angles, ALPHA)
        assert [g.size for g in groups].count(2) == 1
        number, p = joint_alignment(groups, ALPHA)
        root = slow_root(weights, p, critical_drag_factor(assembly.loaded_rotor, 2.0, 1.4), number)
        values = exponents(
            [linearise(merged(assembly, ALPHA, groups))], np.zeros(1, int), np.array([2.0])
        )
        moving = [v for v in values[0] if abs(v.imag) < 0.5]  # the rest is the undamped rotor's
        errors.append(abs(root / max(moving, key=lambda v: v.real) - 1.0))
    assert errors[1] < 1e-3
    assert errors[0] / errors[1] == pytest.approx(16.0, rel=0.3)  # second order in the mass


MEETING = {"balls.speeds": [12.0, -12.0], "balls.angles": [1.0, 2.0]}
OPENING = {"balls.angles": [3.4889123984477144, 3.994272908731872], "run.initial.vx": -3.0}


@pytest.mark.parametrize(
    ("changes", "shift"),
    [
        ({}, (0.0, 0.0)),
        ({"balls.angles": [3.188912398447714, 3.6942729087318718]}, (0.0, 0.0)),
        ({**MEETING, "balls.restitution": 0.5}, (0.094, 0.0)),
        (MEETING, (0.094, 0.0)),
        ({**OPENING, "run.revolutions": 0.8}, (0.1, 0.1)),
    ],
    ids=[
        "no contact",
        "lasting contact",
        "collision with restitution",
        "collision",
        "contact that opens",
    ],
)
def test_contact_moves_as_an_independent_integration_has_it(changes, shift):
    """Compared ten times per revolution, for several starts."""
    scene = load_scene("contact_order").replace({**changes, "coupling.steps_per_rev": 10})
    names = ["rotor.x", "rotor.y", "balls.weight[1].angle", "balls.weight[2].angle"]
    turns, begin = scene.run.revolutions, np.array(scene.balancer[0].angles)
    times = math.tau / 80.0 * np.arange(0.1, turns + 0.05, 0.1)
    for part in np.arange(4) / 4:
        one = scene.replace({"balls.angles": (begin + part * np.array(shift)).tolist()})
        start = Start(vx=one.run.initial.vx)
        speed = SpeedProfile.constant(80.0)
        right = simulate(one.assembly(), speed, times, initial=start, rtol=1e-12)
        found = cosimulate(one, record=names)
        for name in names:
            size = 1.0 if "angle" in name else np.abs(found[name]).max()
            assert np.abs(found[name][1:] - right[name]).max() < 1e-4 * size
