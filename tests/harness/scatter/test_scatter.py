"""Machines of a linear rotor scatter as its closed form says; stores, failures, the command."""

import csv
import json
import math

import numpy as np
import pytest
from scipy import stats

from autobalancer.harness import SimulationError, UserError, cosimulate, load_scene
from autobalancer.harness.scatter import study
from autobalancer.harness.scatter.report import lines
from autobalancer.harness.scatter.study import scatter
from autobalancer.harness.scatter.vary import Variation
from autobalancer.harness.scene.grade import residual_unbalance

GRAVITY = {
    "rotor.mass": 8.0,
    "rotor.stiffness": [20e3, 30e3],
    "rotor.damping": [80.0, 100.0],
    "rotor.unbalance": 0.02,
    "weights.mass": 0.1,
    "weights.track_radius": 0.2,
    "weights.drag": 0.2,
    "operation.speed": 150.0,
    "operation.gravity": 9.81,
    "run.revolutions": 200,
}
MASS, STIFFNESS, DAMPING, SPEED = 2.0, 800.0, 12.0, 50.0


@pytest.fixture
def linear():
    """A rotor without balancers whose transient has died out, e^(-zeta w t) = 1e-8."""
    return (
        load_scene("two_balls")
        .without_balancers()
        .replace(
            {
                "rotor.mass": MASS,
                "rotor.stiffness": STIFFNESS,
                "rotor.damping": DAMPING,
                "operation.speed": SPEED,
                "run.revolutions": 50,
                "coupling.steps_per_rev": 20,
            }
        )
    )


@pytest.fixture
def two_sized():
    """Two weights of finite size, which overlap at less than 0.3 rad."""
    return load_scene("two_balls").replace({"weights.weight_radius": 0.15, "run.revolutions": 5})


# each alone allowed beside the other's median
MAY_OVERLAP = ("weights.angles[1]=uniform(0,0.9)", "weights.angles[2]=uniform(1,2)")


def amplitude(unbalance, damping=DAMPING, speed=SPEED):
    dynamic = STIFFNESS - MASS * speed**2 + 1j * damping * speed
    return unbalance * speed**2 / abs(dynamic)


def vary(*texts):
    return [Variation.parse(text) for text in texts]


def test_amplitudes_of_linear_rotors_are_distributed_as_their_closed_form(linear):
    found = scatter(linear, vary("rotor.unbalance=normal(0.02,0.002)"), 500, seed=3)
    np.testing.assert_allclose(found.residual, amplitude(found.values[:, 0]), rtol=1e-6)
    expected = stats.norm(amplitude(0.02), amplitude(0.002))
    assert stats.kstest(found.residual, expected.cdf).pvalue > 0.01


def test_speed_and_damping_enter_as_in_the_closed_form(linear):
    longer = linear.replace({"run.revolutions": 100})  # the least damped: e^-26
    found = scatter(longer, vary("speed=uniform(45,60)", "rotor.damping=uniform(10,14)"), 40)
    speed, damping = found.values.T
    expected = amplitude(linear.rotor.unbalance, damping, speed)
    np.testing.assert_allclose(found.residual, expected, rtol=1e-6)


def test_share_within_a_grade_is_that_of_the_unbalance(linear):
    """A bare rotor keeps its unbalance: U w / M, uniform, meets G250 for 0.6 of the machines."""
    low, high = (0.25 * MASS / SPEED + step * 0.001 for step in (-6.0, 4.0))
    found = scatter(linear, vary(f"rotor.unbalance=uniform({low!r},{high!r})"), 600, seed=2)
    np.testing.assert_allclose(found.grade, 1e3 * found.values[:, 0] * SPEED / MASS, rtol=1e-12)
    within = int((found.grade <= 250.0).sum())
    assert stats.binomtest(within, 600, 0.6).pvalue > 0.01


def test_every_machine_is_the_run_of_its_scene():
    scene = load_scene("two_balls").replace({"run.revolutions": 12})
    texts = ("weights.drag=uniform(0.01,0.03)", "rotor.stiffness[2]=uniform(40,60)")
    found = scatter(scene, vary(*texts), 3)
    for (drag, stiffness), residual, grade in zip(
        found.values, found.residual, found.grade, strict=True
    ):
        changed = scene.replace({"weights.drag": drag, "rotor.stiffness[2]": stiffness})
        run = cosimulate(changed)
        motion = np.hypot(run["rotor.x"], run["rotor.y"])
        left = complex(
            scene.rotor.unbalance + run["weights.moment_xi"][-1], run["weights.moment_eta"][-1]
        )
        assert residual == pytest.approx(motion[-20:].max(), abs=1e-4 * motion.max())
        assert grade == pytest.approx(
            1e3 * abs(left) * 3.0 / 0.95, abs=1e-4 * scene.rotor.unbalance * 3e3
        )


