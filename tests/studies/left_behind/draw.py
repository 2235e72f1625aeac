"""Random machines of every kind, each for the package and for `integrate.c`."""

from __future__ import annotations

import copy
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from autobalancer.models.assembly import Assembly, Mounted
from autobalancer.models.rotor import LinearRotor
from autobalancer.models.weights import Weights

from . import machine

KINDS = ("planar", "anisotropic", "internal", "two planes", "gyroscopic", "flexible")


@dataclass
class Drawn:
    """One machine; speeds are in units of its lowest natural frequency, about 1 rad/s."""

    kind: str
    rotor: machine.Rotor
    weights: list[machine.Weight]
    assembly: Assembly
    document: dict[str, Any]

    def with_drag(self, factor: float) -> Drawn:
        """All drags multiplied."""
        balancers = tuple(
            replace(m, device=replace(m.device, drag=factor * m.device.drag))
            for m in self.assembly.balancers
        )
        weights = [replace(w, drag=factor * w.drag) for w in self.weights]
        document = copy.deepcopy(self.document)
        for table in document["balancer"]:
            table["drag"] *= factor
        assembly = replace(self.assembly, balancers=balancers)
        return replace(self, weights=weights, assembly=assembly, document=document)


def draw(kind: str, random: np.random.Generator) -> Drawn:
    """Damping ratio 0.01 to 0.15, two to four weights, unbalance 5 to 35 % of their capacity."""
    zeta = float(np.exp(random.uniform(np.log(0.01), np.log(0.15))))
    share, mass = random.uniform(0.05, 0.35), random.uniform(0.01, 0.04)
    count = int(random.integers(2, 5))
    if kind in ("planar", "anisotropic", "internal"):
        return _planar(kind, zeta, share, mass, count, random)
    if kind == "flexible":
        return _flexible(zeta, share, mass, random)
    return _two_support(kind, zeta, share, mass, random)


def _planar(kind, zeta, share, mass, count, random) -> Drawn:
    ratio = random.uniform(1.3, 5.0) if kind == "anisotropic" else 1.0
    stiffness = (1.0, ratio)
    damping = tuple(2.0 * zeta * np.sqrt(k) for k in stiffness)
    internal = random.uniform(0.02, 0.1) * damping[0] if kind == "internal" else 0.0
    unbalance = share * count * mass
    rotor = LinearRotor.planar(1.0, stiffness, damping, internal, unbalance)
    own = machine.planar(1.0, stiffness, damping, unbalance, internal)
    device = Weights(count, mass, 1.0, 0.005, 1.4)
    weights = [machine.Weight(0, mass, 1.0, 0.005) for _ in range(count)]
    mounted = (Mounted("balls", device, 0, (0.0,) * count),)
    table = {"kind": "planar", "mass": 1.0, "stiffness": stiffness, "damping": damping,
             "internal_damping": internal, "unbalance": unbalance}  # fmt: skip
    document = {"rotor": table, "balancer": [_balls("balls", 1, count, mass)]}
    return Drawn(kind, own, weights, Assembly(rotor, mounted), document)


def _balls(name, at, count, mass) -> dict[str, Any]:
    return {"name": name, "kind": "balls", "at": at, "count": count, "mass": mass,
            "track_radius": 1.0, "drag": 0.005}  # fmt: skip


def _two_support(kind, zeta, share, mass, random) -> Drawn:
    ratio = random.uniform(0.6, 1.6) if kind == "two planes" else 1.0
    stiffness = ((0.5, 0.5 * ratio), (0.5, 0.5 * ratio))
    damping = tuple(tuple(2.0 * zeta * np.sqrt(k / 2.0) for k in row) for row in stiffness)
    inertia = random.uniform(0.03, 0.12)
    polar = inertia * (random.uniform(0.2, 0.6) if kind == "gyroscopic" else 0.0)
    places = (random.uniform(0.1, 0.3), random.uniform(0.7, 0.9))
    unbalances = [(z, share * 2 * mass, random.uniform(0, 6.28)) for z in (0.2, 0.8)]
    rotor = LinearRotor.two_support(
        mass=1.0, inertia=inertia, polar_inertia=polar, span=1.0, stiffness=stiffness,
        damping=damping, planes=places, unbalances=unbalances,
    )  # fmt: skip
    own = machine.two_support(1.0, inertia, polar, 1.0, stiffness, damping, places, unbalances)
    table = {"kind": "two_support", "mass": 1.0, "inertia": inertia, "polar_inertia": polar,
             "span": 1.0, "stiffness": stiffness, "damping": damping, "planes": places}  # fmt: skip
    table["unbalances"] = [{"position": z, "amount": u, "angle": a} for z, u, a in unbalances]
    return _on_two_planes(kind, rotor, own, (0, 1), mass, table)


def _flexible(zeta, share, mass, random) -> Drawn:
    places, masses = (
        (0.0, random.uniform(0.3, 0.4), random.uniform(0.6, 0.7), 1.0),
        (0.1, 0.5, 0.5, 0.1),
    )
    stiffness = ((2.0, 2.0), (2.0, 2.0))
    damping = tuple((2.0 * zeta * 1.0,) * 2 for _ in stiffness)
    unbalances = [(1, share * mass, 0.0), (2, share * mass, random.uniform(0, 6.28))]
    bending = random.uniform(0.02, 0.06)
    rotor = LinearRotor.flexible(
        stations=places, masses=masses, supports=(1, 4), support_stiffness=stiffness,
        support_damping=damping, bending_stiffness=bending,
        unbalances=[(places[k], u, a) for k, u, a in unbalances],
    )  # fmt: skip
    own = machine.flexible(places, masses, stiffness, damping, bending, unbalances)
    table = {"kind": "flexible", "stations": places, "masses": masses, "supports": (1, 4),
             "support_stiffness": stiffness, "support_damping": damping,
             "bending_stiffness": bending}  # fmt: skip
    table["unbalances"] = [
        {"position": places[k], "amount": u, "angle": a} for k, u, a in unbalances
    ]
    return _on_two_planes("flexible", rotor, own, (1, 2), mass, table)


def _on_two_planes(kind, rotor, own, planes, mass, table) -> Drawn:
    weights = [machine.Weight(p, mass, 1.0, 0.005) for p in planes for _ in range(2)]
    balancers = tuple(
        Mounted(name, Weights(2, mass, 1.0, 0.005, 1.4), plane, (0.0, 0.0))
        for name, plane in zip("ab", planes, strict=True)
    )
    tables = [_balls(name, p + 1, 2, mass) for name, p in zip("ab", planes, strict=True)]
    return Drawn(
        kind, own, weights, Assembly(rotor, balancers), {"rotor": table, "balancer": tables}
    )
