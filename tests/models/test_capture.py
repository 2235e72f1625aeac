"""Weights that are left behind: the closed form against integrations that share no code with it.

The measured values are of fixed-step Runge-Kutta integrations of the planar and the two-support
rotor, from random starts, in slow run-ups and at constant speed.
"""

import math
from dataclasses import replace

import numpy as np
import pytest

from autobalancer.models.assembly import Assembly, Mounted
from autobalancer.models.capture import capture
from autobalancer.models.capture.balance import balance, balance_two
from autobalancer.models.capture.groups import Lag, groups_of
from autobalancer.models.capture.receptance import Receptance
from autobalancer.models.linear.modes import modes
from autobalancer.models.rotor import LinearRotor
from autobalancer.models.weights import Weights
from tests.studies.left_behind.draw import draw
from tests.studies.left_behind.machine import run

GREEN = {"damping": 0.02, "drag": 0.001}  # a light ball balancer of the literature


def planar(damping=0.1, drag=0.0101, count=2, mass=0.0327, stiffness=1.0, radius=0.0, **more):
    rotor = LinearRotor.planar(1.0, stiffness, damping, unbalance=0.01, **more)
    device = Weights(count, mass, 1.0, drag, 1.4, radius)
    return Assembly(rotor, (Mounted("balls", device, 0, (0.0,) * count),))


def two_planes(drag, count=2, second=1.0):
    """A short rotor on two supports that are alike, a balancer at each quarter of its length."""
    rotor = LinearRotor.two_support(
        mass=1.0, inertia=0.04, polar_inertia=0.02, span=1.0,
        stiffness=((0.5, 0.5), (0.5, 0.5)), damping=((0.01, 0.01), (0.01, 0.01)),
        planes=(0.25, 0.75), unbalances=((0.0, 0.004, 0.0), (1.0, 0.002, 0.0)),
    )  # fmt: skip
    drags = (drag, drag * second)
    return Assembly(
        rotor,
        tuple(
            Mounted(name, Weights(count, 0.02, 1.0, b, 1.4), plane, (0.0,) * count)
            for plane, (name, b) in enumerate(zip("ab", drags, strict=True))
        ),
    )


def motion(found, weights, beside):
    """The motion of so many weights near a natural frequency."""
    nearest = min(found.natural, key=lambda one: abs(one.frequency - beside))
    return next(m for m in nearest.motions if m.weights == weights)


def test_captured_balls_turn_as_fast_as_an_integration_finds():
    assembly = planar(0.02, 0.001, mass=0.03267)
    found = capture(assembly, 3.0)
    assert motion(found, 2, 0.97).frequency == pytest.approx(0.9128, rel=5e-4)
    assert motion(found, 1, 0.97).frequency == pytest.approx(0.9293, rel=5e-4)


def test_their_vibration_lies_between_theirs_alone_and_that_with_the_unbalance_added():
    found = capture(planar(0.02, 0.001, mass=0.03267), 3.0)
    own, added = motion(found, 2, 0.97).amplitude[0], found.unbalance_amplitude[0]
    assert own < 0.488 < 1.01 * (own + added)


def test_balls_are_let_go_where_a_slow_run_up_lets_them_go():
    found = capture(planar(), 4.08)
    assert motion(found, 2, 0.97).release_speed == pytest.approx(2.914, rel=0.01)
    assert found.all_pass
    assert found.release_speed == pytest.approx(2.908, rel=1e-3)


def test_no_ball_is_left_behind_beyond_the_drag_limit():
    found = capture(planar(drag=0.0075), 4.0)
    assert found.all_pass
    assert found.drag_ratio * 0.0075 == pytest.approx(0.006457, rel=1e-3)
    assert not capture(planar(drag=0.006), 4.0).all_pass


