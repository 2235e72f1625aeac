"""A report is one page: escaped, without a script or a link to anything outside, and complete."""

from __future__ import annotations

import base64
import io
import re
import shlex
from html.parser import HTMLParser
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.image import imread

from autobalancer.harness import Scene, load_scene
from autobalancer.harness.output.plot import as_png
from autobalancer.harness.output.report import Report
from autobalancer.harness.report.parts import Image
from autobalancer.harness.scene.file import tomllib
from tests.browser import chromium

pytestmark = pytest.mark.slow


class Page(HTMLParser):
    """Elements and text of a page."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.text = ""
        self.pre: list[str] = []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))
        if tag == "pre":
            self.pre.append("")

    def handle_data(self, data: str) -> None:
        self.text += data
        if self.pre:
            self.pre[-1] += data

    def all(self, tag: str) -> list[dict[str, str | None]]:
        return [attributes for name, attributes in self.elements if name == tag]


def assert_whole(page: Page, pictures: list[Path]) -> None:
    assert not {"script", "link", "iframe", "object"} & {tag for tag, _ in page.elements}
    assert not [a for _, a in page.elements if {"href", "onload", "onerror"} & set(a)]
    sources = [str(image["src"]) for image in page.all("img")]
    shown = [base64.b64decode(src.removeprefix("data:image/png;base64,")) for src in sources]
    assert shown == [picture.read_bytes() for picture in pictures]


@pytest.fixture
def evil(tmp_path):
    """The bundled scene whose check is quickest, under a title that is a script."""
    lines = load_scene("liquid_touch").path.read_text(encoding="utf-8").splitlines()
    lines[0] = 'title = \'<script>alert("1")</script> & "\''
    path = tmp_path / "<b>evil.toml"
    path.write_text("\n".join(lines), encoding="utf-8")
    return path


def test_report_of_a_check_is_whole_and_takes_titles_for_text(invoke, evil, tmp_path):
    directory = tmp_path / "the report"
    outcome = invoke("check", evil, "--report", directory)
    assert outcome.exit_code == 0, outcome.output
    page = Page(directory / "report.html")
    (picture,) = directory.glob("*.png")
    assert_whole(page, [picture])
    assert not page.all("b")
    assert '<script>alert("1")</script> & "' in page.text
    assert "All 9 rows hold." in page.text
    command = shlex.join(["autobalancer", "check", str(evil), "--report", str(directory)])
    assert page.pre[0].startswith(command)  # nothing to install: no package index has this version
    assert evil.read_text(encoding="utf-8").strip() in page.pre[1].split("Sources")[0]
    assert f"With autobalancer {version('autobalancer')} on " in page.text
    assert page.text.index("Dubovik 2006 (11)") < page.text.index("Dubovik, V. A., Pashkov")


def test_a_changed_scene_is_written_as_it_was_run():
    scene = load_scene("two_balls").replace({"rotor.unbalance": 0.02})
    assert tomllib.loads(scene.toml) == scene.document
    assert Scene.from_document(tomllib.loads(scene.toml)).rotor.unbalance == 0.02
    assert "# kg" in load_scene("two_balls").toml  # comments stay


@pytest.mark.parametrize(
    ("arguments", "words", "source"),
    [
        (("balance", "balancing_machine"), "Grade met after 2 cycles", "Polushkin, O. A."),
        (
            ("map", "two_balls", "--x", "speed=2:4:3", "--y", "weights.drag=0.01:0.1:3"),
            "9 points:", "Filimonikhina, I.",
        ),
        (
            ("scatter", "two_balls", "--vary", "weights.drag=normal(0.0125,0.001)", "-n", "20"),
            "machines", "ISO",
        ),
        (
            ("design", "finite_weights", "--starts", "6", "--most", "3"),
            "diameter mm", "Goncharov, V.",
        ),
    ],
    ids=["balance", "map", "scatter", "design"],
)  # fmt: skip
def test_every_command_with_findings_writes_a_report(invoke, tmp_path, arguments, words, source):
    outcome = invoke(*arguments, "--report", tmp_path / "r")
    assert outcome.exit_code == 0, outcome.output
    page = Page(tmp_path / "r" / "report.html")
    assert_whole(page, list((tmp_path / "r").glob("*.png")))
    assert len(page.all("img")) == 1
    assert words in page.text
    assert source in page.text
    assert f"autobalancer {arguments[0]} {arguments[1]} " in page.pre[0]
    assert "numpy" in page.text
    assert load_scene(arguments[1]).heading in page.text
    assert not Path("map.png").exists()


def test_what_does_not_hold_is_marked(invoke, tmp_path):
    scene = tmp_path / "heavy.toml"
    text = load_scene("liquid_heavy_force").toml
    scene.write_text(text.replace("[run]", '[coupling]\nscheme = "jacobi"\n\n[run]'))
    outcome = invoke("check", scene, "--report", tmp_path / "r")
    assert outcome.exit_code == 1
    page = (tmp_path / "r" / "report.html").read_text(encoding="utf-8")
    assert re.search(r'class="bad short"[^>]*>NO</td>', page)


def test_a_report_that_cannot_be_written_is_refused_before_the_work(invoke, monkeypatch):
    monkeypatch.setattr("autobalancer.harness.balancing.cycles.balance", None)
    outcome = invoke("balance", "balancing_machine", "--report", "/dev/null/x")
    assert outcome.exit_code == 2
    assert "cannot be made a directory" in outcome.output


def test_a_folder_that_takes_no_files_is_refused_by_its_own_name(invoke, monkeypatch):
    monkeypatch.setattr("autobalancer.harness.balancing.cycles.balance", None)
    outcome = invoke("balance", "balancing_machine", "--report", "/proc")
    assert outcome.exit_code == 2
    assert "/proc: takes no files" in outcome.output


def test_pictures_are_as_dark_as_the_page_where_the_reader_wants_it_dark(tmp_path):
    browser = chromium(tmp_path / "chromium")
    if browser is None:
        pytest.skip("no chromium with chromedriver: pages are not run")
    figure = Figure(figsize=(2.0, 1.0), facecolor="white")
    figure.text(0.0, 0.0, " ")
    report = Report(None, "pictures", [])
    report.parts.append(Image(as_png(figure), "nothing"))
    path = tmp_path / "page.html"
    path.write_text(report.page(), encoding="utf-8")
    try:
        for mode, ground in (("light", 255), ("dark", 22)):
            wanted = [{"name": "prefers-color-scheme", "value": mode}]
            browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": wanted})
            browser.get(path.as_uri())
            (image,) = browser.find_elements("tag name", "img")
            pixels = 255.0 * imread(io.BytesIO(image.screenshot_as_png))[5:-5, 5:-5, :3]
            assert np.abs(pixels - ground).max() < 6.0
    finally:
        browser.quit()
