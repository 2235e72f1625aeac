"""The rotor of a tool that nothing holds: its drift is no vibration."""

from __future__ import annotations

import pytest

import autobalancer as ab
from autobalancer.harness import SceneError


def test_rigid_motions_of_a_free_tool_have_the_frequency_0():
    rows = ab.load("angle_grinder").rotor().table().rows
    assert [row[1] for row in rows[:3]] == [0.0] * 3
    assert all(row[1] > 80.0 for row in rows[3:])


@pytest.mark.parametrize(
    "study",
    [
        lambda tool: tool.scatter(["rotor.mass=normal(500g,1%)"], n=2),
        lambda tool: tool.map("speed=300:900:2", "balls.drag=0.01:0.02:2", "cosim-run"),
        lambda tool: tool.motions(n=2),
        lambda tool: tool.design(race="22 mm", width="5 mm", n=2),
    ],
    ids=["scatter", "map", "motions", "design"],
)
def test_studies_that_judge_the_extent_of_a_motion_refuse_a_free_tool(study):
    with pytest.raises(SceneError, match="nothing holds 'housing'"):
        study(ab.load("angle_grinder"))
