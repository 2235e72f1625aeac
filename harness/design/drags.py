"""The drag that a design counts with: measured, or from the oil's lower bound to ten times it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..drag.estimate import find_drag
from ..errors import UserError
from ..scene import Scene
from ..scene.balancer import WeightBalancer
from ..units import si_number
from .candidates import Candidate

DECADE = 10.0  # times the oil's bound: the drag of a measured rig was ten times it
OIL = "ISO VG 46"
RANGE = ".."


@dataclass(frozen=True)
class DragRange:
    """Drag of one weight, by its size.

    Attributes:
        low, high: [N s/m]; of a weight of `reference` mass where that is given.
        reference: mass whose drag is known [kg]; the ratio to the mass is kept; 0: of every size.
        oil: bound by this oil instead.
        said: where it comes from, a sentence.
    """

    low: float = 0.0
    high: float = 0.0
    reference: float = 0.0
    oil: str = ""
    said: str = ""

    def of(self, one: Candidate) -> tuple[float, ...]:
        """The drags to be tried with a candidate [N s/m]: one, or both ends."""
        if self.oil:
            bound = find_drag(2.0 * one.radius, oil=self.oil).value
            return (bound, DECADE * bound)
        factor = one.mass / self.reference if self.reference else 1.0
        ends = (factor * self.low, factor * self.high)
        return ends[:1] if math.isclose(*ends) else ends


def drag_range(scene: Scene, given: str | float | None, oil: str | None) -> DragRange:
    """From what the user gives, else from the scene's weights, else from the oil.

    Args:
        given: a drag of every candidate [N s/m], or "LOW..HIGH".
        oil: such as "ISO VG 46".

    Raises:
        UserError: a value is wrong, or both are given.
    """
    if given is not None and oil is not None:
        raise UserError("give either --drag, which is measured, or --oil, which gives a bound")
    if given is not None:
        return _given(str(given))
    one = scene.balancer[0] if scene.balancer else None
    if oil is None and isinstance(one, WeightBalancer) and one.drag:
        drag, mass = one.device.each[0].drag, one.device.each[0].mass
        return DragRange(drag, drag, mass, "", _of_scene(drag, mass))
    oil = oil or OIL
    find_drag(0.01, oil=oil)  # refuses what is no oil
    return DragRange(oil=oil, said=(
        f"Drag: not measured, so every candidate is tried at the lower bound of {oil} at 40 degC "
        f"and at {DECADE:g} times it. Measure it (autobalancer drag) and give --drag."
    ))  # fmt: skip


def _given(text: str) -> DragRange:
    low_text, _, high_text = text.rpartition(RANGE)
    high = si_number(high_text, "N s/m", "--drag")
    low = si_number(low_text, "N s/m", "--drag") if low_text else high
    if not 0.0 < low <= high < math.inf:
        raise UserError(f"--drag {text}: must be above 0, and rising, such as 0.004..0.04 N s/m")
    span = f"{low:.3g}" if low == high else f"{low:.3g} to {high:.3g}"
    return DragRange(low, high, said=f"Drag: {span} N s/m of every weight, as given.")


def _of_scene(drag: float, mass: float) -> str:
    return (
        f"Drag: that of the scene's weights, {drag:.3g} N s/m at {1e3 * mass:.3g} g, in proportion "
        "to the mass of a candidate. Measure it (autobalancer drag) and give --drag."
    )
