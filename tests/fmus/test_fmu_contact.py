"""The unit with weights of finite size, rolling resistance and a track off centre."""

from __future__ import annotations

import cmath
import json
import math
import shutil

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave

from autobalancer.fmus.build import build
from autobalancer.fmus.weights import BallBalancer
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


def unit_of(weights=3, frame="rotor", **values):
    unit = BallBalancer.configured(weights=weights, frame=frame)(instance_name="unit")
    for name, value in values.items():
        unit.set_real([unit.layout.index[name]], [value])
    return unit


def started(**values):
    unit = unit_of(**{**COMMON, **values})
    for k, (angle, rate) in enumerate(zip(ANGLES, RATES, strict=True), start=1):
        for name, value in ((f"weight[{k}].angle0", angle), (f"weight[{k}].speed0", rate)):
            unit.set_real([unit.layout.index[name]], [value])
    unit.exit_initialization_mode()
    return unit


def pulled(unit, k):
    """Step k under a constant acceleration whirling in the rotor frame."""
    a = 20.0 * cmath.exp(0.02j * k)
    first = unit.layout.index["a_xi"]
    unit.set_real([first, first + 1], [a.real, a.imag])
    assert unit.do_step(k * STEP, STEP)
    return unit.real[:]


def test_unit_is_the_model_with_its_pulses():
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
        first = unit.layout.index["F_xi"]
        assert unit.get_real([first, first + 1]) == pytest.approx(expected, rel=1e-12)
        slope = unit.layout.index["der(F_xi)"]
        assert unit.get_real([slope])[0] == pytest.approx(force[1].real, rel=1e-12)
    assert struck
    assert unit.memory[:9] == [*state[0], *state[1], *state[2]]


def test_rollback_in_the_midst_of_collisions_is_exact_and_survives_json():
    unit = started()
    for k in range(4):
        pulled(unit, k)
    while not any(unit.memory[-4:]):  # until an impulse is owed or being given
        k += 1
        pulled(unit, k)
    saved = unit._fmu_state_to_bytes(unit._get_fmu_state())
    assert "memory" in json.loads(saved)
    first = [pulled(unit, j) for j in range(k + 1, k + 30)]
    end = unit.memory
    unit._set_fmu_state(unit._fmu_state_from_bytes(saved))
    assert [pulled(unit, j) for j in range(k + 1, k + 30)] == first
    other = started()
    other._set_fmu_state(other._fmu_state_from_bytes(saved))
    assert [pulled(other, j) for j in range(k + 1, k + 30)] == first
    assert other.memory == end


def test_without_options_the_state_and_the_way_are_those_of_point_weights(monkeypatch):
    def refuse(*_args):
        raise AssertionError("the way with events was taken")

    monkeypatch.setattr("autobalancer.models.contact.motion.advance", refuse)
    monkeypatch.setattr("autobalancer.models.contact.motion.reaction", refuse)
    names = COMMON.keys() - {"mass", "track_radius", "kappa", "drag", "speed"}
    unit = started(**dict.fromkeys(names, 0.0))
    pulled(unit, 0)
    assert len(unit.memory) == 6


