"""A headless Chromium, and a page of a scene in it."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--window-size=1280,1000",
)  # fmt: skip


def chromium(folder: Path) -> Any:
    """The browser by its driver, its files in a folder; None where there is none."""
    binary, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if not (binary and driver):
        return None
    from selenium import webdriver

    options = webdriver.ChromeOptions()
    options.binary_location = binary
    for flag in (*FLAGS, f"--user-data-dir={folder}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(options=options, service=webdriver.ChromeService(driver))


class Opened:
    """A page in the browser, its motion held; it must not have logged anything."""

    def __init__(self, browser, path: Path):
        self.browser, self.path = browser, path
        browser.get(path.as_uri())
        self.wait("return Boolean(window.autobalancer)")

    def wait(self, script: str):
        """What a script gives as soon as that is true."""
        from selenium.webdriver.support.ui import WebDriverWait

        return WebDriverWait(self.browser, 60).until(lambda _: self(script))

    def __call__(self, script: str, *arguments):
        """What a script gives; `page` and `machine` are its own."""
        known = "const page = window.autobalancer, machine = page?.machine;"
        return self.browser.execute_script(known + script, *arguments)

    def slide(self, name: str, part: float) -> None:
        """Move a slider to a part of its way, as a finger would."""
        self(
            "const { input } = page.sliders[arguments[0]];"
            "input.value = Number(input.min) + arguments[1] * (input.max - input.min);"
            "input.dispatchEvent(new Event('input'))",
            name,
            part,
        )

    def said(self, name: str) -> str:
        """What a slider says."""
        return self("return page.sliders[arguments[0]].output.value", name)

    def value(self, variable: str) -> float:
        """Of a variable of the units."""
        return self("return machine.units.value(arguments[0])", variable)

    def refusal(self) -> str:
        """What is shown as refused; empty where nothing is."""
        return self("return document.getElementById('refusal').textContent")

    def press(self, key: str) -> None:
        """A key, with nothing in focus."""
        self(
            "document.activeElement.blur();"
            "document.body.dispatchEvent("
            "new KeyboardEvent('keydown', { key: arguments[0], bubbles: true }))",
            key,
        )