def test_a_two_plane_grade_is_judged_at_either_support():
    """Drum: 0.18/0.4 of the weight is on support 2, and 0.12/0.4 of the unbalance 0.06 kg m."""
    scene = load_scene("drum")
    held = dict.fromkeys([f"{b}.moment_{a}" for b in ("front", "back") for a in ("xi", "eta")], 0.0)
    first = 0.06 * 0.7 / 0.55 * 125.0 / 40.0
    assert residual_unbalance(scene, held)[1] == pytest.approx(1e3 * first, rel=1e-12)
    # what balances support 1 leaves support 2: rings at -0.02 and 0.42 m
    amount = -0.06 * 0.7 / (1.0 + 0.02 / 0.4) * np.exp(0.4j)
    held |= {"front.moment_xi": amount.real, "front.moment_eta": amount.imag}
    second = abs(0.06 * 0.3 * np.exp(0.4j) + amount * -0.02 / 0.4)
    assert residual_unbalance(scene, held)[1] == pytest.approx(
        1e3 * second / 0.45 * 125 / 40, rel=1e-12
    )


def test_under_gravity_the_grade_is_that_of_the_mean_over_the_last_revolution():
    """As the run's verdict; the moment at the end alone is off by a multiple."""
    scene = load_scene("two_balls").replace(GRAVITY)
    found = scatter(scene, vary("rotor.mass=uniform(7.9,8.1)"), 2)
    for (mass,), grade in zip(found.values, found.grade, strict=True):
        machine = scene.replace({"rotor.mass": mass})
        run = cosimulate(machine)
        ends = {f"weights.moment_{a}": run[f"weights.moment_{a}"][-1] for a in ("xi", "eta")}
        mean, end = run.summary().left[1], residual_unbalance(machine, ends)[1]
        assert abs(end - mean) > 0.2 * mean
        assert grade == pytest.approx(mean, rel=0.02)


def test_a_liquid_has_no_grade_and_that_is_said():
    found = scatter(load_scene("liquid_disc"), vary("rotor.unbalance=uniform(1e-4,2e-4)"), 2)
    assert found.left_out
    assert np.isnan(found.grade).all()
    assert np.isfinite(found.residual).all()


def test_a_machine_that_cannot_be_costs_itself_alone(two_sized):
    found = scatter(two_sized, vary(*MAY_OVERLAP), 60, seed=5)
    wrong = found.values[:, 1] - found.values[:, 0] < 2.0 * math.asin(0.15)
    assert 0 < wrong.sum() < 30
    np.testing.assert_array_equal(found.ran, ~wrong)
    assert all("weights 1 and 2 overlap" in text for text in found.failure[wrong])
    assert np.isnan(found.residual[wrong]).all()
    assert np.isfinite(found.residual[~wrong]).all()


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("rotor.damping=normal(1,1)", r"normal\(1,1\): draws -\S+, which .*must be 0 or more"),
        ("rotor.mass=uniform(1,1.9e60)", "draws .*, which .*must be 1e\\+60 or less"),
    ],
)
def test_a_distribution_that_draws_what_the_scene_refuses_is_refused_before_the_runs(
    linear, monkeypatch, text, said
):
    monkeypatch.setattr(study, "_machines", None)
    with pytest.raises(UserError, match=said):
        scatter(linear, vary(text), 60, seed=5)


def test_nothing_that_runs_is_an_error(linear, monkeypatch):
    monkeypatch.setattr(study, "refuse_wrong", lambda scene, variations: scene)
    monkeypatch.setattr(study, "refuse_drawn", lambda *_: None)
    with pytest.raises(SimulationError, match=r"no machine could be run: .*must be 0 or more"):
        scatter(linear, vary("rotor.damping=uniform(-2,-1)"), 3)


def test_the_seed_alone_decides(linear, monkeypatch):
    one, two = (scatter(linear, vary("rotor.mass=uniform(1,3)"), 30, seed=4) for _ in range(2))
    assert one.residual.tobytes() == two.residual.tobytes()
    monkeypatch.setattr(study, "CHUNK", 7)
    parts = scatter(linear, vary("rotor.mass=uniform(1,3)"), 30, seed=4)
    assert parts.residual.tobytes() == one.residual.tobytes()
    other = scatter(linear, vary("rotor.mass=uniform(1,3)"), 30, seed=5)
    assert (other.residual != one.residual).all()


