"""Design of a balancer, and the co-simulated capacity of weights of finite size."""

from __future__ import annotations

import cmath
import math
import random
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import brentq

from autobalancer.fmus.composite.batch import BatchRuns
from autobalancer.harness import Scene, load_scene
from autobalancer.harness.checks.capacity import check_capacity, check_sizes, packed_turn
from autobalancer.harness.checks.goncharov import facing_start
from autobalancer.harness.checks.largest_spread import check_largest_spread
from autobalancer.harness.checks.ranking import check_ranking
from autobalancer.harness.checks.slow_root import check_slow_root
from autobalancer.harness.commands.design import table
from autobalancer.harness.design.choices import design
from autobalancer.harness.design.decay import decay
from autobalancer.harness.design.recommendation import contradictions, rivals, words
from autobalancer.harness.design.settling import median_interval, random_start, settled_at
from autobalancer.harness.errors import SceneError, SimulationError
from autobalancer.models.readable import readable_unbalance
from autobalancer.models.spacing import closest
from autobalancer.models.weights import alignment
from tests.studies.papers import fan_angles

pytestmark = pytest.mark.slow


def rows_of(measure, scene, **options):
    """All rows of a paper's check; `scene` may be the name of a bundled one."""
    scene = load_scene(scene) if isinstance(scene, str) else scene
    return list(measure(scene, **options))


def test_random_starts_never_overlap_and_reach_the_whole_circle():
    rng, alpha = random.Random(2), 0.3
    starts = [random_start(5, alpha, rng) for _ in range(500)]
    assert min(closest(angles)[0] for angles in starts) >= 2 * alpha - 1e-12
    resultant = np.mean([np.exp(1j * np.array(s)).sum() for s in starts])
    assert abs(resultant) < 0.3


def test_facing_starts_never_overlap_and_have_a_larger_spread():
    rng, alpha = random.Random(2), 0.2
    for count in range(2, 9):
        starts = [facing_start(count, alpha, rng) for _ in range(50)]
        assert min(closest(angles)[0] for angles in starts) >= 2 * alpha - 1e-12
        first = count - count // 2
        for angles in starts:  # the middles of both groups lie opposite each other
            middles = [angles[0] + angles[first - 1], angles[first] + angles[-1]]
            assert abs(np.subtract(*middles)) / 2 == pytest.approx(math.pi)
        others = [random_start(count, alpha, rng) for _ in range(50)]
        medians = [np.median([alignment(start) for start in some]) for some in (starts, others)]
        assert medians[0] > medians[1] + 0.1


def test_settling_time_is_the_last_time_above_the_limit():
    times = np.array([0.0, 1.0, 2.0, 3.0, 4.0])
    assert settled_at(times, np.array([9.0, 0.001, 0.5, 0.001, 0.0])) == 3.0
    assert settled_at(times, np.array([9.0, 0.001, 0.5, 0.001, 0.02])) == math.inf


def test_interval_of_the_median_covers_it_95_times_in_100():
    rng = np.random.default_rng(4)
    covered = 0
    for _ in range(300):
        _, low, high = median_interval(rng.exponential(1.0, 40).tolist())
        covered += low <= math.log(2.0) <= high
    assert 278 <= covered <= 298
    assert median_interval([1.0] * 5 + [math.inf] * 5)[2] == math.inf
    with pytest.raises(SimulationError, match="too few"):
        median_interval([1.0] * 5)


def test_residual_and_packed_angles_on_both_sides_of_the_capacity():
    scene = load_scene("finite_weights").replace({"run.revolutions": 60})
    rows = list(check_capacity(scene, points=3))
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
    rows = rows_of(check_sizes, "finite_weights")
    assert all(row.holds for row in rows)
    named = [(row.quantity, row.source.split(", ")[-1]) for row in rows if "in print" in row.source]
    assert named == [("3 balls: s", "cut off in print"), ("5 rollers: s", "rounded twice in print")]


def test_capacity_check_refuses_point_weights():
    with pytest.raises(SceneError, match="weight_radius"):
        next(check_capacity(load_scene("two_balls")))


