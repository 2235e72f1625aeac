"""The balance quality that a machine has while its balancers work: ISO 21940-11 from a run."""

from __future__ import annotations

import cmath
from collections.abc import Mapping

import numpy as np

from ..scene import Scene
from ..scene.balancer import WeightBalancer
from ..scene.balancing import Balancing
from ..scene.grade import permissible

GRADES = (0.4, 1.0, 2.5, 6.3, 16.0, 40.0, 100.0, 250.0, 630.0, 1600.0, 4000.0)  # mm/s, its table 1
_ONE = Balancing(grade="G1")


def moments(scene: Scene) -> list[str] | None:
    """Outputs that tell what the weights hold; None where a balancer is not of weights."""
    if not all(isinstance(balancer, WeightBalancer) for balancer in scene.balancer):
        return None
    return [f"{b.label}.moment_{axis}" for b in scene.balancer for axis in ("xi", "eta")]


def residual_grade(machine: Scene, held: Mapping[str, float]) -> float:
    """Smallest grade that permits what the weights leave of the unbalance, at every support [mm/s].

    Elastic rotors are judged like rigid ones.

    Args:
        held: values of `moments` [kg m]; NaN gives NaN.
    """
    rotor = machine.rotor
    if rotor.kind == "planar":
        present = [(0.0, cmath.rect(rotor.unbalance, rotor.unbalance_angle))]
    else:
        present = [(u.position, cmath.rect(u.amount, u.angle)) for u in rotor.unbalances]
    present += [
        (
            rotor.planes[b.at - 1],
            complex(held[f"{b.label}.moment_xi"], held[f"{b.label}.moment_eta"]),
        )
        for b in machine.balancer
    ]
    places, amounts = zip(*present, strict=True) if present else ((), ())
    at_supports = np.abs(rotor.levers(places) @ np.array(amounts, complex))
    return float((at_supports / permissible(machine, _ONE)[1]).max())
