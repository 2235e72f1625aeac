"""Stress cases of dry friction, in the weights and in the supports, and of gravity."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from .case import ROTOR_AND_MOMENT, XY, Case
from .cases_weights import MASS, RADIUS, SPEED, coupled

PULL = MASS * RADIUS * SPEED**2  # N: of the unbalance, as much as one weight can balance


def cases() -> Iterator[Case]:
    """Weights that stick, light and heavy, sliders in the supports, and weights that fall."""
    for resistance in (1e-6, 1e-3, 0.1, 1e3):
        kept = XY if resistance >= 0.1 else ROTOR_AND_MOMENT  # what sticks from the start on rests
        yield coupled(
            f"rolling resistance of {resistance:g} of the load",
            {"weights.rolling_resistance": resistance, "weights.drag": 1e-4},
            signals=kept,
        )
    heavy = {"weights.mass": 0.95, "weights.drag": 1e-2, "run.revolutions": 3}
    yield coupled(
        "rolling resistance of weights as heavy as the rotor",
        {**heavy, "weights.rolling_resistance": 0.01},
    )
    for share in (1e-6, 0.1, 10.0, 1e6):
        changes: dict[str, Any] = {"rotor.friction": [{"limit": share * PULL}]}
        if share > 1.0:  # the rotor never moves
            changes["weights.speeds"] = [2.0, -1.0]
        yield coupled(f"dry supports that hold {share:g} of the pull", changes)
    for stiffness in (1e-3, 100.0):
        changes = {"rotor.friction": [{"limit": 0.3 * PULL, "stiffness": stiffness}]}
        yield coupled(f"dry supports behind {stiffness:g} N/m", changes)
    for weight in (1e-6, 9.81, 1e3):
        yield coupled(f"gravity of {weight:g} m/s2 across the axis", {"operation.gravity": weight})