def test_contact_in_fixed_axes_is_that_in_the_rotors_to_the_order_of_the_signals():
    """One acceleration, given to each unit by its own Taylor polynomials; collisions and pulses."""
    turning, own = 1j * SPEED, 10j

    def worst(step):
        """Largest difference of forces turned back, and how many steps gave a pulse."""
        rotor, fixed = started(), started(frame="fixed")
        index = fixed.layout.index
        error, pulses = 0.0, 0
        for k in range(round(0.12 / step)):
            t = k * step
            a = 20.0 * cmath.exp(own * t)
            turn = cmath.exp(turning * t)
            for unit, names, value, rate in (
                (rotor, ("a_xi", "F_xi"), a, own),
                (fixed, ("a_x", "F_x"), a * turn, own + turning),
            ):
                first = unit.layout.index[names[0]]
                orders = [value * rate**j for j in range(4)]
                parts = [part for z in orders for part in (z.real, z.imag)]
                unit.set_real(list(range(first, first + 8)), parts)
            fixed.set_real([index["angle"]], [SPEED * t])
            assert rotor.do_step(t, step)
            assert fixed.do_step(t, step)
            force, other = (
                complex(*unit.get_real([unit.layout.index[n], unit.layout.index[n] + 1]))
                for unit, n in ((rotor, "F_xi"), (fixed, "F_x"))
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


def test_weights_that_touch_at_the_start_press_on_each_other_in_the_first_force():
    alpha = math.asin(0.12)
    middle, a = math.pi - 0.4, 20.0 + 5.0j
    angles = [middle - 2 * alpha, middle, middle + 2 * alpha]
    unit = unit_of(**{**COMMON, "rolling_resistance": 0.0})
    for k, angle in enumerate(angles, start=1):
        unit.set_real([unit.layout.index[f"weight[{k}].angle0"]], [angle])
    first = unit.layout.index["a_xi"]
    unit.set_real([first, first + 1], [a.real, a.imag])
    unit.exit_initialization_mode()
    force = unit.layout.index["F_xi"]
    found = complex(*unit.get_real([force, force + 1]))
    track = Track(Weights(3, 0.02, 0.1, 0.01, 1.4), 0.012, 0.6, 0.0, 1e-3 - 2e-3j)
    state = angles, [0.0] * 3
    pressed = reaction(track, *state, [1.0, 1.0, 0.0], a, 0j, SPEED, 0.0)[0]
    free = reaction(track, *state, [0.0] * 3, a, 0j, SPEED, 0.0)[0]
    assert found == pytest.approx(pressed, rel=1e-12)
    assert abs(pressed - free) > 1e-3 * abs(pressed)
    # 1e-9 rad apart they do not touch
    assert first_contacts(track, [angles[0] - 1e-9, *angles[1:]], [0.0] * 3) == [0.0, 1.0, 0.0]
    assert first_contacts(track, angles, [0.0, 0.0, 1.0]) == [1.0, 0.0, 0.0]


def test_sixty_four_packed_weights_stay_packed_in_the_fmu(tmp_path):
    alpha = math.asin(0.02)
    path = build("BallBalancer", tmp_path, weights=64)
    description = fmpy.read_model_description(str(path))
    reference = {v.name: v.valueReference for v in description.modelVariables}
    folder = fmpy.extract(str(path))
    slave = FMU2Slave(
        guid=description.guid, unzipDirectory=folder, instanceName="unit",
        modelIdentifier=description.coSimulation.modelIdentifier,
    )  # fmt: skip
    slave.instantiate()
    slave.setupExperiment()
    slave.enterInitializationMode()
    values = {"mass": 1e-3, "track_radius": 0.5, "weight_radius": 0.01, "drag": 1e-3,
              "speed": SPEED, "a_xi": 5.0}  # fmt: skip
    # packed on the side to which they are driven: theta'' = -Im(a e^{-i theta})/(kappa R)
    values |= {f"weight[{k}].angle0": math.pi + alpha * (2 * k - 65) for k in range(1, 65)}
    slave.setReal([reference[name] for name in values], list(values.values()))
    slave.exitInitializationMode()
    shutil.rmtree(f"{folder}/resources")  # nothing is imported later
    for k in range(300):
        slave.doStep(k * 5e-3, 5e-3)
    angles = slave.getReal([reference[f"weight[{k}].angle"] for k in range(1, 65)])
    slave.terminate()
    slave.freeInstance()
    shutil.rmtree(folder)
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


def test_track_off_centre_is_a_track_that_feels_the_pull_of_its_offset():
    """Point weights about e feel a - w^2 e and carry their mass there: N m w^2 e of force."""
    e = 1e-3 - 2e-3j
    points = {"weight_radius": 0.0, "restitution": 0.0, "rolling_resistance": 0.0}
    moved = started(**points)
    plain = started(**points, track_offset_xi=0.0, track_offset_eta=0.0)
    first, force = moved.layout.index["a_xi"], moved.layout.index["F_xi"]
    for k in range(40):
        a = 20.0 * cmath.exp(0.02j * k)
        for unit, z in ((moved, a), (plain, a - SPEED**2 * e)):
            unit.set_real([first, first + 1], [z.real, z.imag])
            assert unit.do_step(k * STEP, STEP)
        assert moved.memory[:6] == pytest.approx(plain.memory, rel=1e-12, abs=1e-13)
        found, other = (complex(*u.get_real([force, force + 1])) for u in (moved, plain))
        assert found == pytest.approx(other + 3 * 0.02 * SPEED**2 * e, rel=1e-11)
