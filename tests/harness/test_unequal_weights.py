"""Weights of one balancer that differ in mass, drag and size."""

import math

import numpy as np
import pytest

from autobalancer.harness import Scene
from autobalancer.harness.errors import SceneError, UserError
from autobalancer.harness.result.run import cosimulate
from autobalancer.harness.scatter.study import scatter
from autobalancer.harness.scatter.vary import Variation
from autobalancer.models.linear.balanced import CannotBalance, balanced_angles
from autobalancer.models.stability import growth_rates
from autobalancer.models.weights import Weights

RADIUS, LARGE, SMALL, UNBALANCE = 0.1, 0.05, 0.03, 4e-3
ROTOR = {
    "kind": "planar", "mass": 5.0, "stiffness": 5e4, "damping": 100.0, "unbalance": UNBALANCE
}  # fmt: skip
WEIGHTS = {"kind": "balls", "name": "balls", "track_radius": RADIUS}
MASSES, DRAGS = [LARGE, SMALL], [0.4, 0.3]


def scene_of(*balancers, **run):
    return Scene(
        rotor=ROTOR, balancer=balancers, operation={"speed": 300.0}, run={"revolutions": 20, **run}
    )


def unequal(**keys):
    own = {"count": 2, "mass": MASSES, "drag": DRAGS, "angles": [1.0, 4.0]}
    return scene_of({**WEIGHTS, **own, **keys})


def apart(**keys):
    """Each weight as a balancer of its own."""
    return scene_of(*(
        {**WEIGHTS, "name": f"ball{k}", "count": 1, "mass": m, "drag": d, "angles": [a], **keys}
        for k, m, d, a in zip((1, 2), MASSES, DRAGS, (1.0, 4.0), strict=True)
    ))  # fmt: skip


def test_two_unequal_weights_stand_at_the_corners_of_a_triangle():
    large, small = LARGE * RADIUS, SMALL * RADIUS
    first, second = balanced_angles(unequal().assembly())
    cosine = (UNBALANCE**2 + large**2 - small**2) / (2.0 * UNBALANCE * large)
    assert math.cos(first) == pytest.approx(-cosine, abs=1e-12)
    assert math.cos(second) == pytest.approx(
        -(UNBALANCE**2 + small**2 - large**2) / (2.0 * UNBALANCE * small), abs=1e-12
    )
    assert large * math.sin(first) == pytest.approx(-small * math.sin(second), abs=1e-15)


@pytest.mark.parametrize(("unbalance", "balances"), [
    (1.9e-3, False), (2.1e-3, True), (7.9e-3, True), (8.1e-3, False)
])  # fmt: skip
def test_two_weights_balance_between_the_difference_and_the_sum_of_their_moments(
    unbalance, balances
):
    assembly = unequal().replace({"rotor.unbalance": unbalance}).assembly()
    if balances:
        assert len(balanced_angles(assembly)) == 2
    else:
        with pytest.raises(CannotBalance):
            balanced_angles(assembly)


def test_capacity_of_unequal_balls_is_the_moment_of_their_packed_group():
    radii = [0.012, 0.02]
    gap = 2.0 * math.asin(sum(radii) / (2.0 * RADIUS))
    packed = RADIUS * abs(LARGE + SMALL * np.exp(1j * gap))
    (balls,) = unequal(weight_radius=radii).balancer
    assert balls.moment_range == pytest.approx((RADIUS * (LARGE - SMALL), packed), rel=1e-14)
    assert balls.capacity == pytest.approx(packed, rel=1e-14)


def test_unequal_weights_move_as_balancers_of_one_weight_each():
    one, two = cosimulate(unequal()), cosimulate(apart())
    for name in ("rotor.x", "rotor.y"):
        error = np.abs(one[name] - np.interp(one.time, two.time, two[name])).max()
        assert error < 3e-4 * np.abs(two[name]).max()
    moment = two["ball1.moment_xi"][-1] + two["ball2.moment_xi"][-1]
    assert one["balls.moment_xi"][-1] == pytest.approx(moment, rel=1e-4)


