"""A machine on rubber that begins with a velocity."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import autobalancer as ab
from autobalancer.harness import cosimulate
from autobalancer.models.rubber import zener


@pytest.mark.parametrize("separate", [False, True])
def test_rubber_begins_relaxed_where_the_disc_begins_with_a_velocity(separate):
    """The inner displacement u obeys tau u' = d - u from the start on: it does not begin moving."""
    disc = {"kind": "planar", "mass": 10.0, "stiffness": 2.5e4, "support_loss_factor": 0.3,
            "loss_frequency": 50.0}  # fmt: skip
    run = {"duration": 0.5, "initial": {"vx": 0.1, "y": 1e-3}}
    found = cosimulate(ab.Scene(rotor=disc, speed=40.0, run=run), separate=separate)
    rubber = zener(2.5e4, 0.3, 50.0)

    def rates(_t: float, state: np.ndarray) -> list[float]:
        d, rate, u = state
        force = rubber.static * d + rubber.branch * (d - u)
        return [rate, -force / 10.0, (d - u) / rubber.time]

    for axis, start in (("x", [0.0, 0.1, 0.0]), ("y", [1e-3, 0.0, 1e-3])):
        right = solve_ivp(
            rates, [0.0, found.time[-1]], start, t_eval=found.time, method="DOP853", rtol=1e-11,
            atol=1e-15,
        ).y[0]  # fmt: skip
        assert found[f"rotor.station[1].{axis}"] == pytest.approx(right, abs=1e-9)
