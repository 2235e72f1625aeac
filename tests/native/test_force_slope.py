"""der(F) of the ball balancer is the time derivative of F, whatever drives the weights."""

from __future__ import annotations

import pytest

DRIVE = {
    "speed": 40.0, "acceleration": 25.0, "der(acceleration)": 900.0,
    "a_xi": 12.0, "a_eta": -7.0, "der(a_xi)": 300.0, "der(a_eta)": 150.0,
}  # fmt: skip
WEIGHTS = {
    "mass": 0.2, "track_radius": 0.1, "drag": 0.4, "weight[1].angle0": 0.3, "weight[2].angle0": 2.1,
    "weight[1].speed0": 4.0, "weight[2].speed0": -3.0,
}  # fmt: skip
TIME, APART = 4e-3, 2e-5


@pytest.mark.parametrize("offset", [0.0, 0.03])
@pytest.mark.parametrize("as_force", [False, True])
def test_the_slope_of_the_force_is_its_derivative(packaging, fmus, offset, as_force):
    """With a track off centre the rotor's w'' moves the track's centre, and N m e with it."""
    host = packaging.Host(fmus.native("BallBalancer", weights=2, frame="rotor"))
    start = WEIGHTS | {
        "track_offset_xi": offset, "track_offset_eta": -2.0 * offset, "inertia_as_force": as_force
    }  # fmt: skip
    forces = ["F_xi", "F_eta"]
    found = []
    for length in (TIME - APART, TIME, TIME + APART):
        host.begin(start | DRIVE)
        host.step(length)
        found.append(host.get(*forces, *(f"der({name})" for name in forces)))
        host.slave.reset()
    before, now, after = found
    size = max(map(abs, now[2:]))
    for k in (0, 1):
        expected = (after[k] - before[k]) / (2.0 * APART)
        assert now[2 + k] == pytest.approx(expected, abs=2e-5 * size)