def test_floquet_multipliers_of_unequal_weights_are_those_of_balancers_of_one_weight_each():
    found = [growth_rates(scene.assembly(), [150.0, 300.0]) for scene in (unequal(), apart())]
    assert found[0] == pytest.approx(found[1], rel=1e-9)


def test_a_list_of_equal_values_moves_weights_as_one_value_does():
    alike = unequal(mass=0.04, drag=0.4, weight_radius=0.01)
    listed = unequal(mass=[0.04, 0.04], drag=[0.4, 0.4], weight_radius=[0.01, 0.01])
    assert listed.balancer[0].unequal
    one, two = cosimulate(alike), cosimulate(listed)
    assert np.abs(one["rotor.x"] - two["rotor.x"]).max() < 1e-9 * np.abs(one["rotor.x"]).max()


def test_a_scene_made_from_the_tables_of_another_keeps_each_weight():
    scene = unequal(weight_radius=[0.01, 0.02])
    again = scene_of(scene.balancer[0])
    assert again.balancer == scene.balancer
    assert again.balancer[0].device.masses == tuple(MASSES)


@pytest.mark.parametrize(("keys", "words"), [
    ({"mass": [0.05, 0.03, 0.01]}, r"mass = .*has 3 values: must have 2, one for each weight"),
    ({"mass": [0.05, -0.03]}, r"mass\[2\] = -0.03 kg: must be greater than 0"),
    ({"weight_radius": [0.02, 0.12]}, "must be less than track_radius = 0.1 m"),
    ({"weight_radius": [0.02, 0.03], "angles": [0.0, 0.4]}, "weights 1 and 2 overlap: 0.4 rad"),
])  # fmt: skip
def test_wrong_lists_are_refused_by_name(keys, words):
    with pytest.raises(SceneError, match=words):
        unequal(**keys)


def test_closed_forms_of_equal_weights_refuse_unequal_ones():
    weights = Weights(2, 0.04, RADIUS, masses=(0.05, 0.03))
    with pytest.raises(ValueError, match="the slow root: only for equal weights"):
        weights.refuse_unequal("the slow root")


def test_every_weight_of_a_scatter_has_its_own_draw():
    scene = unequal(mass=0.04, drag=0.4)
    variations = Variation.parse_each("balls.mass[*]=normal(40 g, 1%)", scene)
    assert [one.path for one in variations] == ["balls.mass[1]", "balls.mass[2]"]
    study = scatter(scene, variations, 3)
    assert study.ran.all()
    assert len(np.unique(study.values)) == 6
    with pytest.raises(UserError, match=r"\[\*\] stands for every weight of a balancer"):
        Variation.parse_each("rotor.mass[*]=normal(1, 1%)", scene)


@pytest.mark.parametrize("restitution", [0.0, 0.6])
def test_unequal_balls_on_a_held_track_collide_as_two_bodies_do(restitution):
    """After Newton: sum of m v, and the relative speed times -e."""
    radii, start = [0.012, 0.02], [0.0, 0.6]
    heavy = {"mass": 5e7, "stiffness": 5e11, "damping": 1e9, "unbalance": 0.0}
    scene = unequal(
        weight_radius=radii, restitution=restitution, drag=0.0, angles=start, speeds=[20.0, -10.0]
    ).replace({f"rotor.{key}": value for key, value in heavy.items()})
    result = cosimulate(scene.replace({"run.revolutions": 0.9, "run.record": [
        "rotor.x", "rotor.y", "balls.weight[1].speed", "balls.weight[2].speed"]}))  # fmt: skip
    common = (LARGE * 20.0 - SMALL * 10.0) / (LARGE + SMALL)
    part = restitution * 30.0 / (LARGE + SMALL)
    ends = [result[f"balls.weight[{k}].speed"][-1] for k in (1, 2)]
    assert ends == pytest.approx([common - part * SMALL, common + part * LARGE], rel=1e-6)


def test_one_wrong_value_is_one_problem():
    with pytest.raises(SceneError) as refused:
        unequal(mass=-1)
    assert str(refused.value).splitlines() == [
        "scene: balancer[1].mass = -1 kg: must be greater than 0"
    ]
