"""The site of the manual: complete, without a network, and found by its search."""

import json
import re
import shutil
import subprocess

import pytest
from typer.main import get_command

from autobalancer.harness import bundled_scenes, load_scene
from autobalancer.harness.__main__ import program
from autobalancer.harness.manual import site
from tests.browser import Opened, chromium

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    pytest.importorskip("material", reason="mkdocs-material is not installed")
    folder = tmp_path_factory.mktemp("manual") / "site"
    page = load_scene("two_balls").show(folder.with_name("page.html")).path
    with pytest.MonkeyPatch.context() as patch:  # one scene stands for all
        patch.setattr(site.scene_page, "live", lambda _, path: shutil.copy(page, path))
        site.write_site(folder, lambda names, description: names)
    assert site._holds_site(folder)  # it can be made anew
    return folder


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    found = chromium(tmp_path_factory.mktemp("chromium"))
    if found is None:
        pytest.skip("no chromium with chromedriver: pages are not opened")
    yield found
    found.quit()


def search(folder, *words):
    """Places of the site with all words: what its search has to offer."""
    index = json.loads((folder / "search" / "search_index.json").read_text(encoding="utf-8"))
    text = [
        (each["location"], re.sub("<.*?>", "", f"{each['title']} {each['text']}"))
        for each in index["docs"]
    ]
    return {place for place, said in text if all(word in said for word in words)}


@pytest.mark.parametrize(
    ("words", "place"),
    [
        (("rolling_resistance", "Resistance over load"), "reference/scene.html"),
        (("weights overlap by",), "reference/messages.html"),
        (("steps too long",), "how-to/faq.html"),
        (("Goncharov 2017", "Fig. 7", "design goncharov_balls"), "results/papers.html"),
    ],
)
def test_search_finds(built, words, place):
    assert any(found.startswith(place) for found in search(built, *words))


@pytest.mark.parametrize(
    ("query", "first"),
    [
        ("support_damping", "reference/scene.html"),
        (
            "/tmp/my.toml: balancer[1].weight_radius = 0.03 m: 30 weights do not fit on a track of "
            "radius 0.2 m: must be at most 0.0209057 m",
            "how-to/faq.html",
        ),
        ("not done within --at-most; 37 % of running my_drum", "how-to/faq.html"),
        ("mill: design: its weights have no size: give --race", "reference/messages.html"),
        ("Goncharov Fig. 7", "results/papers.html"),
    ],
)
def test_search_answers_a_newcomer_first(built, browser, query, first):
    from selenium.webdriver.common.by import By
    from selenium.webdriver.support.ui import WebDriverWait

    browser.get((built / "index.html").as_uri())
    box = browser.find_element(By.CSS_SELECTOR, "input.md-search__input")
    box.click()
    box.send_keys(query)
    hits = WebDriverWait(browser, 30).until(
        lambda found: found.find_elements(By.CSS_SELECTOR, "a.md-search-result__link")
    )
    assert f"/{first}" in hits[0].get_attribute("href")


def test_every_scene_runs_in_its_page(built):
    for name in bundled_scenes():
        assert f"../live/{name}.html" in (built / "scenes" / f"{name}.html").read_text("utf-8")
        assert "WebAssembly" in (built / "live" / f"{name}.html").read_text("utf-8")


def test_live_pages_share_their_units_and_run_as_files(browser, tmp_path):
    for name in ("two_balls", "liquid_disc"):
        site.scene_page.live(name, tmp_path / f"{name}.html")
    assert {path.name for path in tmp_path.glob("*.js")} == {"units.js"}
    for name in ("two_balls", "liquid_disc"):
        page = tmp_path / f"{name}.html"
        assert page.stat().st_size < 30_000
        Opened(browser, page).wait("return machine.units.value('coupling.steps') > 0")
        assert browser.get_log("browser") == []


def test_nothing_is_loaded_from_a_network(built):
    for path in (*built.rglob("*.html"), *built.rglob("*.css")):
        text = path.read_text(encoding="utf-8")
        loaded = re.findall(
            r"<(?:script|img|iframe|link)\b[^>]*(?:src|href)=\"?(https?:[^\" >]*)", text
        )
        assert loaded == [], path
        assert not re.findall(r"(?:@import|url\()\s*[\"']?https?:", text), path


def test_reference_has_every_command_with_its_options(built):
    text = (built / "reference" / "commands.html").read_text(encoding="utf-8")
    for name, command in get_command(program()).commands.items():
        section = text.split(f'id="{name}"')[1].split("<h2")[0]
        options = [p.opts[0] for p in command.params if p.opts[0][0] == "-" and not p.hidden]
        assert [option for option in options if option not in section] == []


PAGES_IN = """
import sys
from pathlib import Path
from autobalancer.harness.manual.site import write_pages
write_pages(Path(sys.argv[1]))
"""


def test_a_wheel_has_all_pages_and_pictures(installed, tmp_path):
    site.write_pages(tmp_path / "here")
    subprocess.run([installed, "-c", PAGES_IN, tmp_path / "there"], check=True, cwd=tmp_path)
    here, there = (
        {path.relative_to(tmp_path / name): path.read_bytes() for path in found if path.is_file()}
        for name in ("here", "there")
        for found in [(tmp_path / name).rglob("*")]
    )
    assert there.keys() == here.keys()
    assert [name for name, content in here.items() if there[name] != content] == []


def test_without_the_extra_one_reason_is_given(installed, tmp_path):
    command = [installed, "-m", "autobalancer.harness", "manual", "-o", "site"]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, check=False)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "manual: requires MkDocs: pip install 'autobalancer[docs]'\n"
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["thesis.tex", "index.html"])
def test_a_folder_with_something_else_is_refused(tmp_path, name):
    """Also one with the first page of another site: MkDocs would remove all of it."""
    (tmp_path / name).write_text("<title>My thesis</title>")
    with pytest.raises(site.UserError, match=r"holds no site of this manual.*name another folder"):
        site.write_site(tmp_path, lambda names, description: names)
    assert (tmp_path / name).is_file()


def test_a_place_that_takes_no_folder_is_refused_before_the_work(tmp_path):
    (tmp_path / "site").write_text("")
    with pytest.raises(site.UserError, match="cannot be made a directory"):
        site.write_site(tmp_path / "site", lambda names, description: pytest.fail("worked"))
