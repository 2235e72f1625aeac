"""Pages of scenes in a headless Chromium."""

from functools import cache

import pytest

from autobalancer.harness import load_scene
from autobalancer.harness.show.page import page
from tests.browser import Opened, chromium


@pytest.fixture(scope="session")
def browser(tmp_path_factory):
    """The browser, through its driver; skips where there is none."""
    found = chromium(tmp_path_factory.mktemp("chromium"))
    if found is None:
        pytest.skip("no chromium with chromedriver: pages are not run")
    yield found
    found.quit()


@pytest.fixture
def phone(browser):
    """Give the page as much room as a phone has, in pixels, until the test ends."""

    def held(width: int, height: int) -> None:
        of = {"width": width, "height": height, "deviceScaleFactor": 2, "mobile": True}
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", of)

    yield held
    browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


@cache
def bundled_page(name: str) -> str:
    """Page of a bundled scene."""
    return page(load_scene(name))


@pytest.fixture
def opened(browser, tmp_path):
    """Open the page of a scene, or of a bundled one by its name; paused unless it is to run."""

    def load(scene, running: bool = False) -> Opened:
        path = tmp_path / "scene.html"
        text = bundled_page(scene) if isinstance(scene, str) else page(scene)
        path.write_text(text, encoding="utf-8")
        found = Opened(browser, path)
        if not running:
            found("page.view.running = false; machine.restart()")
        return found

    yield load
    assert browser.get_log("browser") == []
    browser.get("about:blank")  # a page goes on drawing, beside all tests to come
