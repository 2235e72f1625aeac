"""Every source that the code names can be looked up."""

from __future__ import annotations

from pathlib import Path

import pytest

import autobalancer.models as models
from autobalancer.models.references import citations, references

ROOT = Path(models.__file__).resolve().parents[1]
TEXTS = [
    path
    for folder in ("models", "fmus", "harness")
    for path in sorted((ROOT / folder).rglob("*"))
    if path.suffix in (".py", ".md", ".c", ".h")
]


def cited() -> dict[str, list[str]]:
    """Where each source is cited, by its key."""
    places: dict[str, list[str]] = {}
    for path in TEXTS:
        for key in citations(path.read_text(encoding="utf-8")):
            places.setdefault(key, []).append(str(path.relative_to(ROOT)))
    return places


def test_every_citation_is_in_the_bibliography():
    unknown = {key: where for key, where in cited().items() if key not in references()}
    assert not unknown
    assert len(cited()) > 10


def test_nothing_stands_in_the_bibliography_that_is_not_cited():
    assert set(references()) <= set(cited())


@pytest.mark.parametrize("reference", references().values(), ids=lambda r: r.key)
def test_a_key_is_first_author_and_year(reference):
    author, year = reference.fields["author"].split(",")[0], reference.fields["year"]
    assert reference.key in (author + year, "ISO10816-3", "ISO5349-1", "ISO21940-11", "ISO3290-1")
    assert reference.fields["title"] in str(reference)


def test_citations_are_found_in_every_form_that_texts_use():
    text = "As Hairer & Wanner 1996, IV.5; (Schierz, Arnold, Clauss 2012), Benedikt et al.\n2013."
    assert citations(text) == {"Hairer1996", "Schierz2012", "Benedikt2013"}
    assert citations("as in Golub and\nVan Loan 2013, 7.2.2") == {"Golub2013"}
    assert citations("grade of ISO 21940-11, after Broyden (1965)") == {
        "ISO21940-11", "Broyden1965"
    }  # fmt: skip
    assert citations("Copyright (c) 2026 the authors; 2017 balls") == set()
