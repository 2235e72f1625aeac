"""The unit with weights of finite size, rolling resistance and a track off centre."""

from __future__ import annotations

import cmath
import math

import pytest

from autobalancer.harness import load_scene
from autobalancer.harness.errors import SceneError
from autobalancer.harness.master.plan import plan
from autobalancer.models.weights import Weights
from tests.native.equations import discharge

SPEED = 30.0
COMMON = {
    "mass": 0.02, "track_radius": 0.1, "kappa": 1.4, "drag": 0.01, "weight_radius": 0.012,
    "restitution": 0.6, "rolling_resistance": 0.002, "track_offset_xi": 1e-3,
    "track_offset_eta": -2e-3, "speed": SPEED,
}  # fmt: skip
ANGLES, RATES = [0.3, 1.1, 3.0], [6.0, -5.0, -3.0]
STEP = 2e-3


@pytest.fixture
def unit_of(native_probe):
    """Three weights, not yet started."""

    def make(frame="rotor", **values):
        unit = native_probe("BallBalancer", weights=3, frame=frame)
        for name, value in values.items():
            unit.put(name, value)
        return unit

    return make


@pytest.fixture
def started(unit_of):
    """Three weights on their way."""

    def make(**values):
        unit = unit_of(**{**COMMON, **values})
        for k, (angle, rate) in enumerate(zip(ANGLES, RATES, strict=True), start=1):
            unit.put(f"weight[{k}].angle0", angle)
            unit.put(f"weight[{k}].speed0", rate)
        unit.exit_initialization_mode()
        return unit

    return make


def pulled(unit, k):
    """Step k under a constant acceleration whirling in the rotor frame."""
    a = 20.0 * cmath.exp(0.02j * k)
    unit.put("a_xi", a.real, a.imag)
    assert unit.do_step(k * STEP, STEP)


def test_unit_is_the_track_with_its_pulses(core, track_of, started):
    unit = started()
    weights = Weights(3, 0.02, 0.1, 0.01, 1.4)
    track = track_of(weights, 0.012, 0.6, 0.002, 1e-3 - 2e-3j)
    state, owed, pulse, struck = (ANGLES, RATES, [0.0] * 3), 0j, 0j, 0
    for k in range(60):
        pulled(unit, k)
        a = 20.0 * cmath.exp(0.02j * k)
        moved = track.advance(*state, (a, 0j, 0j, 0j), SPEED, 0.0, STEP)
        state = moved[:3]
        owed, pulse = discharge(core, owed, pulse, moved.impulse, SPEED * STEP, STEP)
        struck += moved.impulse != 0j
        force = track.reaction(*state, a, 0j, SPEED, 0.0)
        expected = [force[0].real + pulse.real, force[0].imag + pulse.imag]
        assert unit.look("F_xi", "F_eta") == pytest.approx(expected, rel=1e-12)
        assert unit.look("der(F_xi)")[0] == pytest.approx(force[1].real, rel=1e-12)
    assert struck
    angles = [f"weight[{k}].angle" for k in (1, 2, 3)]
    assert unit.look(*angles) == pytest.approx(state[0], rel=1e-12)


def test_contact_in_fixed_axes_is_that_in_the_rotors_to_the_order_of_the_signals(started):
    """One acceleration, given to each unit by its own Taylor polynomials; collisions and pulses."""
    turning, own = 1j * SPEED, 10j

    def worst(step):
        """Largest difference of forces turned back, and how many steps gave a pulse."""
        rotor, fixed = started(), started(frame="fixed")
        error, pulses, before = 0.0, 0, 0j
        for k in range(round(0.12 / step)):
            t = k * step
            a = 20.0 * cmath.exp(own * t)
            turn = cmath.exp(turning * t)
            for unit, name, value, rate in (
                (rotor, "a_xi", a, own),
                (fixed, "a_x", a * turn, own + turning),
            ):
                orders = [value * rate**j for j in range(4)]
                unit.put(name, *(part for z in orders for part in (z.real, z.imag)))
            fixed.put("angle", SPEED * t)
            assert rotor.do_step(t, step)
            assert fixed.do_step(t, step)
            force, other = (
                complex(*unit.look(*names))
                for unit, names in ((rotor, ("F_xi", "F_eta")), (fixed, ("F_x", "F_y")))
            )
            error = max(error, abs(other * cmath.exp(-turning * (t + step)) - force))
            pulses += abs(force - before) > 0.05  # a pulse, not the motion
            before = force
        return error, pulses

    coarse, pulses = worst(2e-3)
    fine, _ = worst(1e-3)
    assert pulses
    assert coarse < 1e-3
    assert coarse / fine > 6.0


