"""What the pages for readers show is what happens: files, commands and their output, as printed.

In a page a fenced block with a file name (```python settle.py) is that file; a script runs, a test
passes.  A ```sh block with a name is run, and a ```text block of a script's or command's name is
what it prints; `...` stands for lines left out.
"""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from typer.main import get_command

from autobalancer.harness import bundled_scenes, load_scene
from autobalancer.harness.__main__ import program

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parent.parent
HARNESS = ROOT / "harness"
PAGES = [ROOT / "README.md", *sorted(HARNESS.glob("tutorial_*.md"))]
GALLERY = (HARNESS / "gallery.md").read_text(encoding="utf-8")
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[+-]?\d+)?")
COMMANDS = {
    "autobalancer": ["-m", "autobalancer.harness"],
    "pytest": ["-m", "pytest", "-p", "no:cacheprovider"],
}


def blocks(page: Path) -> list[tuple[str, str, str]]:
    """Kind, name and text of a page's named blocks."""
    text = page.read_text(encoding="utf-8")
    return re.findall(r"^```(\w+) (\S+)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def run(folder: Path, *arguments: str) -> str:
    """What Python with these arguments prints, in a folder away from this checkout."""
    done = subprocess.run(
        [sys.executable, *arguments],
        cwd=folder,
        env={**os.environ, "PYTHONIOENCODING": "utf-8"},
        capture_output=True,
        encoding="utf-8",
        timeout=120,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def assert_printed(shown: str, printed: str, relative: float) -> None:
    """Every line shown is printed, in this order; without `...` nothing else is."""
    lines, waiting = shown.splitlines(), iter(printed.splitlines())
    assert "..." in lines or len(lines) == len(printed.splitlines()), printed
    for line in (line for line in lines if line != "..."):
        words = NUMBER.sub("#", line)
        found = next((p for p in waiting if NUMBER.sub("#", p) == words), None)
        assert found is not None, f"not printed: {line}\n{printed}"
        pair = ([float(n) for n in NUMBER.findall(text)] for text in (found, line))
        # the last printed digit may round the other way on another machine
        np.testing.assert_allclose(*pair, rtol=relative, atol=1.01e-4, err_msg=line)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_page_does_what_it_shows(page, tmp_path):
    if page.stem == "tutorial_pytest":  # its scene is another page's
        files = {name: text for _, name, text in blocks(HARNESS / "tutorial_tool.md")}
        (tmp_path / "washer.toml").write_text(files["washer.toml"], encoding="utf-8")
    printed, relative = {}, {}
    commands = " ".join(text for kind, _, text in blocks(page) if kind == "sh")
    for kind, name, text in blocks(page):
        if kind == "text":
            assert_printed(text, printed.pop(name), relative[name])
        elif kind == "sh":
            calls = [shlex.split(line) for line in text.splitlines()]
            printed[name] = "".join(run(tmp_path, *COMMANDS[c[0]], *c[1:]) for c in calls)
            relative[name] = 0.05  # medians of few random starts, with weights that collide
        else:
            (tmp_path / name).write_text(text, encoding="utf-8")
            if name.endswith(".toml"):
                assert load_scene(tmp_path / name).title
                assert name.removesuffix(".toml") not in bundled_scenes()
            elif name.startswith("test_"):
                if name not in commands:  # else the page runs it by itself
                    run(tmp_path, *COMMANDS["pytest"], "-q", name)
            else:
                printed[name], relative[name] = run(tmp_path, name), 1e-3
    assert not [name for name in printed if name.endswith(".py")], "a script without its output"


def test_gallery_shows_every_bundled_scene_by_its_title():
    rows = re.findall(r"^\| `(\w+)` \| (.+?) \|", GALLERY, re.MULTILINE)
    wanted = {name: load_scene(name).title for name in bundled_scenes()}
    missing = [f"| `{n}` | {title} |" for n, title in wanted.items() if (n, title) not in rows]
    assert not missing, "harness/gallery.md needs\n" + "\n".join(missing)
    assert len(rows) == len(wanted)


def commands_in(page: Path) -> list[str]:
    """Whole commands of a page: in a line of code, or in a block."""
    text = page.read_text(encoding="utf-8")
    inline = re.findall(r"`(autobalancer [a-z]+ [^`]+)`", text.split("## Commands")[0])
    in_blocks = [
        line for kind, _, body in blocks(page) if kind == "sh" for line in body.split("\n")
    ]
    return [c for c in (*inline, *in_blocks) if c.startswith("autobalancer ")]


@pytest.mark.parametrize("page", [*PAGES, HARNESS / "gallery.md"], ids=lambda page: page.stem)
def test_commands_shown_exist_with_their_options(page):
    shown = commands_in(page)
    assert shown
    for line in shown:
        _, name, *arguments = shlex.split(line)
        get_command(program()).commands[name].make_context(name, arguments)


def test_links_lead_somewhere():
    for page in (*PAGES, HARNESS / "README.md", HARNESS / "gallery.md", ROOT / "fmus/README.md"):
        text = page.read_text(encoding="utf-8")
        for target, chapter in re.findall(r"(?:\]\(|src=\")([^)#\"]*)(?:#([^)]*))?[)\"]", text):
            there = (page.parent / target) if target else page
            assert there.exists(), f"{page.name}: {target}"
            if chapter:
                heads = re.findall(r"^#+ (.*)$", there.read_text(encoding="utf-8"), re.MULTILINE)
                names = [re.sub(r"[^\w -]", "", h.lower()).replace(" ", "-") for h in heads]
                assert chapter in names, f"{page.name}: {target}#{chapter}"
