"""How smoothly the pages of scenes run in headless Chromium on this machine.

python -m tests.frames [SCENE...]
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from autobalancer.harness import load_scene
from autobalancer.harness.output.machine import machine
from autobalancer.harness.output.table import Sheet
from autobalancer.harness.show.page import page
from tests.browser import Opened, chromium
from tests.scenes import driven_scenes

COLUMNS = ("scene", "frames a second", "page's own work a frame", "reserve at real time", "size")
BEGINS, COUNTED = 120, 300  # frames: until the compiled code is warm, and those measured
COUNT = """
const [first, began, task] = [page.frames, performance.now(), arguments[1]];
const wait = () => page.frames - first < arguments[0] ? setTimeout(wait, 1)
  : task((page.frames - first) / (performance.now() - began));
wait();
"""


def row(browser, name: str, folder: Path) -> list[str]:
    """Of a scene's page, running as it opens."""
    path = folder / f"{name}.html"
    path.write_text(page(load_scene(name)), encoding="utf-8")
    shown = Opened(browser, path)

    def frames(count: int) -> float:
        known = "const page = window.autobalancer;"
        return 1e3 * browser.execute_async_script(known + COUNT, count)

    def worked() -> float:
        found = browser.execute_cdp_cmd("Performance.getMetrics", {})["metrics"]
        return next(each["value"] for each in found if each["name"] == "TaskDuration")

    frames(BEGINS)
    before = worked()
    rate = frames(COUNTED)
    work = 1e3 * (worked() - before) / COUNTED
    reserve = 1e3 / 60.0 / shown("return page.measured(600)")
    size = path.stat().st_size
    return [name, f"{rate:.1f}", f"{work:.2f} ms", f"{reserve:.0f} times", f"{size / 1e3:.0f} kB"]


def main() -> None:
    """Print the table."""
    with tempfile.TemporaryDirectory(prefix="autobalancer-") as name:
        folder = Path(name)
        browser = chromium(folder / "browser")
        if browser is None:
            raise SystemExit("no chromium with chromedriver on this machine")
        try:
            browser.execute_cdp_cmd("Performance.enable", {})
            rows = [row(browser, each, folder) for each in sys.argv[1:] or driven_scenes()]
        finally:
            browser.quit()
    print(f"{Sheet(COLUMNS, rows, 'lrrrr').markdown()}\n\n{machine()}")


if __name__ == "__main__":
    main()