@pytest.mark.parametrize(
    ("gap", "rate", "together"), [(0, 0, True), (1e-9, 0, False), (0, -0.5, False)]
)
def test_weights_that_touch_and_move_alike_press_on_each_other_in_the_first_force(
    track_of, unit_of, gap, rate, together
):
    alpha = math.asin(0.12)
    middle, a = math.pi - 0.4, 20.0 + 5.0j
    angles = [middle - 2 * alpha - gap, middle, middle + 2 * alpha + gap]
    speeds = [rate, 0.0, -rate]
    unit = unit_of(**{**COMMON, "rolling_resistance": 0.0})
    for k, angle in enumerate(angles, start=1):
        unit.put(f"weight[{k}].angle0", angle)
        unit.put(f"weight[{k}].speed0", speeds[k - 1])
    unit.put("a_xi", a.real, a.imag)
    unit.exit_initialization_mode()
    found = complex(*unit.look("F_xi", "F_eta"))
    track = track_of(Weights(3, 0.02, 0.1, 0.01, 1.4), 0.012, 0.6, 0.0, 1e-3 - 2e-3j)
    state = angles, speeds
    pressed = track.reaction(*state, [1.0, 1.0, 0.0], a, 0j, SPEED, 0.0)[0]
    free = track.reaction(*state, [0.0] * 3, a, 0j, SPEED, 0.0)[0]
    assert found == pytest.approx(pressed if together else free, rel=1e-12)
    assert abs(pressed - free) > 1e-3 * abs(pressed)


def test_a_scene_tells_weights_that_meet_the_mobility_of_their_plane():
    scene = load_scene("two_balls").replace(
        {"weights.weight_radius": 0.3, "weights.restitution": 0.7}
    )
    ball = scene.balancer[0]
    start = plan(scene).units[1].start
    assert start["restitution"] == 0.7
    total = scene.rotor.mass + ball.count * ball.mass
    assert start["track_mobility"] == pytest.approx(1.0 / total, rel=1e-12)


def test_restitution_of_points_is_refused_and_the_key_named():
    with pytest.raises(SceneError, match=r"restitution = 0.5.*give weight_radius"):
        load_scene("two_balls").replace({"weights.restitution": 0.5})
    with pytest.raises(SceneError, match=r"restitution = 1.5"):
        load_scene("two_balls").replace({"weights.weight_radius": 0.1, "weights.restitution": 1.5})


def test_track_off_centre_is_a_track_that_feels_the_pull_of_its_offset(started):
    """Point weights about e feel a - w^2 e and carry their mass there: N m w^2 e of force."""
    e = 1e-3 - 2e-3j
    points = {"weight_radius": 0.0, "restitution": 0.0, "rolling_resistance": 0.0}
    moved = started(**points)
    plain = started(**points, track_offset_xi=0.0, track_offset_eta=0.0)
    for k in range(40):
        a = 20.0 * cmath.exp(0.02j * k)
        for unit, z in ((moved, a), (plain, a - SPEED**2 * e)):
            unit.put("a_xi", z.real, z.imag)
            assert unit.do_step(k * STEP, STEP)
        names = [f"weight[{j}].{what}" for j in (1, 2, 3) for what in ("angle", "speed")]
        assert moved.look(*names) == pytest.approx(plain.look(*names), rel=1e-12, abs=1e-13)
        found, other = (complex(*u.look("F_xi", "F_eta")) for u in (moved, plain))
        assert found == pytest.approx(other + 3 * 0.02 * SPEED**2 * e, rel=1e-11)


@pytest.mark.parametrize(
    ("scene", "changes", "key"),
    [
        ("finite_weights", {}, "weight_radius"),
        ("two_balls", {"weights.rolling_resistance": 0.01}, "rolling_resistance"),
        ("two_balls", {"weights.track_offset_xi": 1e-3}, "track_offset"),
        ("bristol_friction", {}, "rotor.friction"),
        ("sommerfeld", {}, "operation.motor"),
    ],
)
def test_a_scene_that_python_units_do_not_compute_is_refused_by_its_key(scene, changes, key):
    whole = load_scene(scene).replace(changes)
    with pytest.raises(SceneError, match=rf"{key}: not with coupling.units = .python.: only nat"):
        whole.replace({"coupling.units": "python"})
