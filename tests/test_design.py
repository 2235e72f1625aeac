"""Design of a balancer, and the co-simulated capacity of weights of finite size."""

from __future__ import annotations

import cmath
import math
import random

import numpy as np
import pytest
from scipy.optimize import brentq
from typer.testing import CliRunner

from autobalancer.harness import load_scene
from autobalancer.harness.checks.capacity import check_capacity, check_sizes, packed_turn
from autobalancer.harness.cli import app
from autobalancer.harness.design import design
from autobalancer.harness.design_study import (
    decay_rate,
    median_interval,
    random_start,
    settled_at,
)
from autobalancer.harness.errors import SceneError, SimulationError
from autobalancer.harness.scene_check import CapacityCheck
from autobalancer.models.positions import least_distance


def test_random_starts_never_overlap_and_reach_the_whole_circle():
    rng, alpha = random.Random(2), 0.3
    starts = [random_start(5, alpha, rng) for _ in range(500)]
    assert min(map(least_distance, starts)) >= 2 * alpha - 1e-12
    resultant = np.mean([np.exp(1j * np.array(s)).sum() for s in starts])
    assert abs(resultant) < 0.3


def test_settling_time_is_the_last_time_above_the_limit():
    times = np.array([0.0, 1.0, 2.0, 3.0, 4.0])
    assert settled_at(times, np.array([9.0, 0.001, 0.5, 0.001, 0.0])) == 3.0
    assert settled_at(times, np.array([9.0, 0.001, 0.5, 0.001, 0.02])) == math.inf


def test_decay_rate_is_that_of_the_last_exponential():
    times = np.linspace(0.0, 8.0, 400)
    residuals = np.exp(-1.5 * times) + 3.0 * np.exp(-9.0 * times)
    assert decay_rate(times, residuals) == pytest.approx(-1.5, rel=1e-3)
    assert math.isnan(decay_rate(times[:5], residuals[:5]))


def test_interval_of_the_median_covers_it_95_times_in_100():
    rng = np.random.default_rng(4)
    covered = 0
    for _ in range(1000):
        _, low, high = median_interval(rng.exponential(1.0, 40).tolist())
        covered += low <= math.log(2.0) <= high
    assert 935 <= covered <= 990
    assert median_interval([1.0] * 5 + [math.inf] * 5)[2] == math.inf
    with pytest.raises(SimulationError, match="too few"):
        median_interval([1.0] * 5)


def test_residual_and_packed_angles_on_both_sides_of_the_capacity():
    scene = load_scene("finite_weights").replace({"run.revolutions": 60})
    check = CapacityCheck(kind="capacity", points=3, up_to=1.2)
    rows = list(check_capacity(scene, check, lambda fraction: None))
    assert len(rows) == 4
    assert [row for row in rows if not row.holds] == []
    # the rotor's damping turns the group: without that the angles would not hold
    assert rows[-1].error < 1e-4


@pytest.mark.parametrize("share", [0.3, 0.8, 0.99])
def test_packed_group_rests_where_nothing_drives_it_along_the_track(share):
    response = cmath.rect(-3.0, 0.2)

    def drive(delta):
        return (response * (1.0 - share * cmath.exp(1j * delta)) * cmath.exp(-1j * delta)).imag

    assert packed_turn(response, share) == pytest.approx(brentq(drive, -0.5, 0.5), abs=1e-10)


def test_table_1_rows_hold_and_name_the_two_digits_that_are_not_rounded():
    rows = list(check_sizes(load_scene("finite_weights")))
    assert all(row.holds for row in rows)
    named = [(row.quantity, row.source.split(", ")[-1]) for row in rows if "in print" in row.source]
    assert named == [("3 balls: s", "cut off in print"), ("5 rollers: s", "rounded twice in print")]


def test_capacity_check_refuses_point_weights():
    check = CapacityCheck(kind="capacity")
    with pytest.raises(SceneError, match="weight_radius"):
        list(check_capacity(load_scene("two_balls"), check, lambda fraction: None))


def test_decay_is_the_slow_root_where_that_is_dominant():
    scene = load_scene("finite_weights").replace({"balls.drag": 30.0, "run.revolutions": 150})
    data = design(scene, unbalance=0.005, density=780.0, counts=[5], starts=6, workers=2)
    runs = [r for r in data.choices[0].runs if not math.isnan(r.rate + r.root)]
    assert runs
    assert max(abs(r.rate / r.root - 1.0) for r in runs) < 0.05
    assert len(runs) < 6  # where the weights' other motions or the rotor's are as slow, it is said


def test_two_weights_without_unbalance_are_named_not_failed():
    scene = load_scene("finite_weights").replace({"run.revolutions": 40})
    data = design(scene, unbalance=0.0, counts=[2], starts=6)
    (two,) = data.choices
    assert two.predicted == math.inf
    assert all(run.spread == pytest.approx(1.0, abs=0.01) for run in two.runs)
    assert any("one diameter" in line for line in data.words)


def test_design_command_shows_a_table_words_and_a_picture(tmp_path, monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")
    scene = tmp_path / "short.toml"
    text = load_scene("finite_weights").path.read_text()
    scene.write_text(text.replace("revolutions = 100", "revolutions = 40"))
    picture = tmp_path / "design.png"
    arguments = ["design", str(scene), "--starts", "6", "--most", "3", "-o", str(picture)]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 0, result.output
    assert "p largest" in result.output
    assert "balls of radius" in result.output
    assert picture.stat().st_size > 10_000
    short = CliRunner().invoke(app, [*arguments, "--unbalance", "5"])
    assert "No number of balls in this space" in short.output
    refused = CliRunner().invoke(app, ["design", "two_balls"])
    assert refused.exit_code == 2
