"""The main motion on races with lobes: against integrated runs, and equations differenced anew."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import autobalancer as ab
from autobalancer.models.assembly import Assembly, Mounted, SpeedProfile
from autobalancer.models.linear.balanced import balanced_angles
from autobalancer.models.linear.off_centre import centred
from autobalancer.models.linear.on_race import NoRest, main_motion, rounded
from autobalancer.models.lobes import Lobes, Race
from autobalancer.models.monolith import simulate
from autobalancer.models.rotor import LinearRotor
from autobalancer.models.stability import find_growth
from autobalancer.models.weights import Weights

SPEED = 100.0


def machine(*lobes: Lobes, count: int = 2, kappa: float = 1.0, offset: complex = 0j) -> Assembly:
    rotor = LinearRotor.planar(10.0, 1e4, 60.0, unbalance=0.02)
    weights = Weights(count, 0.15, 0.1, 0.6, kappa, race=lobes)
    angles = tuple(math.tau * k / count + 0.1 for k in range(count))
    return Assembly(rotor, (Mounted("balls", weights, 0, angles, (0.0,) * count, offset),))


@pytest.mark.parametrize(
    ("order", "angle", "millimetres"),
    [(2, 0.0, 0.70193631), (2, math.pi / 4.0, 0.10693227), (1, 0.7, 0.19995759),
     (3, 0.0, 0.23936903)],
)  # fmt: skip
def test_two_balls_leave_what_sixty_integrated_seconds_of_another_program_end_with(
    order, angle, millimetres
):
    found, angles = main_motion(machine(Lobes(order, 2e-4, angle)), SPEED)
    assert 1e3 * abs(found.whirl(angles)[0]) == pytest.approx(millimetres, abs=1e-8)


@pytest.mark.parametrize("kappa", [1.0, 1.4])
@pytest.mark.parametrize("count", [2, 3, 5])
def test_growth_is_that_of_the_equations_in_the_turning_frame_differenced(count, kappa):
    lobes = (Lobes(2, 1e-4, 0.3), Lobes(5, 2e-5, 1.0))
    assembly = machine(*lobes, count=count, kappa=kappa)
    found, angles = main_motion(assembly, SPEED)
    zeta = complex(found.whirl(angles)[0])
    race, size = Race(assembly, SPEED, lobes), len(angles)
    rest = np.concatenate([[zeta.real, zeta.imag, 0.0, 0.0], angles, np.zeros(size)])
    moves = np.diag([1e-7] * 4 + [1e-6] * (2 * size))
    columns = [(race.rates(rest + m) - race.rates(rest - m)) / (2.0 * m.max()) for m in moves]
    expected = np.linalg.eigvals(np.array(columns).T).real.max()
    assert find_growth(assembly, SPEED).rate == pytest.approx(expected, rel=1e-6)


def test_an_offset_beside_lobes_is_rested_upon_as_a_long_run_does():
    assembly = machine(Lobes(2, 5e-5, 0.3), kappa=1.4, offset=2e-4 - 1e-4j)
    found, angles = main_motion(assembly, SPEED)
    start = replace(assembly.balancers[0], angles=tuple(np.add(angles, [0.05, -0.05])))
    run = simulate(
        replace(assembly, balancers=(start,)), SpeedProfile.constant(SPEED), [0.0, 12.0], rtol=1e-10
    )
    np.testing.assert_allclose(run.theta["balls"][-1], angles, atol=1e-6)
    assert abs(run.x[-1, 0] + 1j * run.y[-1, 0]) == pytest.approx(
        abs(found.whirl(angles)[0]), rel=1e-5
    )


def test_lobes_fix_the_turns_that_a_round_race_leaves_open():
    assembly = machine(Lobes(2, 2e-5, 0.3), count=3)
    values = np.linalg.eigvals(
        (pair := main_motion(assembly, SPEED))[0].linearised(pair[1]).at_speed(SPEED)
    )
    assert len(values) == 4 + 2 * 3
    assert values.real.max() < -1e-2
    assert find_growth(rounded(assembly), SPEED).rate < 0.0


def test_supports_of_unlike_stiffness_are_refused_by_name():
    rotor = LinearRotor.planar(10.0, (1e4, 2e4), 60.0, unbalance=0.02)
    assembly = replace(machine(Lobes(2, 2e-5)), rotor=rotor)
    with pytest.raises(NoRest, match="alike along x and y"):
        main_motion(assembly, SPEED)


def test_balls_end_where_a_slow_flow_along_the_balanced_positions_leads_them():
    """Turns that no moment feels follow the race; the others follow Newton's method."""
    assembly = ab.load("oval_fan").assembly()
    machine, found = main_motion(assembly.at_speed(100.0), 100.0)
    masses = np.repeat([m.device.each[0].mass for m in assembly.weights], 3)
    planes = np.repeat([m.plane for m in assembly.weights], 3)

    def flow(_t, theta):
        moments = np.array([
            masses * (planes == plane) * part(machine.places(theta).along)
            for plane in (0, 1) for part in (np.real, np.imag)
        ])  # fmt: skip
        _, _, rows = np.linalg.svd(moments)
        seen, unseen = rows[:4], rows[4:]
        left = machine.missing(theta) / 0.06**2
        ahead = [machine.missing(theta + 1e-6 * turn) - machine.missing(theta) for turn in seen]
        slopes = seen @ np.array(ahead).T / 1e-6 / 0.06**2
        return unseen.T @ (unseen @ left) - seen.T @ np.linalg.solve(slopes, seen @ left)

    begin = balanced_angles(centred(rounded(assembly), 100.0))
    ended = solve_ivp(flow, (0.0, 4e5), begin, "LSODA", rtol=1e-6, atol=1e-9).y[:, -1]
    np.testing.assert_allclose(np.exp(1j * found), np.exp(1j * ended), atol=1e-4)
