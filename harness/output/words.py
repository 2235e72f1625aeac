"""Text of a user's, such as a title, made harmless where it is shown; many messages in few."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable
from html import escape

# also what turns the direction of writing, and bytes of a file's name that are no UTF-8
_CONTROL = r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u202a-\u202e\u2066-\u2069\ud800-\udfff]"
_TAG = r"<(?=[A-Za-z/!?])"  # CommonMark reads this as the start of an HTML tag
_CODE = r"`([^`\n]+)`"  # as messages write commands and values
_NUMBER = r"-?\d+(?:\.\d+)?(?:e[+-]?\d+)?"


def printable(text: str) -> str:
    """With control characters written out: a terminal would obey them."""
    return re.sub(_CONTROL, lambda found: ascii(found[0])[1:-1], text)


def in_markdown(text: str) -> str:
    """On one line, with no HTML in it."""
    return re.sub(_TAG, "&lt;", printable(" ".join(text.split("\n"))))


def in_html(text: str) -> str:
    """Escaped for HTML, with what stands in backticks as code."""
    return re.sub(_CODE, r"<code>\1</code>", escape(printable(text)))


def kinds_of(texts: Iterable[str]) -> list[tuple[int, str]]:
    """How often each kind of message occurs, and an example: they differ in numbers alone."""
    kinds, examples = Counter[str](), dict[str, str]()
    for text in texts:
        kind = re.sub(_NUMBER, "", text)
        kinds[kind] += 1
        examples.setdefault(kind, text)
    return [(count, examples[kind]) for kind, count in kinds.most_common()]
