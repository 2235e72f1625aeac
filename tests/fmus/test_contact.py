"""The unit with weights of finite size, rolling resistance and a track off centre."""

from __future__ import annotations

import cmath
import json
import math
import shutil

import numpy as np
import pytest

from autobalancer.harness import load_scene
from autobalancer.harness.errors import SceneError
from autobalancer.harness.master.plan import plan
from autobalancer.models.contact.contact import restitution_on
from autobalancer.models.contact.motion import advance, first_contacts, reaction
from autobalancer.models.contact.pulse import discharge
from autobalancer.models.contact.track import Track
from autobalancer.models.weights import Weights

SPEED = 30.0
COMMON = {
    "mass": 0.02, "track_radius": 0.1, "kappa": 1.4, "drag": 0.01, "weight_radius": 0.012,
    "restitution": 0.6, "rolling_resistance": 0.002, "track_offset_xi": 1e-3,
    "track_offset_eta": -2e-3, "speed": SPEED,
}  # fmt: skip
ANGLES, RATES = [0.3, 1.1, 3.0], [6.0, -5.0, -3.0]
STEP = 2e-3


@pytest.fixture
def unit_of(probe):
    """Three weights, not yet started."""
    return lambda frame="rotor", **values: probe(
        "BallBalancer", values, begin=False, weights=3, frame=frame
    )


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
    return unit.real[:]


def test_unit_is_the_model_with_its_pulses(started):
    unit = started()
    weights = Weights(3, 0.02, 0.1, 0.01, 1.4)
    track = Track(weights, 0.012, 0.6, 0.002, 1e-3 - 2e-3j)
    state, owed, pulse, struck = (ANGLES, RATES, [0.0] * 3), 0j, 0j, 0
    for k in range(60):
        pulled(unit, k)
        a = 20.0 * cmath.exp(0.02j * k)
        moved = advance(track, *state, (a, 0j, 0j, 0j), SPEED, 0.0, STEP)
        state = moved[:3]
        owed, pulse = discharge(owed, pulse, moved.impulse, SPEED * STEP, STEP)
        struck += moved.impulse != 0j
        force = reaction(track, *state, a, 0j, SPEED, 0.0)
        expected = [force[0].real + pulse.real, force[0].imag + pulse.imag]
        assert unit.look("F_xi", "F_eta") == pytest.approx(expected, rel=1e-12)
        assert unit.look("der(F_xi)")[0] == pytest.approx(force[1].real, rel=1e-12)
    assert struck
    assert unit.memory[:9] == [*state[0], *state[1], *state[2]]


def test_rollback_in_the_midst_of_collisions_is_exact_and_survives_json(started):
    unit = started()
    for k in range(4):
        pulled(unit, k)
    while not any(unit.memory[-4:]):  # until an impulse is owed or being given
        k += 1
        pulled(unit, k)
    saved = unit.packed()
    assert "memory" in json.loads(saved)
    first = [pulled(unit, j) for j in range(k + 1, k + 30)]
    end = unit.memory
    unit.restore(saved)
    assert [pulled(unit, j) for j in range(k + 1, k + 30)] == first
    other = started()
    other.restore(saved)
    assert [pulled(other, j) for j in range(k + 1, k + 30)] == first
    assert other.memory == end


def test_without_options_the_state_and_the_way_are_those_of_point_weights(monkeypatch, started):
    def refuse(*_args):
        raise AssertionError("the way with events was taken")

    monkeypatch.setattr("autobalancer.models.contact.motion.run", refuse)
    monkeypatch.setattr("autobalancer.models.contact.motion.ring_reaction", refuse)
    names = COMMON.keys() - {"mass", "track_radius", "kappa", "drag", "speed"}
    unit = started(**dict.fromkeys(names, 0.0))
    pulled(unit, 0)
    assert len(unit.memory) == 6 + 1  # and how long ago inputs were set


