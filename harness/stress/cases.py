"""All stress cases by name."""

from __future__ import annotations

from . import cases_angles, cases_rotor, cases_shafts, cases_weights
from .case import Case


def all_cases() -> dict[str, Case]:
    """Every case in order."""
    parts = (cases_rotor, cases_weights, cases_shafts, cases_angles)
    return {case.name: case for part in parts for case in part.cases()}
