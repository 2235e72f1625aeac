"""A shaft of rubber that turns: runs, growth and modes against equations written anew.

Three discs on a shaft whose middle one bends it by d; the rubber has one state u, in fixed axes
tau (u' - i w u) = d - u, and pulls by k0 d + k1 (d - u).
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import autobalancer as ab
from autobalancer.harness import cosimulate
from autobalancer.harness.stability.boundaries import is_provable
from autobalancer.models.rubber import zener

MASSES, SPRINGS, DAMPERS = (
    np.array(each) for each in ([1.0, 8.0, 1.5], [2e5, 0, 3e5], [60.0, 0, 90])
)
BENT = np.array([-0.625, 1.0, -0.375])  # of displacements at 0, 0.3 and 0.8 m
RUBBER = zener(3.0 * 2000.0 * 0.8 / (0.3 * 0.5) ** 2, 0.25, 60.0)
SPEED, UNBALANCE = 180.0, 2e-3
SHAFT = {
    "kind": "flexible", "stations": [0.0, 0.3, 0.8], "masses": [1.0, 8.0, 1.5], "supports": [1, 3],
    "support_stiffness": [2e5, 3e5], "support_damping": [60.0, 90.0], "bending_stiffness": 2000.0,
    "shaft_loss_factor": 0.25, "shaft_loss_frequency": 60.0,
    "unbalances": [{"position": 0.3, "amount": UNBALANCE}],
}  # fmt: skip


def machine(**more):
    return ab.Scene(rotor=SHAFT, **({"operation": {"speed": SPEED}} | more))


def free_motion(speed: float) -> np.ndarray:
    """A of (q, q', u)' = A (q, q', u) in z = x + i y."""
    a = np.zeros((7, 7), complex)
    a[:3, 3:6] = np.eye(3)
    pulled = np.diag(SPRINGS) + np.outer(BENT, BENT) * (RUBBER.static + RUBBER.branch)
    a[3:6, :3] = -pulled / MASSES[:, None]
    a[3:6, 3:6] = -np.diag(DAMPERS / MASSES)
    a[3:6, 6] = BENT * RUBBER.branch / MASSES
    a[6, :3], a[6, 6] = BENT / RUBBER.time, 1j * speed - 1.0 / RUBBER.time
    return a


def growth(speed: float) -> float:
    return float(np.linalg.eigvals(free_motion(speed)).real.max())


@pytest.mark.parametrize("separate", [False, True])
def test_runs_are_those_of_one_state_integrated_apart(separate):
    found = cosimulate(
        machine(run={"duration": 0.4, "initial": {"x": 1e-4, "vy": 0.02}}), separate=separate
    )
    matrix = free_motion(SPEED)

    def rates(t: float, parts: np.ndarray) -> np.ndarray:
        slope = matrix @ (parts[:7] + 1j * parts[7:])
        slope[4] += UNBALANCE * SPEED**2 * np.exp(1j * SPEED * t) / MASSES[1]
        return np.concatenate([slope.real, slope.imag])

    start = np.array([1e-4, 1e-4, 1e-4, 0.02j, 0.02j, 0.02j, 0.0])  # a straight shaft, relaxed
    right = solve_ivp(
        rates, [0.0, found.time[-1]], np.concatenate([start.real, start.imag]), t_eval=found.time,
        method="DOP853", rtol=1e-11, atol=1e-15,
    ).y  # fmt: skip
    for k in range(3):
        assert found[f"rotor.station[{k + 1}].x"] == pytest.approx(right[k], abs=1e-11)
        assert found[f"rotor.station[{k + 1}].y"] == pytest.approx(right[7 + k], abs=1e-11)


def test_modes_are_those_of_the_one_state():
    rows = machine().rotor().table().rows
    values = np.linalg.eigvals(free_motion(SPEED))
    assert sorted(row[1] for row in rows) == pytest.approx(sorted(np.abs(values)), rel=1e-9)
    assert min(row[3] for row in rows) == pytest.approx(-growth(SPEED) / 130.81445, rel=1e-5)


def test_the_speed_from_which_rubber_drives_whirl_is_found_and_proved():
    limit = brentq(growth, 100.0, 160.0)
    method = "floquet,proved" if is_provable() else "floquet"
    found = machine().speeds(100.0, 160.0, method, narrowest=0.05)
    assert [each.speed for each in found.methods["floquet"]] == pytest.approx([limit], rel=1e-7)
    if found.proof:
        states = {band.state for band in found.proof.bands if band.low > limit or band.high < limit}
        assert states == {"stable", "unstable"}
        assert found.proof.undecided < 0.02


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            {"operation.run_up": {"from": 0, "to": 9, "seconds": 2}, "operation.speed": None},
            "constant speed alone",
        ),
        ({"operation.gravity": 9.81}, "does not support rubber"),
        ({"rotor.internal_damping": 5.0}, "either internal_damping or a loss factor"),
        ({"rotor.shaft_loss_frequency": None}, "requires shaft_loss_frequency"),
        ({"rotor.shaft_loss_factor": None}, "belongs to shaft_loss_factor"),
    ],
)
def test_what_a_shaft_of_rubber_does_not_know_is_refused_by_name(changes, words):
    with pytest.raises(ab.SceneError, match=words):
        machine().replace(changes)
