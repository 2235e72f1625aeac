"""What the pages for readers show is what happens: files, commands and their output, as printed.

In a page a fenced block with a file name (```python settle.py) is that file; a script runs, a test
passes.  A ```sh block with a name is run, and a ```text block of a script's or command's name is
what it prints; `...` stands for lines left out.  Commands in a line of text run by themselves.
All run from a wheel of this checkout in an environment of its own (`tests.wheel`).
"""

import os
import re
import shlex
import subprocess
from pathlib import Path

import numpy as np
import pytest
from typer.main import get_command

from autobalancer.harness import bundled_scenes, load_scene
from autobalancer.harness.__main__ import program
from autobalancer.harness.manual.site import write_pages

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parent.parent
MANUAL = ROOT / "harness" / "manual"
ALL = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted(MANUAL.rglob("*.md"))]
PAGES = [ROOT / "README.md", *sorted(MANUAL.glob("tutorials/*.md")), *MANUAL.glob("how-to/*.md")]
GALLERY = (MANUAL / "gallery.md").read_text(encoding="utf-8")
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[+-]?\d+)?")
STEPS = """
import runpy, shlex, sys
from autobalancer.harness.__main__ import main
for step in sys.argv[1:]:
    sys.argv = shlex.split(step)
    try:
        main() if sys.argv[0] == "autobalancer" else runpy.run_path(step, run_name="__main__")
    except SystemExit as end:
        if end.code:
            sys.exit(f"{step}: exit code {end.code}")
    print(end=chr(30))
"""  # commands and scripts, all in one process, which loads the libraries once


