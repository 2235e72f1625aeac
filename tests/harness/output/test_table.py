"""One table in three forms."""

from __future__ import annotations

import csv
import io
import re

import pytest
from rich.console import Console

from autobalancer.harness.output.table import BAD, GOOD, Sheet

pytestmark = pytest.mark.slow

SHEET = Sheet(
    ("case [1/s]", "value", "holds"),
    [("a | b", "1.5", "yes"), ("[red]", "-", "NO")],
    "lrl",
    "Title [m]",
    {"holds": {"yes": "green", "NO": "bold red"}},
)


def printed(sheet: Sheet, **options) -> str:
    stream = io.StringIO()
    Console(file=stream, width=60, **options).print(sheet.rich())
    return stream.getvalue()


def test_markdown_aligns_and_keeps_bars_in_their_cells():
    assert SHEET.markdown().splitlines() == [
        "| case [1/s] | value | holds |",
        "|---|---:|---|",
        "| a \\| b | 1.5 | yes |",
        "| [red] | - | NO |",
    ]


def test_brackets_are_text_and_not_styles():
    text = printed(SHEET)
    for words in ("Title [m]", "case [1/s]", "[red]", "a | b"):
        assert words in text


def test_a_cell_has_the_colour_of_its_column_and_text():
    text = printed(SHEET, force_terminal=True, color_system="standard")
    assert "\x1b[32myes" in text
    assert "\x1b[1;31mNO" in text


def test_groups_are_parted_by_a_line():
    rows = [("a", "1"), ("", "2"), ("b", "3")]
    plain, grouped = (printed(Sheet(("x", "y"), rows, grouped=g)) for g in (False, True))
    assert len(grouped.splitlines()) == len(plain.splitlines()) + 1


def test_csv_keeps_every_digit(tmp_path):
    path = Sheet(("x", "y"), [(0.1 + 0.2, None), ("a,b", 3)]).write_csv(tmp_path / "t.csv")
    with path.open(encoding="utf-8", newline="") as stream:
        assert list(csv.reader(stream)) == [["x", "y"], ["0.30000000000000004", ""], ["a,b", "3"]]


@pytest.mark.parametrize(("rows", "align"), [([("1",)], ""), ([], "l"), ([], "lx")])
def test_cells_and_alignment_must_fit_the_columns(rows, align):
    with pytest.raises(ValueError, match=r"cells|letter"):
        Sheet(("x", "y"), rows, align)


def test_html_escapes_every_text_and_marks_good_and_bad():
    sheet = Sheet(
        ("<i>", "holds"), [["<b>&\x1b", "yes"], ["", "NO"]], "lr", "<u>",
        {"holds": {"yes": GOOD, "NO": BAD}},
    )  # fmt: skip
    page = sheet.html()
    assert "&lt;b&gt;&amp;\\x1b" in page
    assert not {"<i>", "<b>", "<u>"} & set(re.findall(r"<.>", page))
    assert re.search(r'class="good short" style="text-align:right">yes<', page)
    assert re.search(r'class="bad short" style="text-align:right">NO<', page)
