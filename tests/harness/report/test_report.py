"""The page about a machine: verdict first, self-contained, and true of what was run."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import pytest

import autobalancer as ab
from autobalancer.harness.errors import UserError
from autobalancer.harness.report.drawing import machine_drawing

SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    written = ab.load("two_balls").report(folder / "page.html", limit="4.5 mm/s", run_up="60 s")
    return written, written.path.read_text(encoding="utf-8")


def test_page_asks_no_network_for_anything(page):
    _, text = page
    assert not re.search(r'(?:src|href)="(?!data:)', text)
    assert "<script" not in text


def test_verdicts_stand_before_every_section(page):
    written, text = page
    places = [text.index(part[:30]) for part in written.verdicts]
    assert max(places) < text.index("<h2>")


def test_page_repeats_the_command_and_holds_the_scene(page):
    _, text = page
    assert "How to do it again" in text
    assert "[rotor]" in text


def test_run_up_of_the_page_is_that_of_an_independent_run(page):
    written, _ = page
    turning = {"weights.speeds": [0.0, 0.0], "operation.speed": None, "run.record": None}
    scene = ab.load("two_balls")
    speed = scene.profile().end
    corners = [[0.0, 0.0], [60.0, speed], [60.0 + 400.0 * 3.141592653589793 / speed, speed]]
    there = scene.replace({**turning, "operation.profile": corners, "run.revolutions": None})
    peak = max(abs(there.run()["rotor.x"] + 1j * there.run()["rotor.y"]))
    said = re.search(r"on the way there at most ([\d.]+) mm", written.verdicts[0])
    assert said is not None
    assert float(said[1]) == pytest.approx(1e3 * peak, rel=0.05)


@pytest.mark.parametrize("name", ab.bundled_scenes())
def test_drawing_shows_every_weight_and_support(name):
    scene = ab.load(name)
    root = ElementTree.fromstring(machine_drawing(scene))
    classes = [shape.get("class") for shape in root.iter()]
    assert classes.count("weight") == sum(getattr(b, "count", 0) for b in scene.balancer)
    words = [text.text for text in root.iter(f"{SVG}text")]
    assert {b.label for b in scene.balancer} <= set(words)


@pytest.mark.parametrize("given", [{"run_up": "0 s"}, {"limit": -1.0}, {"run_up": "4 kg"}])
def test_wrong_values_are_refused_by_name(given, tmp_path):
    with pytest.raises(UserError, match=next(iter(given))):
        ab.load("two_balls").report(tmp_path / "page.html", **given)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["liquid_closed", "sommerfeld"])
def test_liquid_and_motor_have_a_page(name, tmp_path):
    written = ab.load(name).report(tmp_path / "page.html")
    assert written.path.stat().st_size > 10_000