def test_values_are_ranked_by_what_they_do_to_the_amplitude(linear):
    """A = U |H(w)| rises with the unbalance; a narrow damping far from resonance does nothing."""
    texts = "rotor.damping=normal(12,0.01)", "rotor.unbalance=normal(0.02,0.002)"
    rows = scatter(linear, vary(*texts), 60).as_json()["importance"]
    assert [row["path"] for row in rows] == ["rotor.unbalance", "rotor.damping"]
    assert rows[0]["rank_correlation"] > 0.99
    assert abs(rows[1]["rank_correlation"]) < 0.5


def test_a_store_that_was_ended_is_continued_to_the_same_machines(
    two_sized, interrupted_once, monkeypatch, tmp_path
):
    monkeypatch.setattr(study, "CHUNK", 10)
    variations = vary(*MAY_OVERLAP)
    ended = tmp_path / "ended.store"
    alone = scatter(two_sized, variations, 31)
    done = interrupted_once(study, "_machines", 2)
    with pytest.raises(KeyboardInterrupt):
        scatter(two_sized, variations, 31, store=ended)
    resumed = scatter(two_sized, variations, 31, store=ended)
    assert len(done) == 4  # two before, two after
    assert resumed.residual.tobytes() == alone.residual.tobytes()
    assert list(resumed.failure) == list(alone.failure)
    with pytest.raises(UserError, match="another seed"):
        scatter(two_sized, variations, 31, seed=2, store=ended)


@pytest.mark.slow
def test_weights_that_are_slow_at_the_end_are_not_all_said_to_be_captured():
    """They start at rest and have turned for five revolutions."""
    changes = {"weights.speeds": [-3.0, -3.0], "run.revolutions": 5}
    said = load_scene("two_balls").replace(changes).scatter(
        ["weights.drag=uniform(0.02,0.03)"], 4
    ).as_json()  # fmt: skip
    assert said["left_behind"] == 4
    assert "or are not yet up to its speed" in " ".join(lines(said))


def test_an_amplitude_of_nothing_is_no_number():
    said = load_scene("two_balls").scatter(["weights.drag=uniform(0.02,0.03)"], 4).as_json()
    nothing = dict.fromkeys(said["residual"], 4.64e-10)
    assert "median below 0.0001, 5 % below 0.0001" in lines({**said, "residual": nothing})[1]


def test_command_writes_picture_table_and_document(invoke, tmp_path, monkeypatch):
    monkeypatch.setattr("os.cpu_count", lambda: 1)
    picture, table, document = (tmp_path / name for name in ("a.png", "a.csv", "a.json"))
    outcome = invoke(
        "scatter", "two_balls", "--set", "weights.weight_radius=0.15",
        "--vary", MAY_OVERLAP[0], "--vary", MAY_OVERLAP[1], "-n", 120, "--seed", 2,
        "-o", picture, "-o", table, "--json", document,
    )  # fmt: skip
    assert outcome.exit_code == 0, outcome.output
    assert picture.read_bytes().startswith(b"\x89PNG")
    said = json.loads(document.read_text())
    with table.open() as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == said["machines"] == 120
    failed = [row for row in rows if row["failure"]]
    assert len(failed) == said["failed"] == sum(one["machines"] for one in said["reasons"]) > 0
    assert len(said["reasons"]) == 1  # they differ in numbers alone
    assert all(row["residual amplitude [m]"] == "" for row in failed)
    within = sum(float(row["grade [mm/s]"] or math.inf) <= 6.3 for row in rows)
    (g63,) = (row for row in said["grades"] if row["grade"] == "G6.3")
    assert g63["share"] == pytest.approx(within / (120 - said["failed"]))  # of those that ran
    first = said["failures"][0]
    assert rows[first["machine"] - 1]["failure"] == first["reason"]
    assert f"of the {120 - said['failed']} machines that ran" in outcome.output
    assert f"machine {first['machine']}, {MAY_OVERLAP[0].partition('=')[0]} = " in outcome.output
    assert g63["low"] < g63["share"] < g63["high"]
    assert "120 machines, seed 2" in outcome.output
    assert "G6.3" in outcome.output


def test_command_refuses_a_file_that_it_does_not_write(invoke):
    outcome = invoke("scatter", "two_balls", "--vary", "weights.drag=uniform(1,2)", "-o", "a.bmp")
    assert outcome.exit_code == 2
    assert ".pdf, .csv" in " ".join(outcome.output.split())