def test_two_natural_frequencies_of_unequal_supports_both_hold_balls():
    found = capture(planar((0.1, 0.2), 0.006, stiffness=(1.0, 4.0)), 4.0)
    assert motion(found, 2, 1.94).frequency == pytest.approx(1.83, rel=5e-3)
    assert motion(found, 1, 1.94).frequency == pytest.approx(1.883, rel=2e-3)
    assert len(found.natural) == 2


@pytest.mark.parametrize(
    ("drag", "translation", "tilt"),
    [(0.0025, 0.94, 2.70), (0.005, 0.95, 2.81), (0.01, 0.95, 2.92), (0.02, None, 3.03),
     (0.04, None, 3.12), (0.0012, None, 2.52)],
)  # fmt: skip
def test_balls_on_two_planes_of_a_gyroscopic_rotor_turn_as_an_integration_finds(
    drag, translation, tilt
):
    found = capture(two_planes(drag), 4.0)
    assert motion(found, 4, 3.4).frequency == pytest.approx(tilt, rel=0.012)
    if translation:
        assert motion(found, 4, 0.96).frequency == pytest.approx(translation, rel=0.006)


def test_a_tilting_mode_that_rises_with_the_speed_never_lets_go():
    found = capture(two_planes(0.02), 4.0)
    assert motion(found, 4, 3.4).release_speed == math.inf
    assert motion(found, 4, 0.96).release_speed < 5.0


def gyroscopic(drag):
    """Its forward tilting mode lies above 1.9 rad/s, where the mode itself is at 2.18 rad/s."""
    rotor = LinearRotor.two_support(
        mass=1.0, inertia=0.08, polar_inertia=0.04, span=1.0,
        stiffness=((0.5, 0.5), (0.5, 0.5)), damping=((0.02, 0.02), (0.02, 0.02)),
        planes=(0.2, 0.8), unbalances=((0.2, 0.004, 0.0), (0.8, 0.004, 2.0)),
    )  # fmt: skip
    device = Weights(2, 0.02, 1.0, drag, 1.4)
    return Assembly(rotor, tuple(Mounted(n, device, p, (0.0, 0.0)) for p, n in enumerate("ab")))


def test_nothing_is_said_where_weights_slip_below_a_natural_frequency_above_the_speed():
    """Run up to 1.9 rad/s within 170 s, the balls turn at 1.886 rad/s in an integration."""
    found = capture(gyroscopic(0.3), 1.9)
    assert found.all_pass is None
    assert not found.motions
    assert found.slip == pytest.approx(1.9 - 1.886, rel=0.15)
    assert capture(gyroscopic(1.0), 1.9).all_pass is True
    assert capture(gyroscopic(0.02), 1.9).all_pass is False


@pytest.mark.parametrize(("damping", "lag"), [(0.2, 0.1045), (0.12, 0.0396)])
def test_a_single_weight_on_strongly_damped_supports_lags_beyond_its_natural_frequency(
    damping, lag
):
    """It ends there in an integration from half of the rotor's speed, without unbalance."""
    drag = 0.002**2 / (2.5 * damping)
    found = capture(planar(damping, drag, count=1, mass=0.002), 4.0)
    assert not found.motions
    assert found.all_pass is None
    assert found.lone_lag / 4.0 == pytest.approx(lag, abs=1e-4)
    three = capture(planar(damping, 3.0 * drag, count=3, mass=0.002), 4.0)
    assert three.all_pass is True  # 48 starts of six machines of three and four have turned along


def test_slip_below_a_strongly_damped_natural_frequency_is_seen_without_a_peak_of_its_brake():
    """Balls on a bending rotor turn at 0.979 of its speed in an integration, for ever."""
    damping = ((0.2963, 0.2963), (0.2963, 0.2963))
    rotor = LinearRotor.flexible(
        stations=(0.0, 0.3775, 0.6601, 1.0), masses=(0.1, 0.5, 0.5, 0.1), supports=(1, 4),
        support_stiffness=((2.0, 2.0), (2.0, 2.0)), support_damping=damping,
        bending_stiffness=0.0408, unbalances=[(0.3775, 0.00356, 0.0), (0.6601, 0.00356, 3.41)],
    )  # fmt: skip
    device = Weights(2, 0.0353, 1.0, 0.1126, 1.4)
    assembly = Assembly(
        rotor, tuple(Mounted(n, device, p, (0.0, 0.0)) for p, n in ((1, "a"), (2, "b")))
    )
    found = capture(assembly, 2.634)
    assert found.all_pass is None
    assert found.slip / 2.634 == pytest.approx(1.0 - 0.979, rel=0.02)


