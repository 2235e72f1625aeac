"""The grades of ISO 21940-11: what they permit, and which one a machine has while its weights work.

A grade permits U_per = m e_per, e_per = grade/w.  Its reference planes are the supports: each gets
the share of U_per that it carries of the rotor's weight, but 0.3 to 0.7 of it with the centre of
mass between the supports, 0.3 to 1.3 outside.
"""

from __future__ import annotations

import cmath
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from .balancer import WeightBalancer
from .balancing import Balancing
from .scene import Scene

SHARE_INBOARD, SHARE_OVERHUNG = (0.3, 0.7), (0.3, 1.3)  # of U_per at a support

GRADES = (0.4, 1.0, 2.5, 6.3, 16.0, 40.0, 100.0, 250.0, 630.0, 1600.0, 4000.0)  # mm/s, its table 1
_ONE = Balancing(grade="G1")


def permissible(scene: Scene, setup: Balancing) -> tuple[float, NDArray[np.float64]]:
    """U_per [kg m], and its share at each support (s,)."""
    rotor = scene.rotor
    total = rotor.mass * setup.precession / (setup.service_speed or scene.profile().end)
    carried = rotor.levers([rotor.centre])[:, 0]
    if len(carried) > 1:
        low, high = SHARE_INBOARD if np.all(carried >= 0.0) else SHARE_OVERHUNG
        carried = np.clip(np.abs(carried), low, high)
    return total, total * carried


def moments(scene: Scene) -> list[str] | None:
    """Outputs that tell what the weights hold; None where a balancer is not of weights."""
    if not all(isinstance(balancer, WeightBalancer) for balancer in scene.balancer):
        return None
    return [f"{b.label}.moment_{axis}" for b in scene.balancer for axis in ("xi", "eta")]


def residual_unbalance(
    machine: Scene, held: Mapping[str, float], time: float = 0.0, speed: float | None = None
) -> tuple[float, float]:
    """What the weights leave of the unbalance.

    Elastic rotors are judged like rigid ones.

    Args:
        held: values of `moments` [kg m]; NaN gives NaN.
        time: of the unbalance that is meant, where it changes [s].
        speed: at which the machine runs [rad/s]; by default that of its operation.

    Returns:
        The largest at a support [kg m], and the smallest grade that permits it at all [mm/s].
    """
    rotor = machine.rotor_at(time)
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
    setup = Balancing(grade="G1", service_speed=speed) if speed else _ONE
    grade = float((at_supports / permissible(machine, setup)[1]).max())
    return float(at_supports.max()), grade