def test_decay_is_the_exact_eigenvalue_and_near_the_slow_root_where_that_is_dominant():
    rows = rows_of(check_slow_root, "goncharov_rollers", starts=4, most=5, revolutions=250)
    assert [row for row in rows if not row.holds] == []
    counted, fitted, closed, _ = rows
    assert int(counted.measured.split()[0]) >= 3
    assert "of 16" in counted.measured
    assert fitted.error < 2e-3
    # (1) knows no damping of the rotor, which is an eighth of critical here
    assert 1e-3 < closed.error < 0.05


def test_decay_says_why_a_slow_root_is_not_compared():
    scene = load_scene("goncharov_rollers")
    assembly = scene.assembly()
    alpha = math.asin(0.0314 / 0.0936)
    spread_out = [2 * math.pi * k / 5 for k in range(5)]
    times, falling = np.linspace(0.0, 30.0, 400), 0.1 * np.exp(-np.linspace(0.0, 12.0, 400))
    balanced = fan_angles(assembly.weights[0].device, 0.0314, 0.284)
    args = assembly, 80.0, alpha, times
    assert decay(*args, 0.5 * falling**0.1, [balanced] * 400).excluded == "not yet at rest"
    closer = [balanced[0], balanced[0] + 2 * alpha, *balanced[2:]]
    moved = decay(*args, falling, [closer] * 390 + [balanced] * 10)
    assert moved.excluded == "contacts change"
    # at p near 0 both slow roots are the same
    assert alignment(spread_out) < 1e-12
    assert decay(*args, falling, [balanced] * 400).excluded in (
        "others nearly as slow",
        "slowest motion swings",
    )


def test_numbers_without_the_capacity_are_not_run_and_named():
    scene = load_scene("finite_weights").replace({"run.revolutions": 30})
    data = design(scene, unbalance=0.1, counts=[2, 3], starts=6)
    two, three = data.choices
    assert not two.has_capacity
    assert two.runs == ()
    assert math.isnan(two.median)
    assert three.has_capacity
    assert len(three.runs) == 6
    assert any("not run: n = 2" in line for line in words(data))


def test_a_rotor_below_its_critical_speed_is_refused():
    scene = load_scene("finite_weights").replace({"operation.speed": 20.0})
    with pytest.raises(SceneError, match="heavy side"):
        design(scene, starts=6)


def test_ranking_rows_compare_first_and_order_and_the_tolerance():
    scene = load_scene("goncharov_balls").replace({"run.revolutions": 100})
    rows = rows_of(check_ranking, scene, starts=6, most=3, repeated=1)
    named = {row.quantity.split(",")[0]: row for row in rows}
    first = named["balls: first to settle"]
    assert first.expected == "3"
    assert first.measured.startswith("3: ")
    assert first.holds
    assert named["balls: order of the medians"].measured == "3 2"
    assert named["balls: order of the medians"].holds
    assert rows[-1].quantity.startswith("settling time and that with a hundredth of the tolerance")
    assert rows[-1].holds


def test_three_weights_at_the_largest_p_have_the_slow_direction_of_two_and_it_is_named():
    options = {"most": 4, "revolutions": 250}
    two, three, four, best = rows_of(check_largest_spread, "goncharov_rollers", **options)
    for row in (two, three):
        assert row.quantity.endswith("slow direction")
        assert row.measured == "not settled"
        assert row.holds
    assert four.holds
    assert four.expected == pytest.approx(2.0 * 5.95, rel=0.05)  # half of a, nearly twice the time
    assert best.measured == "4"


def test_three_weights_are_warned_of_their_critical_case_where_it_is_near():
    """Two that touch hold m (R - r) 2 cos(alpha), and the third takes one m (R - r) of it."""
    scene = load_scene("finite_weights").replace({"run.revolutions": 5})
    data = design(scene, unbalance=0.06, counts=[3], starts=6)
    (three,) = data.choices
    balls = three.scene.balancer[0]
    arm = balls.mass * balls.track_radius
    critical = arm * (2.0 * math.cos(math.asin(balls.weight_radius / balls.track_radius)) - 1.0)
    lines = {
        share: [x for x in words(replace(data, unbalance=share * critical)) if "critical" in x]
        for share in (0.8, 0.95, 1.1, 2.0)
    }
    assert lines[0.8] == []  # no unbalance up to this one meets it
    at = f"at {readable_unbalance(critical)}"
    assert all(at in line for share in (0.95, 2.0) for line in lines[share])
    near = {share for share, found in lines.items() if any("WARNING" in x for x in found)}
    assert near == {0.95, 1.1}