def test_the_drag_limit_does_not_depend_on_the_present_drag():
    """Weights that turn with the rotor feed its motion by their drag: k < N alone depend on it."""
    limits = [drag * capture(gyroscopic(drag), 4.0).drag_ratio for drag in (0.02, 0.1, 0.3, 1.0)]
    assert limits == pytest.approx([0.28765] * 4, rel=1e-3)
    few = [
        drag * motion(capture(gyroscopic(drag), 4.0), 3, 2.84).drag_ratio for drag in (0.02, 0.1)
    ]
    assert few[0] > 2.0 * few[1]


@pytest.mark.parametrize("number", range(6))
@pytest.mark.parametrize("kind", ["two planes", "gyroscopic", "flexible"])
def test_the_drag_limit_is_a_limit_when_it_is_set(kind, number):
    """It is stated from drags up to 300 times lower, at which other weights are held longest."""
    random = np.random.default_rng([43, number])
    drawn = draw(kind, random)
    lowest = float(modes(drawn.assembly.loaded_rotor, 0.0).natural_frequencies.min())
    speed = lowest * random.uniform(2.0, 4.0)
    limit = capture(drawn.assembly, speed).drag_ratio
    assert capture(drawn.with_drag(0.98 * limit).assembly, speed).all_pass is False
    above = capture(drawn.with_drag(1.02 * limit).assembly, speed)
    assert not above.motions
    assert above.drag_ratio == pytest.approx(1.0 / 1.02, rel=3e-3)


def near_its_speed(kind="gyroscopic", seed=(77, 4, 59)):
    """A rotor with a natural frequency a few per cent below its speed, and the speed."""
    random = np.random.default_rng(list(seed))
    drawn = draw(kind, random)
    lowest = float(modes(drawn.assembly.loaded_rotor, 0.0).natural_frequencies.min())
    drawn = drawn.with_drag(float(np.exp(random.uniform(np.log(0.1), np.log(10.0)))))
    return drawn, lowest * random.uniform(2.0, 5.0)


@pytest.mark.parametrize(
    ("kind", "seed"),
    [
        ("gyroscopic", (77, 4, 10)),
        ("flexible", (12, 5, 25)),
        ("flexible", (31, 47)),
        ("gyroscopic", (53, 34)),  # peaks at 0.69 and 0.68 of the speed
        ("gyroscopic", (1002, 4, 270)),
    ],
)
def test_no_weights_are_left_behind_near_the_rotors_speed_above_the_drag_limit(kind, seed):
    drawn, speed = near_its_speed(kind, seed)
    limit = capture(drawn.assembly, speed).drag_ratio
    for part in (1.01, 1.03, 1.06, 1.12, 1.18):
        assert not capture(drawn.with_drag(part * limit).assembly, speed).motions


@pytest.mark.parametrize("kappa", [1.0, 1.4, 1.5])
def test_weights_without_drag_pull_the_other_way_where_the_lag_says(kappa):
    device = Weights(2, 0.03, 1.0, 0.01, kappa)
    rotor = LinearRotor.planar(1.0, 1.0, 0.1)
    groups = groups_of(Assembly(rotor, (Mounted("balls", device, 0, (0.0, 0.0)),)))
    lag, speed = Lag(groups, np.array([0.01])), 4.0
    w = lag.turned_over * speed * np.array([[0.999, 1.0, 1.001]])
    beyond_mass = lag.others(w, speed, np.array([[1.0]]), 1, 1e-6)[0, 0].real
    force = 0.03 * w[0] ** 2 + beyond_mass
    assert force[0] > 0.0 > force[2]
    assert force[1] == pytest.approx(0.0, abs=1e-9)


