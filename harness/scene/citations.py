"""The papers and methods that a run of a scene uses, from the bibliography, and what for."""

from __future__ import annotations

from collections.abc import Iterator
from importlib.metadata import version
from typing import TYPE_CHECKING

from ...models.references import Reference, citations, references

if TYPE_CHECKING:
    from .scene import Scene

_ROTORS = {
    "planar": ("Filimonikhina 2017", "equations of the planar rotor"),
    "two_support": ("Polushkin 2016", "equations of the rotor on two supports"),
    "flexible": ("Filimonikhin 2011", "equations of the flexible rotor"),
}  # by `kind`; the equations of a rotor by its matrices are the user's
_LIQUID = "Dubovik 2006", "equations of a rotor with a liquid balancer"
_RING = "Li, Wang and Yuan 2018", "stability of a rotor part filled with liquid"
STIFF = "steps of a stiff machine by collocation (Radau IIA), where a series needs many more"
_WEIGHTS = "Filimonikhina 2017", "equations of the balls, rollers or pendulums"


def program() -> Reference:
    """The program itself, as CITATION.cff names it."""
    released = version("autobalancer")
    fields = {
        "author": "{The autobalancer authors}",  # braces: a group, no names of persons
        "title": "autobalancer",
        "version": released,
        "note": "MIT licence",
    }
    return Reference("autobalancer", "software", fields)


def bibtex(scene: Scene, in_one_piece: bool = False, collocates: bool = False) -> str:
    """The program, then entries in the bibliography's order, each below what it is cited for.

    Args:
        in_one_piece: whether the machine is integrated without a coupling.
        collocates: whether it then tries steps by collocation, as a stiff machine does, or may try.
    """
    reasons: dict[str, list[str]] = {}
    for cited, reason in _cited(scene, in_one_piece, collocates):
        for key in sorted(citations(cited)):
            if reason not in reasons.setdefault(key, []):
                reasons[key].append(reason)
    entries = [f"% the program that ran the scene\n{program().bibtex()}"]
    for key, entry in references().items():
        if key in reasons:
            entries.append(f"% {'; '.join(reasons[key])}\n{entry.bibtex()}")
    return "\n".join(entries)


def _cited(scene: Scene, in_one_piece: bool, collocates: bool) -> Iterator[tuple[str, str]]:
    """What every part that runs cites, and for what."""
    yield scene.source, "source of the scene's values"
    liquid_only = all(balancer.kind == "liquid" for balancer in scene.balancer)
    known = scene.rotor.kind in _ROTORS
    if known and (scene.rotor.kind != "planar" or not scene.balancer or not liquid_only):
        yield _ROTORS[scene.rotor.kind]  # else Dubovik's equations are those of rotor and liquid
    for balancer in scene.balancer:
        yield {"liquid": _LIQUID, "ring": _RING}.get(balancer.kind, _WEIGHTS)
        if balancer.can_meet:
            yield "Goncharov 2017", "spacing of weights that touch"
            yield "Moreau 1988; Murty 1974", "impacts of several weights at once"
            yield "Chandrupatla 1997", "times of impacts and of sticking"
        if balancer.can_stick:
            yield "Yang 2005", "rolling resistance of weights"
            yield "Chandrupatla 1997", "times of impacts and of sticking"
    if scene.rotor.friction:
        if any(slider.stiffness for slider in scene.rotor.friction):
            yield "Jenkins 1962", "slider behind a spring"
        yield "Moreau 1988", "sliders that let go at once"
    if scene.operation.motor:
        yield "Sommerfeld 1902; Kononenko 1969", "motor of limited power"
    if in_one_piece:
        yield "Jorba & Zou 2005", "steps of the whole machine by Taylor series"
        if collocates:
            yield "Hairer & Wanner 1996", STIFF
    elif scene.coupling.units == "native" and (scene.rotor.friction or not scene.operation.speed):
        yield "Jorba & Zou 2005", "steps of the rotor by Taylor series"
    elif not scene.operation.speed:
        yield "Hairer & Wanner 1996", "steps of the rotor at a speed that changes (Radau IIA)"
        yield "Hairer, Norsett & Wanner 1993", "error of these steps (step doubling)"
    if not in_one_piece:
        yield from _coupling(scene)
    if scene.balancing is not None:
        yield "Polushkin 2016; ISO 21940-11", "balancing in cycles, permissible unbalance"


def _coupling(scene: Scene) -> Iterator[tuple[str, str]]:
    """What the exchange of signals cites; a rotor alone exchanges none."""
    if scene.coupling.tolerance is not None:
        yield "Schierz, Arnold, Clauss 2012", "estimated error of a communication step"
        yield "Hairer, Norsett & Wanner 1993", "error of the whole run (Richardson)"
    if not scene.balancer:
        return
    scheme = scene.coupling.scheme
    if scheme == "compensated":
        yield "Benedikt et al. 2013", "compensation of the coupling's error"
        yield "Sicklinger 2014", "interface Jacobian of the coupling"
    elif scheme not in ("jacobi", "gauss-seidel"):
        yield "Broyden 1965", "corrector passes of the coupling (quasi-Newton)"
