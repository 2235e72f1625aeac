"""The reference on races that are not round: energy, and the equations of the turning frame."""

from __future__ import annotations

import numpy as np
import pytest

from autobalancer.models.assembly import Assembly, Mounted, SpeedProfile
from autobalancer.models.lobes import Race
from autobalancer.models.monolith import simulate
from autobalancer.models.motor import Drive, MotorDriven
from autobalancer.models.race import path
from autobalancer.models.rotor import LinearRotor
from autobalancer.models.weights import Lobes, Weights

LOBES = (Lobes(2, 4e-3, 0.4), Lobes(5, 5e-4, 1.0))
RADIUS, KAPPA, SIZE = 0.1, 1.4, 0.01


def mounted(drag: float, kappa: float, size: float, offset: complex = 0j) -> Mounted:
    weights = Weights(2, 0.15, RADIUS, drag, kappa, size, race=LOBES)
    return Mounted("balls", weights, 0, (2.2, 4.1), (3.0, -8.0), offset)


def test_derivatives_of_the_path_are_differences_of_it():
    angles, step = np.linspace(0.0, 6.0, 7), 1e-5
    found = path(RADIUS, LOBES, angles)
    ahead, behind = path(RADIUS, LOBES, angles + step), path(RADIUS, LOBES, angles - step)
    for k in range(3):
        slope = (ahead[k] - behind[k]) / (2.0 * step)
        np.testing.assert_allclose(found[k + 1], slope, rtol=1e-7, atol=1e-9)


def test_the_reference_moves_as_the_equations_of_the_turning_frame_say():
    rotor = LinearRotor.planar(10.0, 1e4, 60.0, unbalance=0.02)
    assembly = Assembly(rotor, (mounted(0.6, KAPPA, 0.0),))
    run = simulate(assembly, SpeedProfile.constant(100.0), np.linspace(0.0, 0.5, 40), rtol=1e-11)
    race = Race(assembly, 100.0, LOBES)
    turn, w = np.exp(-1j * run.angle), 100.0
    zeta = (run.x + 1j * run.y)[:, 0] * turn
    rate = (run.vx + 1j * run.vy)[:, 0] * turn - 1j * w * zeta
    second = (run.ax + 1j * run.ay)[:, 0] * turn - 2j * w * rate + w * w * zeta
    for k in range(len(run.time)):
        state = np.concatenate([[zeta[k].real, zeta[k].imag, rate[k].real, rate[k].imag],
                                run.theta["balls"][k], run.angle_rate["balls"][k]])  # fmt: skip
        found = race.rates(state)
        assert complex(*found[2:4]) == pytest.approx(second[k], abs=1e-9 * abs(second).max())
        np.testing.assert_allclose(found[6:], run.angle_acceleration["balls"][k], rtol=1e-8)


@pytest.mark.parametrize(("kappa", "size"), [(1.0, 0.0), (KAPPA, 0.0), (KAPPA, SIZE)])
def test_energy_is_kept_on_a_free_shaft_without_damping(kappa, size):
    """Of rotor, shaft, weights and what they roll by, from positions and velocities alone."""
    offset, inertia, unbalance = 3e-3 - 2e-3j, 0.05, 0.02
    rotor = LinearRotor.planar(10.0, 1e4, unbalance=unbalance)
    assembly = Assembly(rotor, (mounted(0.0, kappa, size, offset),))
    nothing = MotorDriven(Drive(inertia, (0.0, 1e6), (0.0, 0.0)), 60.0)
    run = simulate(assembly, nothing, np.linspace(0.0, 1.0, 60), rtol=1e-12)
    turn, w = np.exp(1j * run.angle), run.speed
    z, v = (run.x + 1j * run.y)[:, 0], (run.vx + 1j * run.vy)[:, 0]
    energy = 0.5 * 1e4 * np.abs(z) ** 2 + 0.5 * 10.0 * np.abs(v) ** 2 + 0.5 * inertia * w**2
    energy += unbalance * w * (v.conj() * 1j * turn).real
    for theta, rate in zip(run.theta["balls"].T, run.angle_rate["balls"].T, strict=True):
        rho, slope, *_ = path(RADIUS, LOBES, theta)
        local, by = np.exp(1j * theta), slope + 1j * rho
        velocity = v + (1j * w * (offset + rho * local) + by * local * rate) * turn
        energy += 0.5 * 0.15 * np.abs(velocity) ** 2
        energy += 0.5 * (kappa - 1.0) * 0.15 * (np.abs(by) * rate - size * w) ** 2
    assert np.ptp(w) > 1.0  # the shaft gives and takes
    np.testing.assert_allclose(energy, energy[0], rtol=1e-9)
