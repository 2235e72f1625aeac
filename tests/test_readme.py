"""The tables of the READMEs keep their word, and so does the set-up that README.md promises.

`.ci/run` runs the two commands and compares the self-check's last line; what scripts and commands
of the pages print is in `test_pages.py`.
"""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from autobalancer.harness import bundled_scenes, check
from tests.studies.omissions import calls, omissions
from tests.test_pages import NUMBER, blocks, run

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
MANUAL = ROOT / "harness" / "manual"
OMISSIONS = (MANUAL / "results" / "tables" / "omissions.md").read_text(encoding="utf-8")


def cells(text: str) -> list[list[str]]:
    """Rows of the Markdown tables in a text, without their headings."""
    rows = [line for line in text.splitlines() if line.startswith("|")]
    split = [[cell.strip() for cell in row.strip("|").split("|")] for row in rows]
    heads = [i for i, row in enumerate(split) if set("".join(row)) <= set("-:")]
    return [row for i, row in enumerate(split) if not any(h - 1 <= i <= h for h in heads)]


def test_pytest_check_of_the_readme_fails_with_the_message_shown(installed, tmp_path):
    files = {name: text for _, name, text in blocks(ROOT / "README.md")}
    strict = files["test_drum.py"].replace("10 um", "1 nm")
    assert strict != files["test_drum.py"]
    (tmp_path / "my_drum.toml").write_text(files["my_drum.toml"], encoding="utf-8")
    (tmp_path / "test_drum.py").write_text(strict, encoding="utf-8")
    with pytest.raises(AssertionError) as failure:
        run(installed, tmp_path, "-m", "pytest", "-q", "-p", "no:cacheprovider", "test_drum.py")
    said = " ".join(README.partition("it says: `")[2].split("`")[0].split())
    printed = str(failure.value)
    assert NUMBER.sub("#", said) in NUMBER.sub("#", printed)
    place = NUMBER.sub("#", printed).index(NUMBER.sub("#", said))
    before = NUMBER.sub("#", printed)[:place].count("#")
    numbers = [float(n) for n in NUMBER.findall(said)]
    found = [float(n) for n in NUMBER.findall(printed)[before : before + len(numbers)]]
    assert numbers == pytest.approx(found, rel=1e-3)


def test_the_number_of_scenes_is_that_of_the_bundled_ones():
    assert f"[gallery of {len(bundled_scenes())} scenes]" in README


def test_the_self_check_prints_the_numbers_shown():
    shown = {name: text for _, name, text in blocks(MANUAL / "results" / "self_check.md")}["check"]
    named = [name for name in bundled_scenes() if shown.startswith(f"{name} (")]
    assert len(named) == 1
    # those of the extra `proof` are not in a plain installation
    rows = [row for row in check(named[0]) if "proved" not in row.quantity]
    lines = [re.split(r"\s*│\s*", line) for line in shown.splitlines() if line.startswith("│")]
    begun = [line for line in lines if line[1]]
    assert len(begun) == len(rows)
    for line, row in zip(begun, rows, strict=True):
        assert row.holds
        assert row.quantity.startswith(line[2])
        # a curve's row shows its worst point, and which one that is may be a matter of rounding
        if isinstance(row.expected, float) and " at " not in row.quantity:
            assert float(line[3]) == pytest.approx(row.expected, rel=1e-6)
            assert float(line[4]) == pytest.approx(row.measured, rel=1e-6)


SAVED = {row[0]: row for row in cells(OMISSIONS)}


@pytest.mark.parametrize("omission", omissions(), ids=lambda omission: omission.what)
def test_table_of_what_is_left_out_counts_the_calls(omission):
    _, scene, full, lean, *_ = SAVED[omission.what]
    assert scene == f"`{omission.scene}`"
    # passes until converged may differ by a few where rounding differs
    found = calls(omission.full), calls(omission.lean)
    assert found == pytest.approx((float(full), float(lean)), rel=0.01, abs=0.051)


def test_table_of_what_is_left_out_names_nothing_else():
    assert set(SAVED) == {omission.what for omission in omissions()}


def test_ci_takes_its_two_commands_from_the_readme():
    commands = re.search(r"^```sh\n(.*?)^```$", README, re.MULTILINE | re.DOTALL)[1].splitlines()
    assert len(commands) == 2
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    for command, variable in zip(commands, ("self_check", "tests"), strict=True):
        pattern = re.search(rf"^{variable}=\$\(grep '(.*)' README\.md\)$", script, re.MULTILINE)[1]
        assert [line for line in README.splitlines() if re.search(pattern, line)] == [command]
        assert f'-c "${variable}"' in script
    assert os.access(ROOT / ".ci" / "run", os.X_OK)


def test_every_package_in_the_tree_is_installed():
    table = (ROOT / "pyproject.toml").read_text(encoding="utf-8").split("packages = [")[1]
    listed = set(re.findall(r'"autobalancer\.([\w.]+)"', table.split("]")[0]))
    found = {
        ".".join(path.parent.relative_to(ROOT).parts)
        for top in ("models", "fmus", "harness")
        for path in (ROOT / top).rglob("__init__.py")
    }
    assert listed == found - {"harness.api"}  # that is autobalancer itself


def test_a_run_without_a_picture_loads_no_drawing_library():
    code = "import sys; from autobalancer.harness import cosimulate, load_scene\n"
    code += "cosimulate(load_scene('liquid_disc')); print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "numpy" in done.stdout.split()
    assert "matplotlib" not in done.stdout.split()
