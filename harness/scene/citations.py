"""The papers and methods that a run of a scene uses, from the bibliography."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from ...models.references import citations, references

if TYPE_CHECKING:
    from .scene import Scene

_PARTS = {
    "planar": "Filimonikhina 2017; Dubovik 2006",
    "two_support": "Polushkin 2016",
    "flexible": "Filimonikhin 2011",
    "liquid": "Dubovik 2006",
    "balls": "Filimonikhina 2017",
    "rollers": "Filimonikhina 2017",
    "pendulums": "Filimonikhina 2017",
}  # by `kind`
_COUPLINGS = {"compensated": "Benedikt et al. 2013", "jacobi": "", "gauss-seidel": ""}
_ITERATED = "Broyden 1965; Sicklinger 2014"


def bibtex(scene: Scene) -> str:
    """Entries of the bibliography, in its order."""
    named = citations("\n".join(_cited(scene)))
    return "\n".join(entry.bibtex() for key, entry in references().items() if key in named)


def _cited(scene: Scene) -> Iterator[str]:
    """What the code of every part cites that runs."""
    yield scene.source
    yield _PARTS[scene.rotor.kind]
    for balancer in scene.balancer:
        yield _PARTS[balancer.kind]
        if balancer.can_meet:
            yield "Goncharov 2017; Moreau 1988; Murty 1974; Chandrupatla 1997"
        if balancer.can_stick:
            yield "Yang 2005; Chandrupatla 1997"
    if scene.rotor.friction:
        yield "Jenkins 1962; Moreau 1988; Jorba & Zou 2005"
    if scene.operation.motor:
        yield "Sommerfeld 1902; Kononenko 1969"
    if not scene.operation.speed:
        yield "Hairer & Wanner 1996; Hairer, Norsett & Wanner 1993"  # a speed that changes
    yield _COUPLINGS.get(scene.coupling.scheme, _ITERATED)
    if scene.coupling.tolerance is not None:
        yield "Schierz, Arnold, Clauss 2012; Hairer, Norsett & Wanner 1993"
    if scene.balancing is not None:
        yield "Polushkin 2016; ISO 21940-11"
