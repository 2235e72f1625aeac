"""A value that a command line puts into a scene, as it is typed: KEY=VALUE."""

from __future__ import annotations

import re
from typing import Any

from ..errors import UserError

_LONGEST_SHOWN = 200  # characters of what was typed
_SHORT_NUMBER = re.compile(
    r"[-+]?(?:\.\d+|\d+\.)(?:[eE][-+]?\d+)?"
)  # TOML wants digits on both sides
_WORD = re.compile(r"[A-Za-z][\w.-]*")


def parse_change(text: str) -> tuple[str, Any]:
    """'rotor.unbalance=0.1' as key and value, the value as TOML writes it, or with a unit.

    Raises:
        UserError: there is no '=', or what follows is not a value.
    """
    from ..units import has_unit
    from .file import tomllib

    key, equals, value = (part.strip() for part in text.partition("="))
    if key and has_unit(value):
        return key, value
    if key and _SHORT_NUMBER.fullmatch(value):
        return key, float(value)
    try:
        if not (key and equals and value):
            raise ValueError
        document = tomllib.loads(f"value = {value}")
        if document.keys() != {"value"}:  # a line break, and an assignment after it
            raise ValueError
        return key, document["value"]
    except (ValueError, RecursionError) as error:
        quoted = f"; text stands in quotes: '{key}=\"{value}\"'" if _WORD.fullmatch(value) else ""
        shown = text if len(text) <= _LONGEST_SHOWN else f"{text[:_LONGEST_SHOWN]}..."
        raise UserError(
            f"--set {' '.join(shown.splitlines())}: must be KEY=VALUE with one value as in "
            "a scene file, such as rotor.unbalance=0.1, speed=1200rpm or "
            f"'coupling.scheme=\"jacobi\"'{quoted}"
        ) from error
