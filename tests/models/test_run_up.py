"""The closed form of a run-up: its table of peaks, and runs against it."""

from __future__ import annotations

import math

import numpy as np
import pytest

import autobalancer as ab
from autobalancer.models.run_up import run_up_motion, run_up_peak

RATIOS = (0.0, 0.01, 0.02, 0.05, 0.1)
ROWS = {  # by Q = w0/sqrt(al): M |z|/U at the peak and speed/w0 for each damping ratio
    5: ((8.137887, 1.430819), (7.511190, 1.423337), (6.958337, 1.415769), (5.646273, 1.393503),
        (4.209356, 1.364382)),
    10: ((15.440793, 1.215106), (13.114789, 1.204445), (11.308410, 1.194953),
         (7.781526, 1.172810), (4.887345, 1.149457)),
    20: ((30.107963, 1.107978), (21.891479, 1.096071), (16.820632, 1.087247),
         (9.367768, 1.069619), (5.085037, 1.055979)),
    50: ((74.115429, 1.043158), (36.614233, 1.032644), (22.870812, 1.026452),
         (10.023990, 1.017625), (5.050818, 1.017930)),
    100: ((147.473030, 1.021575), (45.398627, 1.012977), (24.683666, 1.009200),
          (10.034483, 1.006485), (5.032275, 1.012063)),
}  # fmt: skip
PEAKS = {
    (q, ratio): peak for q, row in ROWS.items() for ratio, peak in zip(RATIOS, row, strict=True)
}


@pytest.mark.parametrize(("case", "expected"), PEAKS.items(), ids=map(str, PEAKS))
def test_the_peak_of_a_run_up_is_that_of_its_closed_form(case, expected):
    q, ratio = case
    peak, speed = run_up_peak(1.0, 1.0, 2.0 * ratio, 1.0, 1.0 / q**2)
    assert peak == pytest.approx(expected[0], rel=1e-6)
    assert speed == pytest.approx(expected[1], rel=1e-4)


def test_a_run_follows_the_closed_form_through_its_peak():
    mass, stiffness, damping, unbalance, end, seconds = 8.0, 2e4, 16.0, 2e-3, 120.0, 4.0
    scene = ab.Scene(
        rotor=ab.Planar(mass=mass, stiffness=stiffness, damping=damping, unbalance=unbalance),
        operation={"run_up": {"from": 0.0, "to": end, "seconds": seconds}},
        run={"duration": seconds},
    )
    run = scene.run()
    rate = end / seconds
    z = run_up_motion(mass, stiffness, damping, unbalance, rate, run.time)
    size = np.abs(z).max()
    assert run["rotor.x"] == pytest.approx(z.real, abs=1e-4 * size)
    assert run["rotor.y"] == pytest.approx(z.imag, abs=1e-4 * size)
    peak, speed = run_up_peak(mass, stiffness, damping, unbalance, rate)
    moved = np.hypot(run["rotor.x"], run["rotor.y"])
    assert moved.max() == pytest.approx(peak, rel=1e-3)
    assert rate * run.time[moved.argmax()] == pytest.approx(speed, rel=1e-2)
    assert speed > math.sqrt(stiffness / mass)


def test_what_has_no_such_form_is_refused():
    with pytest.raises(ValueError, match="less than critical damping"):
        run_up_peak(1.0, 1.0, 2.0, 1.0, 0.1)
    with pytest.raises(ValueError, match="a speed that rises"):
        run_up_motion(1.0, 1.0, 0.1, 1.0, 0.0, [1.0])