def test_contradictions_need_intervals_that_do_not_touch():
    def choice(count, measure, low, high):
        median = 0.5 * (low + high)
        return SimpleNamespace(count=count, measure=measure, low=low, high=high, median=median)

    choices = [choice(3, 3.0, 2.0, 3.0), choice(4, 2.0, 1.0, 1.9), choice(5, 1.0, 1.5, 2.5)]
    data = SimpleNamespace(with_capacity=choices)
    assert contradictions(data) == [(3, 4)]
    assert [c.count for c in rivals(data)] == [4, 5]


def test_two_weights_without_unbalance_are_named_not_failed():
    changes = {"run.revolutions": 40, "coupling.steps_per_rev": 20}
    scene = load_scene("finite_weights").replace(changes)
    data = design(scene, unbalance=0.0, counts=[2], starts=6)
    (two,) = data.choices
    assert two.predicted == math.inf
    # what is left falls in the driven direction: nothing has to move along the other one
    assert two.median < 2.0
    assert all(run.alignment == pytest.approx(1.0, abs=0.01) for run in two.runs)


@pytest.fixture
def one_process(monkeypatch):
    """Commands without processes of their own, which take longer to begin than these runs."""
    monkeypatch.setattr("os.cpu_count", lambda: 1)


ROTOR = """
rotor = {kind = "planar", mass = "8 kg", stiffness = ["20 kN/m", "24 kN/m"], damping = 60}
operation = {speed = "1200 rpm"}
run = {revolutions = 30}
"""
SPACE = ["--track", "180mm", "--width", "30mm", "--starts", "6", "--most", "4"]


def test_details_of_a_rotor_without_balls_name_the_fewest_that_hold_its_unbalance(
    invoke, tmp_path, one_process
):
    scene = tmp_path / "rotor.toml"
    scene.write_text(ROTOR, encoding="utf-8")
    space = [*SPACE, "--unbalance", "0..30 g m", "--reserve", "1.3"]
    asked = ["design", scene, "--details", *space]
    steel = invoke(*asked, "-o", tmp_path / "steel.png")
    assert steel.exit_code == 0, steel.output
    assert "n = 2" in steel.output  # 2 balls of 110 g on a circle of 165 mm hold 36 g m, not 39
    assert "30 mm diameter and 110.3 g" in steel.output
    assert "Drag is ASSUMED" in steel.output
    assert (tmp_path / "steel.png").stat().st_size > 10_000
    heavy = invoke(*asked, "--material", "tungsten carbide", "--units", "engineering")
    assert "balls for 30000 g mm with" in heavy.output
    assert "│ 2 │          30 │  0.4213 │      69220 │ 43 % │" in heavy.output


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        (["--unbalance", "300..0 g mm"], "must rise from 0 or more, such as"),
        (["--race", "80"], 'write "80 mm" if it is in mm'),
        (["--unbalance", "3 kg"], "an unbalance is expected"),
        (["--material", "stel"], 'did you mean "steel"'),
        (["--material", "1e20"], "must be above 0 and below 100000 kg/m^3"),
        (["--reserve", "0.5"], "must be 1 or more"),
        (["--set", "rotor.unbalance=300 g mm", "--width", "0"], "must be above 0"),
    ],
)
def test_wrong_demands_on_a_design_are_refused(invoke, tmp_path, arguments, problem):
    scene = tmp_path / "rotor.toml"
    scene.write_text(ROTOR, encoding="utf-8")
    refused = invoke("design", scene, *SPACE, *arguments)
    assert refused.exit_code == 2
    assert problem in refused.stderr


def test_a_scene_that_is_none_for_a_design_is_refused_with_every_reason():
    with pytest.raises(
        SceneError, match=r'"two_support": must be "planar"; \[\[balancer\]\]: must be'
    ):
        design(load_scene("two_plane_rodrigues"), starts=6, race=0.1, width=0.01)
    with pytest.raises(SceneError, match="give --race and --width"):
        design(load_scene("two_balls"), starts=6)


