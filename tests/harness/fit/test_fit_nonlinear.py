"""A gap and a lobe are found from amplitudes of closed forms; `scatter` varies them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import brentq

import autobalancer as ab
from autobalancer.models.lobes import Race
from autobalancer.models.weights import Lobes

MASS, STIFFNESS, DAMPING, UNBALANCE, STOP = 1.0, 1.0, 0.1, 0.05, 9.0
WHEEL = {
    "rotor": {"kind": "planar", "mass": 10.0, "stiffness": 1e4, "damping": 60.0, "unbalance": 0.02},
    "balancer": [{"kind": "pendulums", "count": 2, "mass": 0.15, "track_radius": 0.1, "drag": 0.6,
                  "name": "pendulums", "angles": [2.0, 4.0],
                  "race": [{"lobes": 2, "amplitude": 1e-4}]}],
    "operation": {"speed": 100.0},
    "run": {"duration": 20.0},
}  # fmt: skip

TUB = ab.load("washing_machine_tub").replace({"run.revolutions": 20})


def stopped(gap):
    """A disc in a ring-shaped stop."""
    stop = {"support": 1, "gap": gap, "stiffness": STOP}
    rotor = {"kind": "planar", "mass": MASS, "stiffness": STIFFNESS, "damping": DAMPING,
             "unbalance": UNBALANCE, "stops": [stop]}  # fmt: skip
    return ab.Scene(rotor=rotor, operation={"speed": 1.0}, run={"revolutions": 60})


def touching(speed, gap):
    """Radius of the whirl that touches the stop all along."""

    def missing(a):
        spring = (STIFFNESS - MASS * speed**2) * a + STOP * max(a - gap, 0.0)
        return math.hypot(spring, DAMPING * speed * a) - UNBALANCE * speed**2

    return brentq(missing, 1e-6, 2.0)


def written(tmp_path, rows):
    path = tmp_path / "measured.csv"
    lines = [f"{w / math.tau},{1e3 * a}\n" for w, a in rows]
    path.write_text("speed [Hz],amplitude [mm]\n" + "".join(lines))
    return path


def test_the_gap_of_a_stop_is_found_from_the_whirl_that_touches_it(tmp_path):
    path = written(tmp_path, [(w, touching(w, 0.2)) for w in (0.95, 1.0, 1.05)])
    found = stopped(0.23).fit(path, ["rotor.stops[1].gap"])
    assert found.values == pytest.approx([0.2], rel=1e-3)


def test_an_oval_is_found_from_what_it_leaves(tmp_path):
    scene, rows = ab.Scene(**WHEEL), []
    for speed in (90.0, 100.0, 110.0):
        rests = Race(scene.assembly().at_speed(speed), speed, [Lobes(2, 2e-4, 0.0)]).rests()
        rows.append((speed, abs(rests[0].displacement)))
    found = scene.fit(written(tmp_path, rows), ["pendulums.race[1].amplitude"])
    assert found.values == pytest.approx([2e-4], rel=1e-2)


@pytest.mark.parametrize(
    ("scene", "path", "law"),
    [
        (stopped(0.2).replace({"speed": 1.05}), "rotor.stops[1].gap", "uniform(0.15,0.21)"),
        (ab.Scene(**WHEEL), "pendulums.race[1].amplitude", "uniform(0.05mm,0.15mm)"),
        (TUB, "tub.mass", "uniform(18kg,40kg)"),
    ],
)
def test_every_machine_of_a_scatter_is_the_run_of_its_scene(scene, path, law):
    found = scene.scatter({path: law}, 2)
    assert abs(found.residual[0] - found.residual[1]) > 0.03 * found.residual[0]
    for value, residual in zip(found.values[:, 0], found.residual, strict=True):
        run = scene.replace({path: value}).run()
        last = run.time > run.time[-1] - math.tau / scene.profile().end
        names = [n[:-2] for n in run.signals if n.startswith("rotor") and n.endswith(".x")]
        sizes = [np.hypot(run[f"{n}.x"], run[f"{n}.y"])[last].max() for n in names]
        assert any(residual == pytest.approx(size, rel=5e-3) for size in sizes), sizes
