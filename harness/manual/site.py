"""The pages of the manual in one folder, and MkDocs over them."""

from __future__ import annotations

import logging
import re
import shutil
from collections.abc import Callable, Iterable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from ..errors import UserError
from ..output.terminal import ready_to_fill
from ..scene import bundled_scenes
from . import scene_page

MANUAL = Path(__file__).parent
ROOT = MANUAL.parents[1]
PROJECT = MANUAL / "project"  # where a wheel has the files at the top of a checkout
TOP = {"README.md": "index.md", "CONTRIBUTING.md": "contributing.md"}
TOP |= {"CHANGELOG.md": "changelog.md", "LICENSE": "licence.md", "CITATION.cff": "citation.md"}
TITLE = re.compile(r"<title>[^<]*autobalancer")  # of the first page
NAMED_BLOCK = re.compile(r"^```(\w+) ([^\s=]+)$", re.MULTILINE)
# what the search ranks higher, or lower
BOOSTS = {"scene.md": 8, "messages.md": 2, "python.md": 0.5}
PARTS = ("tutorials", "how-to", "reference", "explanation", "results", "scenes")


def write_pages(folder: Path) -> None:
    """Write every page as Markdown into a folder, without the live scenes."""
    ignored = shutil.ignore_patterns("*.py", "*.yml", "__pycache__", PROJECT.name)
    shutil.copytree(MANUAL, folder, ignore=ignored)
    made = {}
    top = ROOT if (ROOT / "CONTRIBUTING.md").is_file() else PROJECT
    for source, name in TOP.items():
        text = (top / source).read_text(encoding="utf-8").replace("](harness/manual/", "](")
        for other, its in TOP.items():
            text = text.replace(f"]({other}", f"]({its}")
        made[name] = (
            text if source.endswith(".md") else f"# {name[:-3].title()}\n\n```text\n{text}```\n"
        )
    made |= {f"scenes/{name}.md": scene_page.page(name) for name in bundled_scenes()}
    for name, text in made.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    for name, boost in BOOSTS.items():
        page = folder / "reference" / name
        head = f"---\nsearch:\n  boost: {boost}\n---\n\n"
        page.write_text(head + page.read_text(encoding="utf-8"), encoding="utf-8")
    for path in folder.rglob("*.md"):  # blocks with a name, which the tests run
        text = NAMED_BLOCK.sub(_titled, path.read_text(encoding="utf-8"))
        path.write_text(text, encoding="utf-8")


def _titled(match: re.Match[str]) -> str:
    """The head of a named block; files have their name as a title."""
    kind, name = match.groups()
    return f"```{kind}" if kind in ("sh", "text") else f'```{kind} title="{name}"'


def write_site(output: Path, track: Callable[..., Iterable[Any]], live: bool = True) -> None:
    """Write the site into a folder, which is made anew.

    Raises:
        UserError: MkDocs is not installed, or the folder holds something else or cannot be made.
    """
    ready_to_fill(output)
    if any(output.glob("*")) and not _holds_site(output):
        raise UserError(
            f"{output}: is not empty and holds no site of this manual, and everything in it would "
            "be removed: name another folder"
        )
    try:
        from mkdocs.commands.build import build
        from mkdocs.config import load_config
    except ImportError as error:
        raise UserError("manual: requires MkDocs: pip install 'autobalancer[docs]'") from error
    logging.getLogger("mkdocs").setLevel(logging.WARNING)
    with TemporaryDirectory() as scratch:
        pages = Path(scratch) / "pages"
        write_pages(pages)
        (pages / "live").mkdir()
        for name in track(bundled_scenes() if live else (), description="live scenes"):
            scene_page.live(name, pages / "live" / f"{name}.html")
        settings: dict[str, Any] = {
            "docs_dir": str(pages),
            "site_dir": str(output.resolve()),
            "nav": _nav(pages),
        }
        build(load_config(shutil.copy(MANUAL / "mkdocs.yml", scratch), strict=live, **settings))
    scripts = output / "assets" / "javascripts"
    shutil.rmtree(scripts / "lunr")  # other languages than English
    for source_map in (output / "assets").rglob("*.map"):
        source_map.unlink()


def _holds_site(folder: Path) -> bool:
    """Whether a folder holds a site that `write_site` wrote: no other one is made anew."""
    index = folder / "index.html"
    its_own = (folder / "search" / "search_index.json").is_file() and index.is_file()
    return its_own and bool(TITLE.search(index.read_text(encoding="utf-8", errors="replace")))


def _nav(pages: Path) -> list[dict[str, Any]]:
    """Pages by their folders, alphabetically; tables of results stand apart."""
    nav: list[dict[str, Any]] = [{"Start": ["index.md", "gallery.md", "glossary.md"]}]
    for part in PARTS:
        found = sorted(path.relative_to(pages).as_posix() for path in (pages / part).glob("*.md"))
        tables = sorted(each.relative_to(pages).as_posix() for each in pages.glob(f"{part}/*/*.md"))
        nav.append({part.capitalize(): [*found, *([{"Tables": tables}] if tables else [])]})
    return [*nav, {"Project": [name for name in TOP.values() if name != "index.md"]}]
