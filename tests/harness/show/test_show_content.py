"""What a page is given, and the command that writes it."""

import json
import math

import pytest

from autobalancer.harness import load_scene
from autobalancer.harness.show import page as show_page
from autobalancer.harness.show.content import content
from autobalancer.harness.show.window import window
from autobalancer.harness.stability.main_motion import MainMotion
from autobalancer.models.papers.window import LiquidWindow

pytestmark = pytest.mark.slow


def test_within_each_part_of_the_strip_the_coupled_units_do_what_it_says():
    scene = load_scene("two_balls")
    found = window(scene)
    assert found.kinds == ("unstable", "good", "unstable")
    with MainMotion(scene) as motion:
        for low, high, kind in zip((0.5, *found.ends), found.ends, found.kinds, strict=False):
            assert (motion.growth(0.5 * (low + high)) < 0.0) == (kind == "good")


def test_the_strip_shows_the_window_of_dubovik():
    scene = load_scene("liquid_disc")
    theory = LiquidWindow.of(scene.assembly())
    found = window(scene)
    assert found.kinds == ("poor", "good", "unstable")
    assert found.ends[:2] == (theory.lower, theory.upper)


def test_an_empty_window_is_nowhere_good():
    found = window(load_scene("liquid_closed"))
    assert found.kinds == ("poor", "unstable", "unstable")


def test_without_an_answer_the_strip_says_why():
    found = window(load_scene("contact_order"))
    assert found.ends == ()
    assert "at most 98.8 g m" in found.words


@pytest.mark.parametrize(
    ("name", "heavy"),
    [("two_balls", 0.0), ("drum", 0.4), ("grinder", 1.0), ("three_mass_shaft", None)],
)
def test_the_heavy_side_is_that_of_the_one_unbalance(name, heavy):
    found = content(load_scene(name))
    assert found["heavy"] == (None if heavy is None else pytest.approx(heavy))


def test_the_slider_offers_as_many_weights_as_fit():
    counts = [each["weights"] for each in content(load_scene("goncharov_balls"))["tokens"]]
    # Goncharov 2017: radius 45.5 mm on 79.5 mm, of which five touch
    assert counts == [[3], [1], [2], [4], [5]]


def test_no_marks_of_a_terminal_come_to_the_page():
    said = content(load_scene("drum"))["left_behind"]
    assert "How often: autobalancer motions" in said


def test_tracks_that_differ_have_every_pair_of_numbers():
    scene = load_scene("three_mass_shaft").replace({"left.count": 12, "left.angles": None})
    counts = [tuple(each["weights"]) for each in content(scene)["tokens"]]
    assert counts[0] == (12, 2)
    assert sorted(counts) == [(a, b) for a in (*range(1, 9), 12) for b in range(1, 9)]


def test_no_text_ends_the_data_early(monkeypatch):
    words = "</script><!-- {{UNITS}}"
    monkeypatch.setattr(show_page, "content", lambda scene: {"words": words})
    text = show_page.page(load_scene("two_balls"))
    data = text.split('id="data">')[1].split("</script>")[0]
    assert json.loads(data) == {"words": words}


def test_the_command_writes_a_page_without_an_address_in_it(invoke, tmp_path):
    path = tmp_path / "page.html"
    outcome = invoke("show", "two_balls", "-o", path, "--set", "weights.drag=0.02")
    assert outcome.exit_code == 0, outcome.output
    text = path.read_text(encoding="utf-8")
    assert "http://" not in text
    assert "https://" not in text
    assert '"weights.drag": 0.02' in text


def test_a_scene_that_one_file_cannot_couple_is_refused(invoke, tmp_path):
    path = tmp_path / "page.html"
    outcome = invoke("show", "two_balls", "-o", path, "--set", "coupling.units=python")
    assert outcome.exit_code == 2
    assert "coupling.units" in outcome.output
    assert not path.exists()


def test_every_weight_has_its_own_radius():
    radii = [0.015, 0.012, 0.015, 0.015, 0.015, 0.015]
    scene = load_scene("washing_machine").replace({"balls.weight_radius": radii})
    assert content(scene)["balancers"][0]["radii"] == radii


def test_a_race_with_lobes_is_drawn_with_them():
    found = content(load_scene("oval_fan"))["balancers"]
    assert [len(one["race"]) for one in found] == [1, 2]
    assert found[1]["race"][1] == {"lobes": 3, "amplitude": 1e-6, "angle": math.radians(15.0)}


def test_the_body_around_a_planar_rotor_is_drawn_where_it_moves():
    shown = content(load_scene("washing_machine_stops"))
    assert shown["tub"] == {"name": "tub", "point": 1, "feet": True}
    assert content(load_scene("drum"))["tub"] is None
    assert content(load_scene("rubber_drive"))["tub"] is None  # seen from the side, as a bar
