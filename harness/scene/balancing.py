"""The [balancing] table of a scene: how its rotor is balanced on the virtual machine."""

from __future__ import annotations

import re
from typing import Annotated, Literal

from pydantic import Field, field_validator

from .quantities import SI, Positive, Table, Text, Whole
from .rotor_table import RotorTable

_GRADE = r"^G\s?(\d+(?:\.\d+)?)$"


def precession_of(grade: str) -> float:
    """e_per w that a grade of ISO 21940-11 stands for [m/s].

    Raises:
        ValueError: it is no grade.
    """
    match = re.match(_GRADE, grade)
    if match is None or float(match[1]) <= 0.0:
        raise ValueError('must be "G" and a number of mm/s above 0, such as "G2.5" or "G6.3"')
    return 1e-3 * float(match[1])


class Balancing(Table):
    """Grade to be met, planes, and how the machine measures and corrects."""

    grade: Text
    """Of ISO 21940-11, in mm/s: `"G2.5"` asks for e_per w = 2.5 mm/s."""
    service_speed: Annotated[Positive | None, SI("rad/s")] = None
    """The grade's w; default: the speed on the machine."""
    planes: Annotated[tuple[Whole, ...] | None, Field(min_length=1)] = None
    """Numbers of the planes that take corrections; default: all planes of the rotor."""
    technology: Literal["complex", "scalar", "both"] = "both"
    """Kind of the coefficients; both: one after the other."""
    axis: Literal["x", "y"] = "x"
    """Direction in which the supports are watched."""
    revolutions: Annotated[Whole, Field(ge=1, le=100_000)] = 8
    """Measured after steady state is reached."""

    @field_validator("grade")
    @classmethod
    def _is_a_grade(cls, value: str) -> str:
        precession_of(value)
        return value

    @property
    def precession(self) -> float:
        """e_per w that the grade stands for [m/s]."""
        return precession_of(self.grade)

    @property
    def technologies(self) -> tuple[str, ...]:
        """Those asked for, in order."""
        return ("complex", "scalar") if self.technology == "both" else (self.technology,)

    def correction_planes(self, rotor: RotorTable) -> list[int]:
        """Numbers of the correction planes, from 1."""
        return list(self.planes or range(1, rotor.plane_count + 1))

    def problems(self, rotor: RotorTable) -> list[str]:
        """What does not fit the scene's rotor, in words."""
        planes = self.correction_planes(rotor)
        count, sensors = rotor.plane_count, len(rotor.supports)
        shown = f"balancing.planes = {planes}"
        if not all(1 <= p <= count for p in planes):
            return [f"{shown}: must be planes of the rotor, 1 to {count}"]
        if len(set(planes)) < len(planes):
            return [f"{shown}: must all be different"]
        if len(planes) != sensors:
            each = "its one support" if sensors == 1 else "each of the 2 supports watched"
            return [f"{shown}: must be {sensors} of the rotor's {count} planes, one for {each}"]
        return []
