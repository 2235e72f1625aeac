"""Supports that are not linear, for the study of verdicts: sliders, stops, cubic springs, strokes.

Each takes a drawn machine and changes its rotor; sizes are shares of the vibration or of the force
that its unbalance alone would bring.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from tests.studies.truth.sketch import Document, even, rounded, sized

if TYPE_CHECKING:
    from tests.studies.verdict_scenes import Machine

Drawn = Callable[[random.Random, "Machine"], Document]


def on(
    supports: Callable[[random.Random, Machine, Document], None], machines: Sequence[Drawn]
) -> Drawn:
    """One of several machines on supports that are not linear."""

    def made(g: random.Random, m: Machine) -> Document:
        document = g.choice(machines)(g, m)
        supports(g, m, document["rotor"])
        return document

    return made


def places(rotor: Document) -> range:
    """Numbers of the supports."""
    return range(1, 3 if rotor["kind"] == "two_support" else 2)


def stiffness(m: Machine, rotor: Document) -> float:
    """Of one support, along x [N/m]."""
    return m.mass * m.natural**2 / len(places(rotor))


def size(m: Machine) -> float:
    """Vibration of the rotor alone on linear supports, along x [m]."""
    response = m.ratio**2 / abs(1.0 - m.ratio**2 + 2j * m.damping * m.ratio)
    return m.share * m.moment / m.mass * response


def dry_friction(g: random.Random, m: Machine, rotor: Document) -> None:
    """Rigid sliders in one support or in both, from weak ones to such as hold the rotor at rest."""
    force = m.share * m.moment * m.speed**2 / len(places(rotor))
    limit = rounded(force * sized(g, 0.01, 0.7))
    rotor["friction"] = [{"support": n, "limit": limit} for n in _some(g, rotor)]


def free_strokes(g: random.Random, m: Machine, rotor: Document) -> None:
    """Dampers that grip beyond a stroke, which the rotor alone leaves or not."""
    force = m.share * m.moment * m.speed**2 / len(places(rotor))
    one = {
        "limit": rounded(force * sized(g, 0.02, 0.7)),
        "stiffness": rounded(stiffness(m, rotor) * even(g, 1.0, 10.0)),
        "free_stroke": rounded(2.0 * size(m) * sized(g, 0.1, 2.0)),
    }
    rotor["friction"] = [{"support": n, **one} for n in _some(g, rotor)]


def stops(g: random.Random, m: Machine, rotor: Document) -> None:
    """Rings or pairs of stops, with a gap that the rotor alone reaches or not."""
    stiff = stiffness(m, rotor) * sized(g, 1.0, 100.0)
    one: dict[str, Any] = {
        "gap": rounded(size(m) * even(g, 0.3, 2.0)),
        "stiffness": rounded(stiff),
        "kind": g.choice(("ring", "ring", "x", "y")),
    }
    if g.random() < 0.7:
        one["damping"] = rounded((stiff * m.mass) ** 0.5 * sized(g, 0.02, 0.5))
    rotor["stops"] = [{"support": n, **one} for n in _some(g, rotor)]


def cubic_springs(g: random.Random, m: Machine, rotor: Document) -> None:
    """Springs that stiffen, by up to their linear force at the vibration of the rotor alone."""
    one = rounded(stiffness(m, rotor) / size(m) ** 2 * sized(g, 0.01, 1.0))
    rotor["cubic_stiffness"] = [one] * 2 if len(places(rotor)) == 2 else one
    rotor["cubic"] = g.choice(("radial", "axes"))


def _some(g: random.Random, rotor: Document) -> list[int]:
    every = list(places(rotor))
    return every if g.random() < 0.6 else [g.choice(every)]