def test_the_drag_limit_covers_drags_beyond_a_gap():
    """Between two ranges of drag no three weights are held; an integration holds two above it."""
    drawn, speed = near_its_speed()
    limit = capture(drawn.assembly, speed).drag_ratio
    for part in (0.2, 0.3, 0.5, 0.8, 0.95):
        there = capture(drawn.with_drag(part * limit).assembly, speed)
        assert there.drag_ratio == pytest.approx(1.0 / part, rel=5e-3)
    inside = drawn.with_drag(0.8 * limit)
    ((_, held),) = capture(inside.assembly, speed).motions
    assert held.numbers == (0, 2)
    rates = np.array([speed, speed, held.frequency, held.frequency])
    weights = [replace(w, drag=w.drag * (1.0 + 1e-4 * k)) for k, w in enumerate(inside.weights)]
    end = 300.0 * math.tau / speed
    args = [(0.0, speed)], np.array([1.0, 4.0, 0.0, 0.05]), rates, end, 20, 120
    windows, _ = run(inside.rotor, weights, *args)
    means = windows[-4:, 2::3].mean(axis=0)
    assert means[2:] == pytest.approx([held.frequency] * 2, rel=1e-3)
    assert (means[:2] > 0.99 * speed).all()
    assert capture(drawn.with_drag(1.05 * limit).assembly, speed).all_pass is not False


def test_weights_are_let_go_where_phases_between_planes_turn_over():
    """An integration lets go all four at 2.831 rad/s; beyond a gap they could turn up to 2.958."""
    rotor = LinearRotor.two_support(
        mass=1.0, inertia=0.0892, polar_inertia=0.0445, span=1.0,
        stiffness=((0.5, 0.5), (0.5, 0.5)), damping=((0.0949, 0.0949), (0.0949, 0.0949)),
        planes=(0.1685, 0.7779), unbalances=((0.2, 0.0146, 5.95), (0.8, 0.0146, 5.88)),
    )  # fmt: skip
    device = Weights(2, 0.0242, 1.0, 0.0055, 1.4)
    assembly = Assembly(rotor, tuple(Mounted(n, device, p, (0.0, 0.0)) for p, n in enumerate("ab")))
    for speed in (2.0, 3.9):
        released = motion(capture(assembly, speed), 4, 0.955).release_speed
        assert released == pytest.approx(2.831, rel=0.01)
    assert not [one for one, _ in capture(assembly, 2.85).motions if one.frequency < 1.0]


@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_without_damping_nothing_is_said():
    """Weights are left behind there whatever their drag, and rounding is not negative damping."""
    found = capture(planar(damping=0.0, drag=10.0), 3.0)
    assert found.all_pass is None
    assert found.undamped == pytest.approx(1.0 / math.sqrt(1.0654), rel=1e-6)
    assert capture(planar(damping=1e-7, drag=10.0), 3.0).all_pass is False
    rotor = LinearRotor.two_support(
        mass=1.0, inertia=0.04, polar_inertia=0.02, span=1.0,
        stiffness=((0.5, 0.5), (0.5, 0.5)), planes=(0.25,),
    )  # fmt: skip
    device = Weights(2, 0.02, 1.0, 0.1, 1.4)
    found = capture(Assembly(rotor, (Mounted("a", device, 0, (0.0, 0.0)),)), 3.0)
    assert not found.unstable
    assert found.undamped == pytest.approx(0.97, rel=0.02)


def test_part_of_the_weights_beside_a_near_natural_frequency_have_no_release_speed():
    found = capture(gyroscopic(0.02), 4.0)
    assert math.isnan(motion(found, 3, 2.84).release_speed)
    assert motion(found, 2, 0.97).release_speed > 0.97


