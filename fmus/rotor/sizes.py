"""Sizes of a rotor: of what it has how many."""

from __future__ import annotations

from dataclasses import dataclass

from ..unit import Sizes, count, one_of


@dataclass(frozen=True)
class RotorSizes(Sizes):
    """Sizes of a rotor.

    Attributes:
        kind: planar | two_support | flexible | matrices.
        stations, planes, unbalances, sliders: numbers of them.
        cubics, stops: springs that are not linear, and stops.
        tables, speeds: bearings that change with the speed, and rows of their tables.
        shaft: how a flexible rotor's is given: "uniform" (bending stiffness) or "compliance" (a
            matrix).
        supports, feet: of a rotor by its matrices, those whose forces are outputs.
    """

    kind: str = one_of("planar", "two_support", "flexible", "matrices")
    stations: int = count(1)
    planes: int = count(1)
    unbalances: int = count(1, of=("two_support", "flexible", "matrices"))
    shaft: str = one_of("uniform", "compliance", of=("flexible",))
    sliders: int = count(0)
    tables: int = count(0, of=("matrices",))
    speeds: int = count(0, of=("matrices",))
    supports: int = count(0, of=("matrices",), native=False)
    feet: int = count(0, of=("matrices",), native=False)
    cubics: int = count(0)
    stops: int = count(0)

    @property
    def forces(self) -> list[str]:
        """Supports, then feet, whose forces are outputs."""
        known = {"planar": 1, "two_support": 2, "flexible": 2}.get(self.kind, self.supports)
        if known > 2:
            raise ValueError(f"supports = {known}: a rotor has at most 2")
        supports = [f"support[{k}]" for k in range(1, known + 1)]
        return supports + [f"foot[{k}]" for k in range(1, self.feet + 1)]
