"""The whirl of the coupled units: runs that settle on it or leave it, and what the commands say."""

import json
import math

import numpy as np
import pytest

from autobalancer.harness import cosimulate, load_scene, speeds
from autobalancer.harness.design.choices import design
from autobalancer.harness.design.recommendation import words
from autobalancer.harness.stability.axis import Axis
from autobalancer.harness.stability.map import stability_map
from autobalancer.harness.stability.whirl import WhirlMotion, whirl_at
from autobalancer.models.whirl.search import main_whirl
from autobalancer.models.whirl.variation import multipliers

pytestmark = pytest.mark.slow

RIG = """
# Rodrigues, Champneys, Friswell, Wilson 2010 with three washers; less drag, so that runs settle
[rotor]
kind = "two_support"
mass = 1.28
inertia = 1.38e-2
polar_inertia = 1.24e-3
span = 0.26
com = 0.11
stiffness = [[21500.0, 15800.0], [21500.0, 15800.0]]
damping = [[5.375, 3.95], [5.375, 3.95]]
planes = [0.13]
unbalances = [
  {position = 0.1398, amount = 3.72e-5, angle = 0.0},
  {position = 0.0, amount = 2.946e-6, angle = 0.8814},
  {position = 0.26, amount = 2.946e-6, angle = 4.0230},
]
[[balancer]]
name = "balls"
kind = "balls"
count = 2
mass = 0.44e-3
track_radius = 0.0428
drag = 3e-3
angles = [2.5, -2.5]
[operation]
speed = 471.239
[coupling]
steps_per_rev = 40
"""


@pytest.fixture(scope="module")
def rig(tmp_path_factory):
    path = tmp_path_factory.mktemp("rig") / "rig.toml"
    path.write_text(RIG)
    return load_scene(path)


def last_revolutions(scene, start, revolutions):
    """Angles of the weights at the end [rad] and amplitude of the stations [m], of a run."""
    run = {"run.revolutions": revolutions, "balls.angles": start}
    result = cosimulate(scene.replace(run))
    late = slice(-40 * 5, None)
    angles = np.array([result[f"balls.weight[{k}].angle"][-1] for k in (1, 2)])
    places = [
        result[f"rotor.station[{s}].x"][late] + 1j * result[f"rotor.station[{s}].y"][late]
        for s in (1, 2)
    ]
    return np.exp(1j * angles), np.abs(places).max(axis=1)


@pytest.mark.parametrize(
    ("changes", "revolutions"),
    [
        ({"operation.speed": 200.0}, 120),
        ({"operation.speed": 340.0}, 520),
        ({"operation.speed": 340.0, "balls.track_offset_xi": 5e-6}, 520),
        ({"operation.speed": 176.0, "balls.weight_radius": 2.38e-3}, 250),
    ],
    ids=["together", "apart", "track off centre", "touching"],
)
def test_long_runs_settle_on_the_whirl(rig, changes, revolutions):
    scene = rig.replace(changes)
    speed = changes["operation.speed"]
    whirl, growth = main_whirl(scene.assembly(), speed)
    assert growth * revolutions * 2.0 * math.pi / speed < -7.0
    units, amplitude = last_revolutions(scene, [2.5, -2.5], revolutions)
    expected = np.exp(1j * whirl.angles)
    if len(expected) == 1:  # side by side
        apart = 2.0 * math.asin(2.38 / 42.8)
        assert abs(np.angle(units[1] / units[0])) == pytest.approx(apart, abs=1e-3)
        units = units.sum(keepdims=True)
    elif abs(units - expected).max() > abs(units - expected[::-1]).max():
        expected = expected[::-1]
    np.testing.assert_allclose(np.angle(units / expected), 0.0, atol=1e-3)
    communicated = [whirl.rotor_at(2.0 * math.pi * j / 40)[0] for j in range(40)]
    np.testing.assert_allclose(amplitude, np.abs(communicated).max(axis=0), rtol=1e-3)


def test_a_run_that_starts_on_an_unstable_whirl_leaves_it(rig):
    scene = rig.replace({"operation.speed": 155.0})
    whirl, growth = main_whirl(scene.assembly(), 155.0)
    assert growth > 0.0
    start = (whirl.angles + np.array([1e-3, -1e-3])).tolist()
    units, amplitude = last_revolutions(scene, start, 250)
    assert np.abs(np.angle(units / np.exp(1j * whirl.angles))).min() > 0.5
    assert amplitude.max() > 5.0 * whirl.amplitude.max()


def test_multipliers_of_the_units_about_the_whirl_are_those_of_the_equations(rig):
    expected = multipliers(main_whirl(rig.assembly(), 300.0).whirl)
    with WhirlMotion(rig) as motion:
        found = motion.multipliers(300.0)
    for value in expected:
        assert np.abs(found - value).min() < 1e-5


def test_where_the_whirl_becomes_stable_units_and_equations_agree(rig):
    """At rest nothing balances a couple in one plane, and the answer to that stays."""
    found = speeds(rig, (160.0, 170.0), ["floquet", "cosim"])
    assert set(found.refused) == {"floquet", "cosim"}
    assert not found.methods
    (floquet,), (cosim,) = found.whirl.methods["floquet"], found.whirl.methods["cosim"]
    assert floquet.above == cosim.above == "stable"
    assert cosim.speed == pytest.approx(floquet.speed, rel=1e-5)
    assert "cannot be undone" in found.whirl.why
    assert any(f"{floquet.speed:.6g} to 170 rad/s" in line for line in found.whirl.lines())
    written = json.loads(json.dumps(found.as_json()))["whirl"]
    assert len(written["at"][0]["amplitude"]) == 2
    assert written["at"][0]["stable"] is False
    assert written["at"][-1]["stable"] is True


def test_on_a_track_off_centre_no_rotor_rests(rig):
    found = speeds(rig.replace({"balls.track_offset_xi": 5e-6}), (330.0, 350.0), ["floquet"])
    assert all(one.stable for one in found.whirl.at)
    centred = load_scene("filimonikhina")
    found = speeds(centred.replace({"weights.track_offset_xi": 1e-4}), (2.0, 3.0), ["floquet"])
    assert "tracks are off centre: weights by 0.1 mm" in found.whirl.why
    assert found.methods["floquet"] == speeds(centred, (2.0, 3.0), ["floquet"]).methods["floquet"]


def test_balance_at_rest_needs_no_whirl():
    assert speeds(load_scene("filimonikhina"), (2.0, 3.0), ["floquet"]).whirl is None


def test_map_shows_the_whirl_where_weights_cannot_balance():
    x, y = Axis.parse("speed=2:4:2"), Axis.parse("rotor.unbalance=0.001:0.02:3")
    scene = load_scene("filimonikhina")
    data = stability_map(scene, x, y)
    assert np.isnan(data.whirl[0]).all()
    for j in (1, 2):
        changed = {"rotor.unbalance": y.values[j]}
        one = whirl_at(scene.replace(changed), 4.0)
        assert data.whirl[j, 1] == max(one.amplitude)
        assert data.whirl_growth[j, 1] == one.growth


def test_design_says_what_remains_with_too_little_capacity():
    data = design(load_scene("finite_weights"), unbalance=5.0, counts=[2, 3], starts=6)
    (line,) = [line for line in words(data) if "A whirl remains" in line]
    assert "mm with n = 2" in line
    assert "mm with n = 3" in line