def test_far_below_every_natural_frequency_nothing_is_left_behind():
    found = capture(planar(), 0.3)
    assert found.natural == ()
    assert found.all_pass is True
    assert found.drag_ratio == found.slip == 0.0


def test_light_damping_gives_the_release_speed_of_the_formula():
    mass, damping, drag = 0.01, 0.002, 0.01
    found = capture(planar(damping, drag, mass=mass, count=3), 2.0)
    natural = 1.0 / math.sqrt(1.03)
    expected = natural + 3 * mass**2 * natural**3 / (damping * drag)
    assert motion(found, 3, natural).release_speed == pytest.approx(expected, rel=2e-3)


def test_track_radius_and_rolling_inertia_make_no_difference():
    small = Assembly(
        LinearRotor.planar(1.0, 1.0, 0.1, unbalance=0.01),
        (Mounted("p", Weights(2, 0.0327, 0.2, 0.0101, 1.0), 0, (0.0, 0.0)),),
    )
    assert capture(small, 4.08).release_speed == pytest.approx(
        capture(planar(), 4.08).release_speed, rel=1e-9
    )


def test_internal_damping_takes_from_the_brake_what_the_closed_form_of_one_mass_says():
    """Circular motion at w: the rotor's damping acts as c w - c_i (Om - w)."""
    c, ci, k, m, h = 0.1, 0.002, 1.0, 0.0327, 0.006
    assembly = planar(c, h, internal_damping=ci)
    found = motion(capture(assembly, 3.0), 2, 0.97)
    total = 1.0 + 2.0 * m
    w = np.linspace(0.5, 1.2, 200001)

    def lag(speed):
        damping = c * w - ci * (speed - w)
        return 2.0 * m**2 * w**4 * damping / ((k - total * w**2) ** 2 + damping**2) / h

    brake = lag(3.0)
    lower = w < w[brake.argmax()]
    assert found.frequency == pytest.approx(
        float(w[lower][np.argmin(np.abs(w + brake - 3.0)[lower])]), rel=1e-4
    )
    release = found.release_speed
    brake = lag(release)
    assert release == pytest.approx(float(w[brake.argmax()] + brake.max()), rel=1e-4)


def test_internal_damping_that_makes_the_brake_grow_never_lets_go():
    found = capture(planar(0.1, 0.006, internal_damping=0.01), 3.0)
    assert motion(found, 2, 0.97).release_speed == math.inf


def test_an_unstable_rotor_is_not_judged():
    assert capture(planar(0.01, internal_damping=0.1), 3.0).unstable


def test_balls_that_touch_brake_as_much_as_their_static_moment_says():
    found = capture(planar(radius=0.3, count=3), 1.5)
    points = capture(planar(count=3), 1.5)
    alpha = math.asin(0.3)
    share = (math.sin(3 * alpha) / (3 * math.sin(alpha))) ** 2
    one, other = (motion(c, 3, 0.97).peak[1] for c in (found, points))
    assert one / other == pytest.approx(share, rel=1e-9)


def test_two_groups_in_closed_form_agree_with_newtons_method():
    random = np.random.default_rng(3)
    at = random.normal(size=(2, 2, 40)) + 1j * random.normal(size=(2, 2, 40))
    at -= 4.0j * np.eye(2)[..., None]
    moments, pull = np.array([[1.0], [1.1]]), np.array([[1.0], [1.3]])
    lag, turned = balance_two(at, moments, pull)
    torque = np.moveaxis(1j * at * (moments[:, None] * moments), -1, 0)
    start = np.stack([np.zeros(40), turned + 0.01], axis=1)
    newton, angles = balance(torque, np.repeat(pull.T, 40, axis=0), start)
    both = ~np.isnan(newton) & ~np.isnan(lag)
    assert both.sum() > 20
    assert newton[both] == pytest.approx(lag[both], rel=1e-6)
    assert np.cos(angles[both, 1] - turned[both]) == pytest.approx(1.0, abs=1e-9)


