"""The three FMUs in another tool: libcosim with held signals gives our held-signal Jacobi."""

from __future__ import annotations

import math

import numpy as np
import pytest

from autobalancer.harness import Scene, cosimulate
from autobalancer.harness.accuracy.precision.libcosim import LibcosimRunner
from autobalancer.harness.master.cosimulation import CoSimulation

pytestmark = pytest.mark.slow

pytest.importorskip("libcosimpy")

STEP = 1.0 / 64.0  # s: a whole number of nanoseconds, in which libcosim counts time
STEPS = 400
SIGNALS = [
    "rotor.x", "rotor.y", "rotor.plane[1].a_xi", "weights.weight[1].angle",
    "weights.weight[2].speed", "weights.F_xi", "liquid.F_eta",
]  # fmt: skip
SCENE = {
    "rotor": {"kind": "planar", "mass": 0.95, "stiffness": [1.0, 9.0], "damping": [0.5, 1.0],
              "unbalance": 0.025},
    "balancer": [
        {"name": "weights", "kind": "pendulums", "count": 2, "mass": 0.025, "track_radius": 1.0,
         "drag": 0.0125, "angles": [0.3, 1.0]},
        # r m2 = rho pi r1^2 h = 0.2 kg: loop gain 0.2, so that held signals are stable
        {"name": "liquid", "kind": "liquid", "chamber_radius": 1.0, "float_radius": 0.5,
         "height": 0.2 / math.pi, "density": 1.0, "inertia_as_force": True},
    ],
    "operation": {"speed": 2.0 * math.pi / (40.0 * STEP)},
    "coupling": {"scheme": "jacobi", "order": 0, "steps_per_rev": 40},
    "run": {"revolutions": STEPS / 40},
}  # fmt: skip


def test_libcosim_couples_the_three_units_to_the_same_digits_as_held_jacobi():
    scene = Scene.from_document(SCENE)
    other_tool = LibcosimRunner(scene, SIGNALS)
    try:
        theirs = other_tool.run()
    finally:
        other_tool.close()
    with CoSimulation(scene) as cosim:
        cosim.start()
        assert 0.1 < cosim.gain < 0.5
        assert cosim.read("rotor", ["plane[1].added_mass"])[0] == pytest.approx(0.05)
    ours = cosimulate(scene, record=SIGNALS)
    assert len(theirs.time) == len(ours.time) - 1 == STEPS  # libcosim shows no start
    for name in SIGNALS:
        mine, other = ours[name][1:], theirs.signals[name]
        size = np.abs(mine).max()
        assert size > 1e-3, name
        gap = np.abs(mine - other).max()
        assert gap <= 1e-9 * size, (name, gap / size)
