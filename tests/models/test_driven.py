"""A motor in one piece with all it drives, against its energy and a shaft too heavy to slow."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from autobalancer.models.assembly import Assembly, Mounted, SpeedProfile
from autobalancer.models.liquid import Liquid
from autobalancer.models.monolith import reference, simulate
from autobalancer.models.motor import Drive
from autobalancer.models.reference.coupled import Start
from autobalancer.models.reference.driven import MotorDriven
from autobalancer.models.rotor import LinearRotor
from autobalancer.models.weights import Weights

ROTOR = replace(
    LinearRotor.flexible(
        stations=[0.0, 0.4, 1.0], masses=[0.5, 2.0, 1.0], supports=[1, 3],
        support_stiffness=[(4e3, 6e3), (5e3, 3e3)], support_damping=[(6.0, 4.0), (5.0, 7.0)],
        bending_stiffness=300.0, internal_damping=3.0, unbalances=[(0.4, 8e-3, 0.4)],
    ),
    gravity=2.0 - 9.81j,
)  # fmt: skip
TILTING = replace(
    LinearRotor.two_support(
        mass=2.0, inertia=0.05, polar_inertia=0.04, span=0.4, com=0.15, planes=[0.05, 0.1, 0.35],
        stiffness=[(4e3, 6e3), (5e3, 3e3)], damping=[(6.0, 4.0), (5.0, 7.0)],
        unbalances=[(0.1, 8e-3, 0.4)],
    ),
    gravity=2.0 - 9.81j,
)  # fmt: skip
ROLLERS = Mounted(
    "rollers", Weights(2, 0.05, 0.08, drag=0.03, kappa=1.5, radius=0.01), plane=1,
    angles=(0.3, 2.0), speeds=(4.0, -2.0), offset=3e-3 - 2e-3j,
)  # fmt: skip
BOUNCING = replace(ROLLERS, half_angle=0.2, restitution=1.0, speeds=(20.0, -20.0))
PENDULUMS = Mounted("pendulums", Weights(1, 0.1, 0.06, drag=0.02), plane=2, angles=(1.0,))
ALL = Assembly(ROTOR, (ROLLERS, PENDULUMS))
START = Start((1e-3, 0.0, -1e-3), 0.0, (0.0, 0.05, 0.02), 0.0, 0.7)
MOTOR = Drive(0.02, (0.0, 60.0, 90.0), (1.5, 1.0, 0.0))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("rotor", "rollers", "bound"),
    [(ROTOR, ROLLERS, 1e-6), (TILTING, ROLLERS, 1e-6), (TILTING, BOUNCING, 1e-5)],
    ids=["flexible", "two_support", "elastic impacts"],
)
def test_the_motor_feeds_what_is_stored_and_dissipated(rotor, rollers, bound):
    """dE/dt = L w - P, from positions and velocities alone; the powers jump at impacts."""
    n, time = rotor.stations, np.linspace(0.0, 0.6, 2401)
    start = Start((1e-3, 0.0, -1e-3)[:n], 0.0, (0.0, 0.05, 0.02)[:n], 0.0, 0.7)
    whole = Assembly(rotor, (rollers, PENDULUMS))
    run = simulate(whole, MotorDriven(MOTOR, 45.0), time, initial=start, rtol=1e-11)
    z, v, w = run.x + 1j * run.y, run.vx + 1j * run.vy, run.speed
    turn, g = np.exp(1j * run.angle), rotor.gravity
    u = turn[:, None] * rotor.unbalance

    def squares(a, matrix):
        return np.einsum("ti,ij,tj->t", a.conj(), matrix, a).real

    energy = 0.5 * squares(v, rotor.mass) + 0.5 * MOTOR.inertia * w**2
    energy += (v.conj() * 1j * w[:, None] * u).sum(axis=1).real
    energy += 0.5 * (squares(run.x, rotor.stiffness_x) + squares(run.y, rotor.stiffness_y))
    energy -= (np.conj(g) * ((z @ rotor.mass).sum(axis=1) + u.sum(axis=1))).real
    sheared = v - 1j * w[:, None] * z
    lost = squares(run.vx, rotor.damping_x) + squares(run.vy, rotor.damping_y)
    lost = lost + squares(sheared, rotor.internal_damping)
    for mounted in (rollers, PENDULUMS):
        device, rate = mounted.device, run.angle_rate[mounted.name]
        radius, row = device.track_radius, rotor.planes[mounted.plane]
        arm = radius * np.exp(1j * run.theta[mounted.name]) * turn[:, None]
        centre = (z @ row + mounted.offset * turn)[:, None]
        moves = (v @ row + 1j * w * mounted.offset * turn)[:, None]
        moves = moves + 1j * (rate + w[:, None]) * arm
        rolls = radius * rate - device.radius * w[:, None]
        rolling = (device.kappa - 1.0) * device.mass * rolls**2
        weight = (np.conj(g) * (centre + arm)).real
        kinetic = 0.5 * (device.mass * np.abs(moves) ** 2 + rolling)
        energy += (kinetic - device.mass * weight).sum(axis=1)
        lost = lost + device.drag * radius**2 * (rate**2).sum(axis=1)
    fed = np.interp(w, MOTOR.speeds, MOTOR.torques) * w
    gained = CubicSpline(time, fed - lost).antiderivative()(time)
    assert w.max() > 60.0  # beyond the corner of the characteristic
    assert np.abs(energy - energy[0] - gained).max() < bound * np.ptp(energy)
    turned_back = np.abs(np.diff(run.angle_rate["rollers"], axis=0)).max() > 5.0
    assert turned_back == (rollers is BOUNCING)


@pytest.mark.slow
def test_a_shaft_that_is_heavy_enough_keeps_its_speed():
    time, speed = np.linspace(0.0, 0.5, 101), 70.0
    heavy = Drive(1e9, (0.0, speed), (1.0, 0.0))
    driven, own = reference(ALL, MotorDriven(heavy, speed), time, initial=START, bound=1e-6)
    steady = simulate(ALL, SpeedProfile.constant(speed), time, initial=START, rtol=1e-12)
    assert own < 1e-8
    for name in (*steady.names(), "motor.speed", "rotor.angle", "rollers.F_xi"):
        right = steady["rotor.speed" if name == "motor.speed" else name]
        assert np.abs(driven[name] - right).max() < 1e-7 * np.abs(right).max(), name


def test_weights_that_stick_are_refused():
    balancers = (replace(ROLLERS, rolling_resistance=0.01),)
    with pytest.raises(ValueError, match="not under a motor"):
        simulate(Assembly(ROTOR, balancers), MotorDriven(MOTOR), [0.1], initial=START)


def test_a_liquid_is_mass_at_its_plane():
    liquid = Liquid(0.05, 0.04, 0.02, 1000.0)
    time = np.linspace(0.0, 0.5, 51)
    right = replace(ROTOR.with_added_mass([0.0, liquid.added_mass, 0.0]), planes=ROTOR.planes)
    runs = [
        simulate(assembly, MotorDriven(MOTOR, 20.0), time, initial=START, rtol=1e-10)
        for assembly in (Assembly(ROTOR, (Mounted("liquid", liquid, 1),)), Assembly(right))
    ]
    assert np.abs(runs[0].x - runs[1].x).max() < 1e-9 * np.abs(runs[1].x).max()


def test_the_speed_without_load_is_where_the_motor_begins_to_brake():
    assert MOTOR.top_speed == 90.0
    assert Drive(1.0, (0.0, 10.0, 20.0), (2.0, 1.0, -3.0)).top_speed == 12.5