def test_three_balancers_on_a_flexible_shaft_satisfy_their_balance_of_torques():
    """Every weight's mean torque, computed from the motion itself."""
    rotor = LinearRotor.flexible(
        stations=(0.0, 0.4, 0.7, 1.0), masses=(0.2, 1.0, 1.2, 0.2), supports=(1, 4),
        support_stiffness=((50.0, 50.0), (60.0, 60.0)),
        support_damping=((0.5, 0.5), (0.5, 0.5)),
        bending_stiffness=5.0, unbalances=((0.4, 0.01, 0.0),),
    )  # fmt: skip
    devices = [Weights(2, 0.02, 0.3, drag, 1.4) for drag in (0.002, 0.0025, 0.002)]
    places = (1, 2, 1)
    assembly = Assembly(
        rotor,
        tuple(Mounted(n, d, p, (0.0, 0.0)) for n, d, p in zip("abc", devices, places, strict=True)),
    )
    found = capture(assembly, 12.0)
    (_, m), *_ = [pair for pair in found.motions if pair[1].weights == 6]
    w = m.frequency
    lag = Lag(groups_of(assembly), np.array(found.drags))
    loaded = assembly.loaded_rotor
    mass, damping, stiffness = loaded.real_coefficients(12.0)
    dynamic = stiffness - w * w * mass + 1j * w * damping
    numbers = np.array([m.numbers], float)
    receptance = Receptance(loaded, lag.used)
    lags, phases = lag.at(receptance, np.array([[w]]), 12.0, numbers, m.phases[None])
    assert w + lags[0, 0] == pytest.approx(12.0, rel=1e-6)
    force = np.zeros(2 * 4, complex)
    for place, phase in zip(places, phases[0, 0], strict=True):
        turning = 2 * 0.02 * 0.3 * w * w * np.exp(1j * phase)
        force[place] += turning
        force[4 + place] += -1j * turning
    moved = np.linalg.solve(dynamic, force)
    time = np.linspace(0.0, math.tau / w, 400, endpoint=False)
    x = (moved[:, None] * np.exp(1j * w * time)).real * -(w**2)
    for place, phase, device in zip(places, phases[0, 0], devices, strict=True):
        angle = w * time + phase
        pull = -0.02 * np.mean(x[4 + place] * np.cos(angle) - x[place] * np.sin(angle))
        assert -pull == pytest.approx(device.drag * 0.3 * (12.0 - w), rel=1e-6)


def test_no_weights_and_dry_friction_are_refused():
    bare = Assembly(LinearRotor.planar(1.0, 1.0))
    with pytest.raises(ValueError, match="no weights"):
        capture(bare, 1.0)
    with pytest.raises(ValueError, match="must be positive"):
        capture(planar(), 0.0)


def test_the_share_of_the_capacity_is_that_of_the_plane_with_most_to_undo():
    """A rotor that overhangs its supports: parts of its unbalance oppose each other there."""
    rotor = LinearRotor.two_support(
        mass=9.0, inertia=0.25, span=0.12, com=0.25, stiffness=[[1e4, 1e4]] * 2,
        damping=[[50.0, 50.0]] * 2, planes=[0.13, 0.39], unbalances=[(0.33, 0.04, 0.0)],
    )  # fmt: skip
    weights = Weights(count=3, mass=0.06, track_radius=0.23, drag=2.0)
    mounted = tuple(Mounted(name, weights, k, (0.0, 2.0, 4.0)) for k, name in enumerate("ab"))
    found = capture(Assembly(rotor, mounted), 125.0)
    needed = 0.04 * (0.33 - 0.13) / (0.39 - 0.13)
    assert found.unbalance_share == pytest.approx(needed / (3 * 0.06 * 0.23), rel=1e-9)
