"""The store of a study: every verdict as it comes, for xarray to open."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from autobalancer.harness.output.store import StoredArray, StoredItems, open_store
from tests.truth.judge import Verdict
from tests.truth.study import Study, items_of

_KINDS = {
    "outcome": "str",
    "error": "f8",
    "where": "str",
    "stated": "f8",
    "words": "str",
    "steps": "i8",
    "measured": "i8",
    "estimate": "f8",
    "within": "i8",
}  # not the seconds, which are others every time
_NONE = -1  # in the place of None: neither an error nor a truth value


class Verdicts:
    """Verdicts by their scenes' numbers in a store, as `in_order` keeps them.

    Raises:
        UserError: what is at that place is no store, or another study's.
    """

    def __init__(self, path: Path, study: Study) -> None:
        self._items = items_of(study)
        shape = (len(self._items),)
        variables = {
            name: StoredArray(("scene",), shape, "scene", kind) for name, kind in _KINDS.items()
        }
        families, numbers = zip(*self._items, strict=True)
        self._part: StoredItems = open_store(
            path,
            {"content": f"truth study{', separate units' * study.separate}", "study": repr(study)},
            {"scene": variables},
            {"family": ("scene", list(families)), "number": ("scene", list(numbers))},
            [Path(__file__).parent],
        )["scene"]

    def __len__(self) -> int:
        return len(self._part)

    def __contains__(self, item: object) -> bool:
        return item in self._part

    def __getitem__(self, item: int) -> Verdict:
        found: dict[str, Any] = dict(zip(_KINDS, self._part[item], strict=True))
        for name in ("error", "measured", "within"):
            if found[name] == _NONE:
                found[name] = None
            elif name != "error":
                found[name] = bool(found[name])
        return Verdict(*self._items[item], **found)

    def __setitem__(self, item: int, verdict: Verdict) -> None:
        values = (getattr(verdict, name) for name in _KINDS)
        self._part[item] = tuple(_NONE if value is None else value for value in values)