def blocks(page: Path) -> list[tuple[str, str, str]]:
    """Kind, name and text of a page's named blocks."""
    text = page.read_text(encoding="utf-8")
    return re.findall(r"^```(\w+) (\S+)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def run(python: Path, folder: Path, *arguments: str) -> str:
    """What Python with these arguments prints, in a folder away from this checkout."""
    done = subprocess.run(
        [str(python), *arguments],
        cwd=folder,
        env={**os.environ, "PYTHONIOENCODING": "utf-8", "PYTHONPATH": ""},
        capture_output=True,
        encoding="utf-8",
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
def test_page_does_what_it_shows(page, installed, tmp_path):
    for other in (ROOT / "README.md", MANUAL / "tutorials" / "tool.md"):  # scenes of all pages
        for _, name, text in blocks(other):
            if name.endswith(".toml"):
                (tmp_path / name).write_text(text, encoding="utf-8")
    tests, steps = [], []
    commands = "".join(text for kind, _, text in blocks(page) if kind == "sh")
    for kind, name, text in blocks(page):
        if kind == "sh":
            for line in text.splitlines():
                program_name, *words = shlex.split(line)
                if program_name == "pytest":
                    tests.append(words)
                else:
                    steps.append((name, line))
        elif kind != "text":
            (tmp_path / name).write_text(text, encoding="utf-8")
            if name.endswith(".toml"):
                assert load_scene(tmp_path / name).title
                assert name.removesuffix(".toml") not in bundled_scenes()
            elif name.startswith("test_") and name not in commands:
                tests.append(["-q", name])
            elif name.endswith(".py") and not name.startswith("test_"):
                steps.append((name, name))
    said = run(installed, tmp_path, "-c", STEPS, *(step for _, step in steps)) if steps else ""
    printed: dict[str, str] = {}
    for (name, _), text in zip(steps, said.split(chr(30)), strict=False):
        printed[name] = printed.get(name, "") + text
    for words in tests:
        run(installed, tmp_path, "-m", "pytest", "-p", "no:cacheprovider", *words)
    for kind, name, text in blocks(page):
        if kind == "text":  # of commands medians of few random starts, with weights that collide
            assert_printed(text, printed.pop(name), 1e-3 if name.endswith(".py") else 0.05)
    assert not [name for name in printed if name.endswith(".py")], "a script without its output"


def test_pages_run_on_the_wheel_and_on_what_it_requires_alone(installed, tmp_path):
    code = "import autobalancer as ab, importlib.util as u; print(ab.Scene and ab.__file__)\n"
    code += "print([name for name in ('hypothesis', 'ziglang') if u.find_spec(name)])"
    home, besides = run(installed, tmp_path, "-c", code).splitlines()
    assert Path(home).is_relative_to(installed.parents[1])
    assert besides == "[]"


AMPLITUDES = "speed [rad/s],amplitude [mm]\n10,40\n12,35\n14,32\n"
OTHERS = [  # that no page shows whole
    "build two_balls --ssp -o two.ssp --python",
    "run two_balls -o run.csv --movie run.gif --movie-seconds 1",
    "run two_balls --separate",
    "check liquid_disc --report checked",
    "balance balancing_machine -o corrections.png",
    "fit two_balls --without-balancers --measured fit.csv --free rotor.unbalance -o fit.png",
    "precision two_balls --seconds 1 --set run.revolutions=1 -o precision.png",
    'race centrifuge --lobes "2=20 um@45 deg"',
    "stress 'rotor at rest'",
]


def in_blocks(page: Path) -> list[str]:
    """Commands of a page's blocks, which run with it."""
    text = "".join(text for kind, _, text in blocks(page) if kind == "sh")
    return [line for line in text.splitlines() if line.startswith("autobalancer ")]


def in_lines() -> list[str]:
    """Commands in lines of text of all pages, each once, and `OTHERS`."""
    shown = {line for page in PAGES for line in commands_in(page) if line not in in_blocks(page)}
    # `manual` requires an extra: tests/harness/test_manual.py
    return [*sorted(line for line in shown if "manual" not in line),
            *(f"autobalancer {line}" for line in OTHERS)]  # fmt: skip


def fewer(line: str) -> str:
    """The command with fewer random machines and starts, where the page leaves their number out."""
    words = shlex.split(line)
    few = {"scatter": " -n 200", "motions": " -n 20"}.get(words[1], "")
    return line if "-n" in words or "--sweep" in words else line + few


def test_commands_in_lines_of_text_and_all_others_run_as_installed(installed, tmp_path):
    (tmp_path / "fit.csv").write_text(AMPLITUDES)
    for _, name, text in blocks(ROOT / "README.md"):
        if name.endswith(".toml"):
            (tmp_path / name).write_text(text, encoding="utf-8")
    run(installed, tmp_path, "-c", STEPS, *map(fewer, in_lines()))


def test_every_command_is_run():
    lines = [*in_lines(), *(line for page in PAGES for line in in_blocks(page))]
    assert {shlex.split(line)[1] for line in lines} | {"manual"} == set(
        get_command(program()).commands
    )


def test_gallery_shows_every_bundled_scene_by_its_title():
    rows = re.findall(r"^\| `(\w+)` \| (.+?) \|", GALLERY, re.MULTILINE)
    wanted = {name: load_scene(name).title for name in bundled_scenes()}
    missing = [f"| `{n}` | {title} |" for n, title in wanted.items() if (n, title) not in rows]
    assert not missing, "gallery.md needs\n" + "\n".join(missing)
    assert len(rows) == len(wanted)


def commands_in(page: Path) -> list[str]:
    """Whole commands of a page, in a line of code or in a block; not those with a place to fill."""
    text = page.read_text(encoding="utf-8")
    inline = re.findall(r"`(autobalancer [a-z]+ [^`]+)`", text)
    in_blocks = [
        line for kind, _, body in blocks(page) if kind == "sh" for line in body.split("\n")
    ]
    whole = [c for c in (*inline, *in_blocks) if c.startswith("autobalancer ")]
    return [c for c in whole if not re.search(r"\b(SCENE|FILE|DIR|NAME|PATH)\b|\.\.\.", c)]


@pytest.mark.parametrize("page", ALL, ids=lambda page: page.stem)
def test_commands_shown_exist_with_their_options(page):
    for line in commands_in(page):
        _, name, *arguments = shlex.split(line)
        get_command(program()).commands[name].make_context(name, arguments)


def test_links_lead_somewhere(tmp_path):
    write_pages(tmp_path / "pages")
    units = list((ROOT / "fmus").glob("*/README.md"))
    for page in (*ALL, *units, *(tmp_path / "pages").rglob("*.md")):
        text = page.read_text(encoding="utf-8")
        for target, chapter in re.findall(r"(?:\]\(|src=\")([^)#\"]*)(?:#([^)]*))?[)\"]", text):
            there = (page.parent / target) if target else page
            if "://" in target or there.parent.name == "live":
                continue  # elsewhere, or a running scene
            assert there.exists(), f"{page.name}: {target}"
            made = "reference" in target and page.is_relative_to(MANUAL)
            if chapter and not made:  # those of pages that are made are asked in the copy
                heads = re.findall(r"^#+ (.*)$", there.read_text(encoding="utf-8"), re.MULTILINE)
                names = [re.sub(r"[^\w -]", "", h.lower()).replace(" ", "-") for h in heads]
                assert chapter in names, f"{page.name}: {target}#{chapter}"
