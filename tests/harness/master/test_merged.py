"""Identical point weights that a run cannot part though real ones would: said, and what to do."""

import math

import numpy as np
import pytest

from autobalancer.harness import Scene, cosimulate, cosimulate_many
from autobalancer.harness.scatter.report import document, lines
from autobalancer.harness.scatter.study import scatter
from autobalancer.harness.scatter.vary import Variation
from autobalancer.models.linear.together import difference_growth

TOGETHER = [0.1, 0.1, 0.1]


def drum(angles=TOGETHER, **changes) -> Scene:
    """Three point balls, above all critical speeds."""
    document = {
        "rotor": {
            "kind": "planar", "mass": 8.0, "stiffness": [20e3, 30e3], "damping": [80.0, 100.0],
            "unbalance": 0.02,
        },
        "balancer": [
            {
                "name": "balls", "kind": "balls", "count": 3, "mass": 0.05, "track_radius": 0.2,
                "drag": 2.0, "angles": angles,
            }
        ],
        "operation": {"speed": 150.0},
        "run": {"revolutions": 100.0},
        "coupling": {"steps_per_rev": 40},
    }  # fmt: skip
    return Scene.from_document(document, label="drum").replace(changes)


def amplitude(result) -> float:
    return float(np.hypot(result["rotor.x"], result["rotor.y"])[-40:].max())


@pytest.mark.parametrize("separate", [True, False])
def test_weights_that_cannot_part_though_they_would_are_said_with_what_to_do(separate):
    result = cosimulate(drum(), separate=separate)
    assert amplitude(result) > 1e-3, "not balanced"
    note = result.events[0]
    assert "balls: 3 of 3 identical weights end at one angle" in note
    assert "balls.weight_radius" in note
    assert "2, 2.000000002 N s/m" in note


def test_weights_that_part_balance_and_need_no_note():
    result = cosimulate(drum([0.1, 0.1 + 1e-9, 0.1 - 1e-9], **{"run.revolutions": 400.0}))
    assert not result.events
    assert amplitude(result) < 1e-8
    base = drum()
    first = base.balancer[0].model_dump(exclude_none=True, exclude_defaults=True)
    first["kind"] = base.balancer[0].kind
    apart = [
        {**first, "name": f"ball{k}", "count": 1, "angles": [0.1 + k], "speeds": [0.0],
         "drag": 2.0 * (1.0 + 1e-9 * k)}
        for k in range(3)
    ]  # fmt: skip
    result = cosimulate(Scene.from_document({**base.document, "balancer": apart}, label="drum"))
    assert not result.events
    assert amplitude(result) < 1e-6


def test_weights_together_where_that_is_stable_need_no_note():
    """Below the critical speeds all weights go to the heavy side."""
    assert not cosimulate(drum(**{"operation.speed": 30.0})).events


def test_growth_of_a_difference_is_that_of_weights_set_apart_a_little():
    scene = drum([0.1, 0.1 + 1e-8, 0.1 - 1e-8], **{"run.revolutions": 60.0})
    result = cosimulate(scene)
    apart = np.abs(result["balls.weight[2].angle"] - result["balls.weight[3].angle"])
    late = result.time > 0.5 * result.time[-1]
    slope = np.polyfit(result.time[late], np.log(apart[late]), 1)[0]
    angles = np.array([result[f"balls.weight[{k}].angle"][-1] for k in (1, 2, 3)])
    assert slope == pytest.approx(difference_growth(scene.assembly(), 150.0, angles)[0], rel=0.02)


def test_many_runs_tell_which_have_merged():
    first = [0.1, 2.0, 0.1]
    table = {"balls.weight[1].angle0": first, "speed": [150.0, 150.0, 30.0]}
    found = cosimulate_many(drum(), table, results=["residual", "merged"])
    assert found["merged"].tolist() == [1.0, 1.0, 1.0]  # two of three, and stable ones, count
    apart = drum([0.1, 2.0, 4.0])
    assert cosimulate_many(apart, {"speed": [150.0]}, results=["merged"])["merged"] == [0.0]


def test_a_scatter_counts_machines_that_cannot_part_their_weights():
    study = scatter(drum(), [Variation.parse("rotor.unbalance=uniform(0.018,0.022)")], 3)
    assert study.merged.tolist() == [1.0, 1.0, 1.0]
    assert lines(document(study))[1].startswith("Residual amplitude")
    assert "In 3 machines identical weights end at one angle" in "\n".join(lines(document(study)))
    parted = scatter(
        drum([0.1, 2.0, 4.0]), [Variation.parse("rotor.unbalance=uniform(0.018,0.022)")], 3
    )
    assert not parted.merged.any()
    assert math.isclose(document(parted)["merged"], 0.0)