def test_contact_in_fixed_axes_is_that_in_the_rotors_to_the_order_of_the_signals(started):
    """One acceleration, given to each unit by its own Taylor polynomials; collisions and pulses."""
    turning, own = 1j * SPEED, 10j

    def worst(step):
        """Largest difference of forces turned back, and how many steps gave a pulse."""
        rotor, fixed = started(), started(frame="fixed")
        error, pulses = 0.0, 0
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
            pulses += any(rotor.memory[-2:])
            assert [bool(c) for c in rotor.memory[6:9]] == [bool(c) for c in fixed.memory[6:9]]
        return error, pulses

    coarse, pulses = worst(2e-3)
    fine, _ = worst(1e-3)
    assert pulses
    assert coarse < 1e-3
    assert coarse / fine > 6.0


def test_weights_that_touch_at_the_start_press_on_each_other_in_the_first_force(unit_of):
    alpha = math.asin(0.12)
    middle, a = math.pi - 0.4, 20.0 + 5.0j
    angles = [middle - 2 * alpha, middle, middle + 2 * alpha]
    unit = unit_of(**{**COMMON, "rolling_resistance": 0.0})
    for k, angle in enumerate(angles, start=1):
        unit.put(f"weight[{k}].angle0", angle)
    unit.put("a_xi", a.real, a.imag)
    unit.exit_initialization_mode()
    found = complex(*unit.look("F_xi", "F_eta"))
    track = Track(Weights(3, 0.02, 0.1, 0.01, 1.4), 0.012, 0.6, 0.0, 1e-3 - 2e-3j)
    state = angles, [0.0] * 3
    pressed = reaction(track, *state, [1.0, 1.0, 0.0], a, 0j, SPEED, 0.0)[0]
    free = reaction(track, *state, [0.0] * 3, a, 0j, SPEED, 0.0)[0]
    assert found == pytest.approx(pressed, rel=1e-12)
    assert abs(pressed - free) > 1e-3 * abs(pressed)
    # 1e-9 rad apart they do not touch
    assert first_contacts(track, [angles[0] - 1e-9, *angles[1:]], [0.0] * 3) == [0.0, 1.0, 0.0]
    assert first_contacts(track, angles, [0.0, 0.0, 1.0]) == [1.0, 0.0, 0.0]


def test_sixty_four_packed_weights_stay_packed_in_the_fmu(fmu, host_of, backend):
    alpha = math.asin(0.02)
    host = host_of(fmu("BallBalancer", backend=backend, weights=64))
    values = {"mass": 1e-3, "track_radius": 0.5, "weight_radius": 0.01, "drag": 1e-3,
              "speed": SPEED, "a_xi": 5.0}  # fmt: skip
    # packed on the side to which they are driven: theta'' = -Im(a e^{-i theta})/(kappa R)
    values |= {f"weight[{k}].angle0": math.pi + alpha * (2 * k - 65) for k in range(1, 65)}
    host.start(**values)
    shutil.rmtree(f"{host.slave.unzipDirectory}/resources", True)  # nothing is read later
    host.run(300, step=5e-3)
    angles = [host[f"weight[{k}].angle"] for k in range(1, 65)]
    host.free()
    assert np.diff(angles) == pytest.approx(2 * alpha, abs=1e-9)


def test_scene_restitution_is_that_of_the_free_rotor():
    scene = load_scene("two_balls").replace(
        {"weights.weight_radius": 0.3, "weights.restitution": 0.7}
    )
    ball = scene.balancer[0]
    total = scene.rotor.mass + ball.count * ball.mass
    alpha = math.asin(0.3 / ball.track_radius)
    unit = plan(scene).units[1]
    expected = restitution_on(0.7, ball.mass, total, alpha, ball.kappa)
    assert 0.0 < expected < 0.7
    assert unit.start["restitution"] == pytest.approx(expected, rel=1e-12)


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
        assert moved.memory[:6] == pytest.approx(plain.memory[:6], rel=1e-12, abs=1e-13)
        found, other = (complex(*u.look("F_xi", "F_eta")) for u in (moved, plain))
        assert found == pytest.approx(other + 3 * 0.02 * SPEED**2 * e, rel=1e-11)
