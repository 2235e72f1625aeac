"""Files among the resources of a Python FMU that its slave reads."""

from __future__ import annotations

import json
import os
from typing import Any

OPTIONS = "options.json"  # build options, and with them the sizes
START = "start.json"  # where there is one: start values in place of the unit's own

_kept: dict[str, tuple[dict[str, Any], dict[str, float | bool]]] = {}  # by resources folder


def kept_in(resources: str) -> tuple[dict[str, Any], dict[str, float | bool]]:
    """Options and start values of the FMU whose resources are there.

    For a reset the folder may be gone by then.
    """
    try:
        with open(f"{resources}/{OPTIONS}", encoding="utf-8") as file:
            options = json.load(file)
    except FileNotFoundError:
        if resources not in _kept:
            raise
        return _kept[resources]
    start = {}
    if os.path.isfile(f"{resources}/{START}"):
        with open(f"{resources}/{START}", encoding="utf-8") as file:
            start = json.load(file)
    _kept[resources] = options, start
    return options, start
