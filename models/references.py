"""The papers and methods behind the code, from REFERENCES.bib: what "Name YEAR" in a text means."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

_FILE = Path(__file__).with_name("REFERENCES.bib")
_ENTRY = re.compile(r"^@(\w+)\{([^,\s]+),\n(.*?)^\}", re.MULTILINE | re.DOTALL)
_FIELD = re.compile(r"^\s*(\w+) = \{(.*)\},$", re.MULTILINE)
_OTHERS = r"(?:(?:,|\s+(?:&|and))\s+(?:Van\s+)?[A-Z][a-zß]+)*(?:\s+et\s+al\.)?"
_CITATION = re.compile(rf"\b([A-Z][a-z]+){_OTHERS}\s+\(?((?:19|20)\d\d)\b|\b(ISO)\s(\d+-\d+)")


@dataclass(frozen=True)
class Reference:
    """One entry of the bibliography.

    Attributes:
        key: first author and year, or name and number of a standard.
        kind: of BibTeX, such as article or book.
        fields: of BibTeX: author, title, year, and what else is known of it.
    """

    key: str
    kind: str
    fields: dict[str, str]

    def __str__(self) -> str:
        """Authors (year): title. Where it stands. DOI."""
        known = self.fields
        place = [known[name] for name in ("journal", "booktitle", "publisher") if name in known]
        place += [known[name] for name in ("volume", "number") if name in known]
        if "pages" in known:
            place.append(f"p. {known['pages'].replace('--', '-')}")
        parts = [f"{known['author'].replace(' and ', ', ')} ({known['year']}): {known['title']}"]
        parts += [", ".join(place)] if place else []
        parts += [f"doi:{known['doi']}"] if "doi" in known else []
        return ". ".join(parts).replace("\\&", "&")

    def bibtex(self) -> str:
        """As in a BibTeX file."""
        lines = [f"  {name} = {{{value}}}," for name, value in self.fields.items()]
        return "\n".join([f"@{self.kind}{{{self.key},", *lines, "}", ""])


@cache
def references() -> dict[str, Reference]:
    """Every entry by its key, in the order of the file.

    Raises:
        ValueError: an entry lacks author, title or year.
    """
    found = {}
    for kind, key, body in _ENTRY.findall(_FILE.read_text(encoding="utf-8")):
        fields = dict(_FIELD.findall(body))
        missing = [name for name in ("author", "title", "year") if name not in fields]
        if missing:
            raise ValueError(f"{_FILE.name}: {key} has no {', '.join(missing)}")
        found[key] = Reference(key, kind, fields)
    return found


def citations(text: str) -> set[str]:
    """Keys of what a text cites: "Hairer & Wanner 1996", "Benedikt et al. 2013", "ISO 21940-11"."""
    return {a + year if a else iso + part for a, year, iso, part in _CITATION.findall(text)}
