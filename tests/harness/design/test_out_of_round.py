"""What `race` says of races that are not round."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

import autobalancer as ab
from autobalancer.harness.errors import UserError

WHEEL = {
    "rotor": {"kind": "planar", "mass": 10.0, "stiffness": 1e4, "damping": 60.0, "unbalance": 0.02},
    "balancer": [{"kind": "pendulums", "count": 2, "mass": 0.15, "track_radius": 0.1, "drag": 0.6}],
    "operation": {"speed": 100.0},
}


def test_an_oval_leaves_what_an_integration_of_another_program_ends_with():
    along = ab.Scene(**WHEEL).race("2=0.2 mm")
    across = ab.Scene(**WHEEL).race("2=0.2 mm@45 deg")
    assert along.left[0][0] == pytest.approx(0.70193631e-3, abs=1e-10)
    assert across.left[0][0] == pytest.approx(0.10693227e-3, abs=1e-10)
    # the race against the unbalance is not known: the worst is the same
    assert across.left[0][1] >= 0.7e-3
    assert "of 2.22 mm without pendulums" in along.sentence()


def test_lobes_are_stated_one_by_one_and_together(invoke, tmp_path):
    target = tmp_path / "race.json"
    file = ab.Scene(**WHEEL).save(tmp_path / "wheel.toml")
    outcome = invoke("race", file, "--lobes", "1=0.2 mm@0.7, 3=0.1 mm", "--json", target)
    assert outcome.exit_code == 0, outcome.output
    found = json.loads(target.read_text())
    assert found["left"][0]["here"] == pytest.approx(0.19995759e-3, abs=1e-10)
    assert [len(found["left"]), len(found["angles"])] == [3, 2]


@pytest.mark.parametrize(
    ("changes", "lobes", "message"),
    [
        ({}, "oval", "must be ORDER=AMPLITUDE"),
        ({}, "2=20 kg", "a length is expected"),
        ({"rotor.stiffness": [1e4, 2e4]}, "2=20 um", "only on a planar rotor without bodies"),
        ({"rotor.unbalance": 0.2}, "2=20 um", "do not balance the rotor on a round race"),
        ({"operation.speed": 5.0}, "2=20 um", "do not balance the rotor on a round race"),
    ],
)
def test_what_has_no_answer_is_refused_with_a_reason(changes, lobes, message):
    with pytest.raises(UserError, match=message):
        ab.Scene(**WHEEL).replace(changes).race(lobes)


def test_a_run_ends_with_what_the_worst_angle_of_the_races_leaves():
    fan = ab.load("oval_fan")
    ((_, worst),) = fan.race().left
    by = math.tau * 3 / 12
    turned = {f"{b.label}.race[{k}].angle": one.angle + by
              for b in fan.balancer for k, one in enumerate(b.race, start=1)}  # fmt: skip
    run = fan.replace(turned).run()
    ends = [np.hypot(run[f"rotor.station[{k}].x"], run[f"rotor.station[{k}].y"]) for k in (1, 2)]
    assert max(end[-40:].max() for end in ends) == pytest.approx(worst, rel=1e-4)
