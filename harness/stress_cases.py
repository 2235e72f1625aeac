"""All stress cases by name."""

from __future__ import annotations

from . import (
    stress_cases_angles,
    stress_cases_rotor,
    stress_cases_shafts,
    stress_cases_weights,
)
from .stress_case import Case


def all_cases() -> dict[str, Case]:
    """Every case in order."""
    parts = (stress_cases_rotor, stress_cases_weights, stress_cases_shafts, stress_cases_angles)
    return {case.name: case for part in parts for case in part.cases()}
