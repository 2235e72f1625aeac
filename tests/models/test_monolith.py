"""The coupled equations against the papers as printed, invariants, and the units' exact pieces."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad
from scipy.linalg import block_diag

from autobalancer.models.assembly import Assembly, Mounted, SpeedProfile
from autobalancer.models.liquid import Liquid
from autobalancer.models.monolith import ReferenceDisagreement, reference, simulate
from autobalancer.models.reference.coupled import Monolith, Start
from autobalancer.models.reference.trajectory import differences
from autobalancer.models.rotor import LinearRotor
from autobalancer.models.steps.propagator import step_matrix
from autobalancer.models.weights import KAPPA, Weights

pytestmark = pytest.mark.slow

SPEED = SpeedProfile.constant(3.0)
RUN_UP = SpeedProfile.run_up(0.5, 3.0, 4.0)
DIP = SpeedProfile((0.0, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0), (0.0, 3.0, 3.0, 0.0, 0.0, 2.0, 0.0))


def two_balls(drag: float = 0.0125) -> Assembly:
    """The two-ball reference scene."""
    rotor = LinearRotor.planar(0.95, [1.0, 49.0], [0.5, 1.0], 0.0, 0.025)
    return Assembly(rotor, (Mounted("weights", Weights(2, 0.025, 1.0, drag), 0, (0.3, 1.0)),))


def mixed(*, planes: int = 1) -> Assembly:
    """Liquid, balls and pendulums on one disc."""
    rotor = LinearRotor.planar(2.0, [3.0, 5.0], [0.1, 0.2], 0.3, 0.05, 0.4)
    if planes > 1:
        rotor = replace(rotor, planes=np.ones((planes, 1)))
    return Assembly(
        rotor,
        (
            Mounted("balls", Weights(2, 0.1, 0.5, 0.02, 1.4), 0, (0.3, 1.0), (0.1, -2.0)),
            Mounted("liquid", Liquid(0.05, 0.04, 0.1, 1000.0), planes - 1),
            Mounted("pendulums", Weights(3, 0.05, 0.3, 0.0), planes - 1, (0.0, 2.0, 4.0)),
        ),
    )


def two_stations() -> Assembly:
    """Two coupled stations, planes off them, everything a rotor can have."""
    rotor = LinearRotor.from_matrices(
        mass=np.array([[1.2, 0.2], [0.2, 0.9]]),
        damping=block_diag([[0.5, 0.1], [0.1, 0.3]], [[0.4, 0.0], [0.0, 0.6]]),
        stiffness=block_diag([[9.0, -2.0], [-2.0, 7.0]], [[12.0, -2.0], [-2.0, 9.0]]),
        internal_damping=np.array([[0.2, -0.1], [-0.1, 0.4]]),
        gyroscopic=np.array([[0.3, -0.1], [-0.1, 0.2]]),
        planes=np.array([[1.2, -0.2], [0.4, 0.6]]),
        unbalance=np.array([0.02 + 0.01j, -0.03j]),
        deflection=np.eye(2),
    )
    balls = Weights(2, 0.1, 0.5, 0.02, 1.4)
    return Assembly(
        rotor,
        (
            Mounted("left", balls, 0, (0.3, 1.0)),
            Mounted("liquid", Liquid(0.05, 0.04, 0.1, 1000.0), 0),
            Mounted("right", Weights(1, 0.2, 0.4, 0.05, 1.5), 1, (2.0,), (1.0,)),
        ),
    )


def some_state(system: Monolith) -> np.ndarray:
    return np.random.default_rng(7).normal(size=system.size)


@pytest.mark.parametrize("profile", [SPEED, RUN_UP])
@pytest.mark.parametrize("assembly", [two_balls(), mixed(), mixed(planes=2), Assembly(
    LinearRotor.planar(1.0, 2.0, 0.1, 0.2, 0.3))])  # fmt: skip
def test_plain_numbers_and_arrays_are_the_same_equations(
    assembly: Assembly, profile: SpeedProfile
) -> None:
    system = Monolith(assembly, profile, 0.7)
    y = some_state(system)
    assert isinstance(system.rhs(0.9, y), list)
    assert_allclose(system.rhs(0.9, y), system.array_rhs(0.9, y), rtol=1e-12, atol=1e-13)


def test_the_derivatives_satisfy_filimonikhina_4_as_printed() -> None:
    m_total, m, r, kappa, b, m0_r = 1.0, 0.025, 1.0, 1.4, 0.0125, 0.025
    rotor = LinearRotor.planar(m_total - 2 * m, [1.0, 49.0], [0.5, 1.0], 0.0, m0_r)
    weights = Weights(2, m, r, b, kappa)
    system = Monolith(Assembly(rotor, (Mounted("w", weights, 0, (0.0, 0.0)),)), SPEED)
    y, t, w = some_state(system), 0.37, 3.0
    x, yy, v_x, v_y, *rest = y
    phi, phi1 = np.array(rest[:2]), np.array(rest[2:])
    _, _, a_x, a_y, _, _, *phi2 = system.rhs(t, y)
    s, c, phi2 = np.sin(phi), np.cos(phi), np.array(phi2)
    row_x = m_total * a_x + 0.5 * v_x + 1.0 * x - m * r * (phi2 * s + phi1**2 * c).sum()
    row_y = m_total * a_y + 1.0 * v_y + 49.0 * yy + m * r * (phi2 * c - phi1**2 * s).sum()
    assert_allclose(row_x, m0_r * w**2 * np.cos(w * t), atol=1e-12)
    assert_allclose(row_y, m0_r * w**2 * np.sin(w * t), atol=1e-12)
    rows = kappa * m * r**2 * phi2 + b * r**2 * (phi1 - w) + m * r * (-a_x * s + a_y * c)
    assert_allclose(rows, 0.0, atol=1e-13)


def test_many_stations_satisfy_newton_plane_by_plane() -> None:
    assembly = two_stations()
    rotor, system = assembly.rotor, Monolith(assembly, RUN_UP, 0.4)
    y, t = some_state(system), 1.3
    w, w1, beta = RUN_UP.speed(t), RUN_UP.acceleration(t), 0.4 + RUN_UP.angle(t)
    q, v = y[:2] + 1j * y[2:4], y[4:6] + 1j * y[6:8]
    phi, phi1 = y[8:].reshape(2, 3)
    derivative = np.asarray(system.rhs(t, y))
    a, phi2 = derivative[4:6] + 1j * derivative[6:8], derivative[11:]
    force, first = np.zeros(2, complex), 0
    for mounted in assembly.balancers:
        at, device = rotor.planes[mounted.plane] @ a, mounted.device
        if isinstance(device, Liquid):
            force[mounted.plane] -= device.chamber_radius**2 * np.pi * 0.1 * 1000.0 * at
            continue
        for k in range(first, first + device.count):
            inertia = device.mass * (
                at + device.track_radius * (1j * phi2[k] - phi1[k] ** 2) * np.exp(1j * phi[k])
            )
            force[mounted.plane] -= inertia
            # moment of all forces on the weight about the track's centre; rolling in the rotor
            # adds kappa - 1
            along = (inertia * np.exp(-1j * phi[k])).imag * device.track_radius
            rolling = (device.kappa - 1.0) * device.mass * device.track_radius**2 * (phi2[k] - w1)
            drag = device.drag * device.track_radius**2 * (phi1[k] - w)
            assert_allclose(along + rolling + drag, 0.0, atol=1e-12)
        first += device.count
    elastic = rotor.stiffness_x @ q.real + 1j * rotor.stiffness_y @ q.imag
    viscous = rotor.damping_x @ v.real + 1j * rotor.damping_y @ v.imag
    inner = rotor.internal_damping @ (v - 1j * w * q) - 1j * w * rotor.gyroscopic @ v
    pull = rotor.unbalance * (w**2 - 1j * w1) * np.exp(1j * beta)
    left = rotor.mass @ a + viscous + inner + elastic
    assert_allclose(left, pull + rotor.planes.T @ force, atol=1e-12)


@pytest.mark.parametrize("stiffness", [(2.0, 7.0), (2.0, 2.0)])
@pytest.mark.parametrize("kappa", KAPPA.values())
def test_without_friction_and_rotation_energy_stays_and_on_alike_supports_momentum(
    kappa: float, stiffness: tuple[float, float]
) -> None:
    rotor, weights = LinearRotor.planar(1.0, stiffness), Weights(2, 0.3, 0.5, 0.0, kappa)
    assembly = Assembly(rotor, (Mounted("w", weights, 0, (0.3, 1.0), (2.0, -3.0)),))
    run = simulate(
        assembly, SpeedProfile.constant(0.0), np.linspace(0, 30, 61),
        initial=Start(0.2, -0.1, 0.5, 0.3), rtol=1e-11,
    )  # fmt: skip
    q, v = run.x[:, 0] + 1j * run.y[:, 0], run.vx[:, 0] + 1j * run.vy[:, 0]
    arm, rate = 0.5 * np.exp(1j * run.theta["w"]), run.angle_rate["w"]
    moving = v[:, None] + 1j * rate * arm
    energy = 0.5 * np.abs(v) ** 2 + 0.5 * (stiffness[0] * q.real**2 + stiffness[1] * q.imag**2)
    energy += 0.15 * (np.abs(moving) ** 2 + (kappa - 1.0) * 0.25 * rate**2).sum(axis=1)
    assert_allclose(energy, energy[0], rtol=1e-9)
    assert np.ptp(np.abs(v)) > 0.1
    momentum = (np.conj(q) * v).imag
    momentum += 0.3 * (np.conj(q[:, None] + arm) * moving).imag.sum(axis=1)
    momentum += 0.3 * (kappa - 1.0) * 0.25 * rate.sum(axis=1)
    stays = np.ptp(momentum) < 1e-9 * np.abs(momentum).max()
    assert stays == (stiffness[0] == stiffness[1])


@pytest.mark.parametrize("isotropic", [True, False])
def test_a_rotor_with_liquid_moves_as_the_exact_step(isotropic: bool) -> None:
    liquid = Liquid(0.05, 0.04, 0.1, 1000.0)
    rotor = LinearRotor.planar(2.0, 30.0 if isotropic else [30.0, 80.0], 0.5, 0.3, 0.05)
    assembly = Assembly(rotor, (Mounted("liquid", liquid),))
    run = simulate(assembly, SPEED, [4.0], initial=Start(0.01, 0.02, 0.0, 0.1, 0.6), rtol=1e-12)
    turn = np.exp(0.6j)
    if isotropic:
        start = np.array([0.01 + 0.02j, 0.1j, 0, 0, 0, 0, turn])
        expected = (step_matrix(assembly.loaded_rotor, 3.0, 4.0) @ start)[0]
    else:
        start = np.array([0.01, 0.02, 0, 0.1, *np.zeros(8), turn.real, turn.imag])
        expected = complex(*(step_matrix(assembly.loaded_rotor, 3.0, 4.0) @ start)[:2])
    assert_allclose(run.x[0, 0] + 1j * run.y[0, 0], expected, rtol=1e-9)
    assert_allclose(run["liquid.clearance"], 0.01 - abs(expected), rtol=1e-9)


def test_the_reference_scene_states_its_own_error() -> None:
    time = np.linspace(0.0, 20 * 2 * np.pi / 3, 401)
    run, error = reference(two_balls(), SPEED, time)
    assert 0.0 < error < 1e-9
    third = simulate(two_balls(), SPEED, time, method="Radau", rtol=1e-9)
    assert max(differences(run, third).values()) < 1e-7


def test_a_reference_whose_methods_disagree_is_refused() -> None:
    with pytest.raises(ReferenceDisagreement, match="differ by"):
        reference(two_balls(), SPEED, np.linspace(0, 40, 41), rtol=1e-3, bound=1e-6)


def test_stiff_drag_takes_stiff_methods_and_holds_the_weights_in_place() -> None:
    assembly, time = two_balls(1e5 * 0.025 * 3.0), np.linspace(0, 6, 31)
    run, error = reference(assembly, SPEED, time, signals=["rotor.x", "rotor.y"])
    assert error < 1e-9
    # the angles agree as well in radians, but hardly move: their range is no longer 1e-7 fine
    other = simulate(assembly, SPEED, time, method="LSODA", rtol=1e-12)
    assert np.ptp(run.theta["weights"], axis=0).max() < 1e-5
    assert_allclose(other.theta["weights"], run.theta["weights"], rtol=0, atol=1e-11)
    # as good as fixed to the rotor: one unbalance, one linear rotor
    pull = 0.025 * (1.0 + np.exp(0.3j) + np.exp(1.0j))
    rotor = LinearRotor.planar(1.0, [1.0, 49.0], [0.5, 1.0], 0.0, abs(pull), float(np.angle(pull)))
    fixed = simulate(Assembly(rotor), SPEED, run.time, rtol=1e-12)
    assert_allclose(run.x, fixed.x, rtol=0, atol=1e-5 * np.ptp(fixed.x))


def test_a_run_up_is_not_stepped_across_its_end() -> None:
    time = np.linspace(0.0, 9.0, 91)
    run, error = reference(two_balls(), RUN_UP, time, initial=Start(angle=0.3))
    assert error < 1e-9
    restarted = simulate(two_balls(), RUN_UP, [4.0], initial=Start(angle=0.3), rtol=1e-12)
    later = Assembly(
        two_balls().rotor,
        (replace(two_balls().balancers[0], angles=tuple(restarted.theta["weights"][0]),
                 speeds=tuple(restarted.angle_rate["weights"][0])),),
    )  # fmt: skip
    state = (float(part[0, 0]) for part in (restarted.x, restarted.y, restarted.vx, restarted.vy))
    start = Start(*state, angle=float(restarted.angle[0]))
    end = simulate(later, SPEED, [5.0], initial=start, rtol=1e-12)
    assert_allclose(end.x[0], run.x[-1], rtol=1e-8)
    assert_allclose(end.theta["weights"][0], run.theta["weights"][-1], rtol=1e-8)


@pytest.mark.parametrize("profile", [SPEED, RUN_UP, SpeedProfile.run_up(4.0, 1.0, 2.0), DIP])
def test_speed_and_angle_of_a_profile_are_the_integrals_of_its_acceleration(
    profile: SpeedProfile,
) -> None:
    for t in (0.0, 0.5, 1.9999, 2.0, 4.0, 7.5):
        kink = [time for time in profile.times if 0.0 < time < t] or None
        turned = quad(profile.speed, 0.0, t, points=kink)[0]
        gained = quad(profile.acceleration, 0.0, t, points=kink)[0]
        assert_allclose(profile.angle(t), turned, atol=1e-12)
        assert_allclose(profile.speed(t), profile.start + gained, atol=1e-12)
        if profile.speed(t) and t:
            assert_allclose(profile.time_of(profile.angle(t)), t, rtol=1e-12)
    assert profile.speed(1e9) == profile.speeds[-1]
    assert profile.acceleration(1e9) == 0.0
    assert profile.acceleration(profile.seconds) == 0.0


def test_signals_are_found_by_the_units_names() -> None:
    run = simulate(two_stations(), SPEED, np.linspace(0, 2, 21), initial=Start((0.1, 0.0), 0.2))
    assert_allclose(run["rotor.station[2].x"], run.x[:, 1])
    assert_allclose(run["rotor.plane[2].y"], run.y @ [0.4, 0.6])
    assert_allclose(run["rotor.angle"], 3.0 * run.time)
    assert_allclose(run["rotor.bending"], np.hypot(run.x, run.y).max(axis=1))
    assert_allclose(run["left.weight[2].angle"], run.theta["left"][:, 1])
    moment = 0.05 * np.exp(1j * run.theta["left"]).sum(axis=1)
    assert_allclose(run["left.moment_xi"] + 1j * run["left.moment_eta"], moment)
    assert_allclose(run["right.spread"], 1.0)
    names = run.names()
    assert len(names) == len(set(names)) == 8 + 6
    assert all(len(run[name]) == 21 for name in names)
    for wrong in ("rotor.x", "rotor.station[3].x", "left.weight[0].angle", "nobody.x", "rotor"):
        with pytest.raises(KeyError, match=r"no such signal; there are rotor\.station"):
            run.signal(wrong)


def test_the_acceleration_signal_is_the_derivative_of_the_velocity() -> None:
    run = simulate(two_balls(), SPEED, np.linspace(0, 1, 2001), rtol=1e-12)
    a = (run["rotor.plane[1].a_xi"] + 1j * run["rotor.plane[1].a_eta"]) * np.exp(3j * run.time)
    v = run.vx[:, 0] + 1j * run.vy[:, 0]
    h = run.time[1]
    central = (v[:-4] - 8 * v[1:-3] + 8 * v[3:-1] - v[4:]) / (12 * h)
    assert_allclose(a[2:-2], central, atol=1e-8)


def test_differences_measure_by_the_range_of_each_signal() -> None:
    run = simulate(two_balls(), SPEED, np.linspace(0, 5, 51))
    shifted = replace(run, x=run.x + 0.01 * np.ptp(run.x))
    found = differences(run, shifted)
    assert found["rotor.x"] == pytest.approx(0.01)
    assert all(gap == 0.0 for name, gap in found.items() if name != "rotor.x")


def test_times_given_are_times_returned() -> None:
    every = simulate(two_balls(), RUN_UP, [0.0, 1.0, 4.0, 5.0], rtol=1e-11)
    assert every.x[0, 0] == 0.0
    assert_allclose(every.theta["weights"][0], [0.3, 1.0])
    for k, t in enumerate((1.0, 4.0, 5.0), 1):
        alone = simulate(two_balls(), RUN_UP, [t], rtol=1e-11)
        assert_allclose(every.x[k], alone.x[0], rtol=1e-7)
    assert [b > a for a, b in pairwise(every.angle)] == [True] * 3
