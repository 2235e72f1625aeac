"""The integration in one piece in C is right, and of order eight."""

from __future__ import annotations

import math

import pytest

from autobalancer.harness import load_scene
from tests.one_piece.integrator import OnePiece


def test_its_error_falls_with_the_eighth_power_of_the_step(tmp_path):
    whole = OnePiece(load_scene("two_balls").replace({"run.revolutions": 4}), tmp_path)
    coarse, fine = whole.error(16), whole.error(32)
    assert fine < 1e-7
    assert math.log2(coarse / fine) == pytest.approx(8.0, abs=1.0)
