"""Verdicts on random machines against an integration that goes on ten times as long: a sample.

The study is `python -m tests.studies.verdicts`.
"""

from __future__ import annotations

from dataclasses import replace

import pytest

from autobalancer.harness import Scene, cosimulate
from autobalancer.harness.result.verdict import Outcome
from tests.studies.verdict_scenes import drawn
from tests.studies.verdicts import check, judge

pytestmark = [
    pytest.mark.slow,
    pytest.mark.filterwarnings("ignore::autobalancer.harness.scene.plausible.ImplausibleWarning"),
]
FALSE = {  # what the machine does, and what would be false of it
    ("settling", 0): Outcome.ANOTHER_MOTION,
    ("below critical", 0): Outcome.BALANCED,
    ("settling", 1): Outcome.OUT_OF_REACH,
    ("stops", 3): Outcome.ANOTHER_MOTION,
    ("stops", 4): Outcome.BALANCED,
    ("cubic springs", 5): Outcome.OUT_OF_REACH,
}


@pytest.mark.parametrize(
    ("family", "number"),
    [("planar", 1), ("settling", 0), ("settling", 1), ("gravity", 3), ("short", 2),
     ("changing", 1), ("liquid", 0), ("run-up", 5), ("stops", 3), ("cubic springs", 5)],
)  # fmt: skip
def test_a_verdict_comes_true(family, number):
    found = judge(family, number, seed=1, by="reference")
    assert found.wrong == "", found.text


@pytest.mark.parametrize(("machine", "outcome"), FALSE.items())
def test_the_study_finds_a_false_verdict(machine, outcome):
    scene = Scene.from_document(drawn(*machine, seed=1))
    result = cosimulate(scene)
    false = replace(result.summary(), outcome=outcome, growth=None, revolutions=None)
    wrong, _ = check(scene, false, float(result.time[-1]), "units")
    assert wrong
