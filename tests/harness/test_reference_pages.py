"""The reference stands in the repository, whole and up to date."""

from __future__ import annotations

import json
import subprocess
import sys
from importlib.metadata import version

import pytest
from typer.main import get_command

from autobalancer.harness.__main__ import program
from autobalancer.harness.manual import reference

HELP_OF = (0, 29)  # release of Typer that wrote the options: others write them in other words


PRINTED = """
import json
from typer.main import get_command
from autobalancer.harness.__main__ import program
from autobalancer.harness.manual import reference
print(json.dumps(reference.pages(get_command(program()))))
"""


@pytest.fixture(scope="module")
def pages():
    """As the program writes them, in a process of its own: classes that are built late show."""
    command = [sys.executable, "-c", PRINTED]
    found: dict[str, str] = json.loads(
        subprocess.run(command, capture_output=True, check=True).stdout
    )
    return found


@pytest.mark.parametrize("name", ["scene", "commands", "messages", "python", "units"])
def test_a_page_of_the_reference_is_what_the_code_says(pages, name):
    present = tuple(map(int, version("typer").split(".")[:2]))
    if name == "commands" and present != HELP_OF:
        pytest.skip(f"Typer {version('typer')} writes the help of options in other words")
    in_repository = (reference.FOLDER / f"{name}.md").read_text(encoding="utf-8")
    assert in_repository == pages[f"{name}.md"], (
        f"reference/{name}.md is stale: python -m tests.studies.reference"
    )


def test_a_stale_page_is_written_anew(pages, tmp_path, monkeypatch):
    for name, text in pages.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    introduction, _, _ = pages["scene.md"].partition(reference.MARK)
    (tmp_path / "scene.md").write_text(f"{introduction}{reference.MARK}\nold", encoding="utf-8")
    monkeypatch.setattr(reference, "FOLDER", tmp_path)
    assert reference.write(get_command(program())) == ["scene.md"]
    assert (tmp_path / "scene.md").read_text(encoding="utf-8") == pages["scene.md"]


def test_the_pages_can_be_read_where_the_repository_is(pages):
    """A code host shows no front matter, and takes `>>>` in plain text for quotations."""
    for text in pages.values():
        assert text.startswith("# ")
        fenced = False
        for line in text.splitlines():
            fenced ^= line.startswith("```")
            assert fenced or not line.startswith(">>>"), line


def test_a_signature_says_what_is_given_by_name_alone(pages):
    signature = "assert_balanced(below: float | str, *, last: float = 0.1) -> None"
    assert signature in pages["python.md"]