def test_design_command_shows_a_table_words_and_a_picture(
    invoke, tmp_path, monkeypatch, one_process
):
    monkeypatch.setenv("COLUMNS", "80")
    scene = tmp_path / "short.toml"
    text = load_scene("finite_weights").path.read_text()
    short = text.replace("revolutions = 100", "revolutions = 30")
    scene.write_text(short.replace("steps_per_rev = 40", "steps_per_rev = 20"))
    picture = tmp_path / "design.png"
    arguments = ["design", str(scene), "--details", "--starts", "6", "--most", "3"]
    arguments += ["-o", str(picture)]
    result = invoke(*arguments)
    assert result.exit_code == 0, result.output
    first, _, _ = result.output.partition("By Goncharov 2017")
    table = [line for line in first.splitlines() if line and line[0] in "┏┃┡│└"]
    assert len([line for line in table if line[0] == "│"]) == 2  # no cell is broken
    assert max(map(len, table)) <= 80
    assert "p largest" in result.output
    assert "Take 3 balls of 50 mm diameter" in result.output
    assert picture.stat().st_size > 10_000
    short = invoke(*arguments, "--unbalance", "5")
    assert "No number of balls in this space" in short.output
    refused = invoke("design", "two_balls")
    assert refused.exit_code == 2


AFTER_IMPACTS = {
    "title": "Six heavy balls whose impacts end just before a communication step does",
    "rotor": {
        "kind": "planar",
        "mass": 19.35709793707314,
        "stiffness": 1964.076536401777,
        "damping": 10.084371434971034,
        "unbalance": 0.20048428419251646,
    },
    "balancer": [
        {
            "kind": "balls",
            "name": "balls",
            "count": 2,
            "mass": 0.4403165027572055,
            "track_radius": 0.16654823413262565,
            "weight_radius": 0.023797276148489702,
            "drag": 0.015892491288539916,
        }
    ],
    "operation": {"speed": 20.870316462479813},
    "run": {"revolutions": 100},
}


def test_the_step_behind_an_impact_is_not_predicted_from_rounding():
    """The curvature that a step 5000 times shorter had left made forces 20 times too large."""
    scene = Scene.from_document(AFTER_IMPACTS)
    found = design(scene, counts=[6], starts=10)
    assert [choice.failures for choice in found.choices] == [[]]


def test_a_start_that_fails_is_a_row_with_its_reason_and_the_rest_is_kept(monkeypatch):
    """Starts 2 and 9 of every batch fail."""
    scene = Scene.from_document(AFTER_IMPACTS).replace({"run.revolutions": 30})
    whole = design(scene, counts=[2, 3, 4], starts=10)
    own = BatchRuns.__call__

    def failing(self, values, ends):
        signals, reasons = own(self, values, ends)
        signals[[1, 8]] = np.nan
        return signals, ["no luck at t = 3 s" if k in (1, 8) else r for k, r in enumerate(reasons)]

    monkeypatch.setattr(BatchRuns, "__call__", failing)
    found = design(scene, counts=[2, 3, 4], starts=10)
    for before, after in zip(whole.with_capacity, found.with_capacity, strict=True):
        assert [k for k, _ in after.failures] == [2, 9]
        kept = [run.seconds for k, run in enumerate(before.runs) if k not in (1, 8)]
        assert [run.seconds for run in after.ran] == kept
    said = "\n".join(words(found))
    count = found.with_capacity[0].count
    assert f"n = {count}, start 2 failed (1 more like it): no luck at t = 3 s" in said
    rows = table(found, 10).rows
    assert any(row[-1].endswith("/8, 2 failed") for row in rows)
    assert not any("inf" in cell or "never" in cell for row in rows for cell in row)


def test_what_does_not_settle_is_stated_with_the_time_of_the_run():
    scene = Scene.from_document(AFTER_IMPACTS).replace({"run.revolutions": 5})
    rows = table(design(scene, counts=[4], starts=6), 6).rows
    assert rows[0][-2] == "not within 1.51 s"
