"""Dampers with a free stroke between bodies, in both engines, against an integration apart."""

from __future__ import annotations

import numpy as np
import pytest

import autobalancer as ab
from tests.studies import stops as study

pytestmark = pytest.mark.filterwarnings(
    "ignore::autobalancer.harness.scene.plausible.ImplausibleWarning"
)
FOOT, BEARING = "tub.foot[1]", 1
MOTION = [f"rotor.station[{k}].{v}{a}" for v in ("", "v") for a in "xy" for k in (1, 2)]


def tub(*places, more=(), revolutions=8, **keys):
    damper = {"limit": "20 N", "stiffness": "100 N/mm", "free_stroke": "1 mm"} | keys
    rotor = ab.Planar(
        mass=10.0, stiffness=[4e4, 3e4], damping=80.0, unbalance=0.04, unbalance_angle=0.7,
        on="tub", bodies=[{"name": "tub", "mass": 20.0,
                           "feet": [{"stiffness": 2e4, "damping": [60.0, 40.0]}]}],
        friction=[{"support": place} | damper for place in places],
    )  # fmt: skip
    return ab.Scene(
        rotor=rotor,
        operation={"speed": 30.0},
        run={"revolutions": revolutions, "record": [*MOTION, *more]},
        coupling={"tolerance": 1e-7},
    )


@pytest.mark.parametrize("separate", [False, True], ids=["one piece", "separate units"])
@pytest.mark.parametrize("places", [(FOOT,), (BEARING,), (FOOT, BEARING)], ids=str)
def test_a_damper_moves_as_in_an_integration_apart(places, separate):
    scene = tub(*places)
    run = scene.run(separate=separate)
    states, held, own = study.reference(scene, np.asarray(run.time))
    assert held.events > 10
    moved = np.array([run[name] for name in MOTION])
    reach = np.abs(states[:4]).max()
    assert np.abs(moved[:4] - states[:4]).max() <= (1e-7 + own) * reach


def test_a_damper_that_slips_at_once_is_a_force_that_its_foot_carries():
    # so stiff and without a stroke it slips all the time: the limit against the tub's way
    names = [f"rotor.foot[1].force_{a}" for a in "xy"]
    run = tub(FOOT, free_stroke=0.0, stiffness="10 kN/mm", more=names).run()
    foot = np.array([2e4 * run[f"rotor.station[2].{a}"] for a in "xy"])
    foot += np.array([[60.0], [40.0]]) * [run[f"rotor.station[2].v{a}"] for a in "xy"]
    rest = np.array([run[name] for name in names]) - foot
    rate = np.array([run[f"rotor.station[2].v{a}"] for a in "xy"])
    fast = np.abs(rate) > 0.5 * np.abs(rate).max()
    np.testing.assert_allclose(rest[fast], 20.0 * np.sign(rate[fast]), rtol=1e-6)


def test_a_rigid_slider_on_a_foot_in_the_plane_of_a_support_sticks():
    run = tub(FOOT, free_stroke=0.0, stiffness=None, limit="10 kN").run()
    assert np.abs(run["rotor.station[2].x"]).max() == 0.0
    assert np.abs(run["rotor.station[1].x"]).max() > 1e-4
