"""The truth study: its scenes are valid and reproducible, its verdicts say what is so."""

import math
from dataclasses import replace

import numpy as np
import pytest
import typer

from autobalancer.harness import Scene, load_scene
from autobalancer.models.stability import growth_rates
from tests.studies.truth.__main__ import command, counts
from tests.studies.truth.draw import FAMILIES, draw
from tests.studies.truth.judge import Verdict, classify, deviations, growth, judge
from tests.studies.truth.study import misses, table, verdicts

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("family", FAMILIES)
def test_drawn_scenes_are_valid_and_come_again(family):
    for number in range(40):
        scene = Scene.from_document(draw(family, 7, number))
        assert draw(family, 7, number) == draw(family, 7, number)
        assert scene.revolutions > 0.0
    assert draw(family, 7, 0) != draw(family, 8, 0)


@pytest.mark.parametrize(
    ("error", "stated", "words", "tolerance", "outcome"),
    [
        (0.009, 0.0, "", None, "right"),
        (2e-4, 0.0, "", 1e-4, "right"),
        (4e-4, 0.0, "", 1e-4, "silent"),
        (0.2, 0.1, "errs", None, "honest"),
        (0.4, 0.1, "errs", None, "understated"),
        (0.2, 0.0, "a note", None, "note"),
        (0.04, 0.0, "", None, "silent"),
        (0.06, 0.0, "", None, "gross"),
        (float("nan"), 0.0, "", None, "gross"),
    ],
)
def test_a_verdict_follows_from_error_and_words(error, stated, words, tolerance, outcome):
    verdict = Verdict("planar", 0, "", error, "rotor.x", stated, words)
    assert classify(verdict, tolerance) == outcome


def test_a_disturbance_grows_at_the_rate_of_the_linearised_motion():
    """From the balanced position where it is unstable (Filimonikhina 2017, weights at 120 deg)."""
    balanced = [2.0 * math.pi / 3.0, 4.0 * math.pi / 3.0]
    scene = load_scene("two_balls").replace({"weights.angles": balanced, "operation.speed": 6.0})
    rate = float(growth_rates(scene.assembly(), [6.0])[0])
    assert rate > 0.0
    early, late = (growth(scene, np.linspace(0.0, end, 90)) for end in (40.0, 40.0 + 3.0 / rate))
    assert math.log(late / early) == pytest.approx(3.0, rel=0.05)  # the mode turns


@pytest.mark.parametrize("separate", [True, False])
def test_an_altered_motion_is_found_out(monkeypatch, separate):
    """A run whose rotor moves ten times as far is gross, and nothing else is."""
    from tests.studies.truth import judge as module

    honest = judge("planar", 3, 4, separate=separate)
    assert honest.outcome == "right"
    run = module.cosimulate

    def altered(scene, **options):
        assert options["separate"] is separate
        result = run(scene, **options)
        result.signals["rotor.x"][:] *= 10.0
        return result

    monkeypatch.setattr(module, "cosimulate", altered)
    assert judge("planar", 3, 4, separate=separate).outcome == "gross"


def test_a_run_that_is_more_exact_than_the_first_reference_is_right():
    """Undamped supports gather 9e-6 of error at a relative tolerance of 1e-10."""
    verdict = judge("heavy", 910604, 2, {"coupling.tolerance": 1e-7})
    assert verdict.outcome == "right"
    assert verdict.error < 1e-6


def test_errors_are_relative_to_the_largest_of_their_kind(cosim):
    result = cosim("two_balls", **{"run.revolutions": 2})
    right = {name: result[name].copy() for name in ("rotor.x", "rotor.y")}
    largest = max(np.abs(values).max() for values in right.values())
    result.signals["rotor.y"][-1] += 0.01 * largest
    errors = deviations(result, right)
    assert errors["rotor.x"] == 0.0
    assert errors["rotor.y"] == pytest.approx(0.01, rel=1e-6)


def test_counts_are_given_by_name():
    assert counts(["planar=30", "heavy=5"]) == {"planar": 30, "heavy": 5}
    assert set(counts(None)) == set(FAMILIES)
    with pytest.raises(typer.BadParameter, match="NAME=N"):
        counts(["planar=some"])


def test_the_table_has_the_share_of_runs_that_estimate_their_errors_rightly():
    found = [
        Verdict("planar", 0, "right", 0.0, within=True),
        Verdict("planar", 1, "right", 0.0, within=False),
        Verdict("planar", 2, "chaotic", 0.5, within=False),
        Verdict("heavy", 0, "refused"),
    ]
    sheet = table(found)
    shown = {row[0]: dict(zip(sheet.columns, row, strict=True)) for row in sheet.rows}
    assert shown["planar"]["estimated rightly"] == "50.0"
    assert shown["planar"]["scenes"] == "2"
    assert shown["planar"]["set aside"] == "1"
    assert shown["heavy"]["estimated rightly"] == "-"
    assert shown["all"]["refused"] == "33.3"


def test_an_error_estimated_too_small_is_found_out(monkeypatch):
    from tests.studies.truth import judge as module

    run = module.cosimulate
    for factor in (1.0, 1e-3):

        def altered(scene, factor=factor, **options):
            result = run(scene, **options)
            return replace(result, estimated_error=factor * result.estimated_error)

        monkeypatch.setattr(module, "cosimulate", altered)
        found = judge("planar", 3, 4, {"coupling.tolerance": 1e-1})
        assert found.error > 1e-6
        assert found.within is (factor == 1.0)


def test_a_sample_is_right_or_says_so():
    longest = {"flexible", "tilting", "bearings", "finite", "impacts", "sticking"}
    families = FAMILIES.keys() - longest
    found = verdicts({**dict.fromkeys(sorted(families), 1), "planar": 2}, seed=14)
    assert not misses(found)
    assert "| all | " in table(found).markdown()


def test_the_command_writes_the_table(tmp_path):
    made = tmp_path / "table.md"
    command(["planar=1"], seed=14, markdown=made)
    assert "| planar | 1 | 100.0 |" in made.read_text()
