"""Neighbouring motions: a scene whose weights start a little elsewhere.

A method resolves angles to `RESOLVED`: bounces that rise less end in contact.  Where collisions
amplify such a difference, or where it decides which of two simultaneous impacts comes first, nobody
knows the motion that a run has computed.  Two neighbours on opposite sides show it.

How neighbours part is a property of the machine, not of what couples its parts.  So separate FMUs
need not be run again for it: one file computes the motion and both neighbours in a tenth of the
time.  Parts of any origin it does not have; such scenes run their own units.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..scene import Scene
from ..scene.balancer import WeightBalancer
from .at_events import Counted
from .compared import ASYMPTOTIC, largest_difference
from .recorder import Recorder, Signal
from .schedule import SLIVER

if TYPE_CHECKING:
    from .one_file_run import OneFileRun

# rad: ten times LOWEST_BOUNCE of the units, for a run has many bounces that end in contact
RESOLVED = 1e-8
BOTH_SIDES = (1.0, -1.0)
GOLDEN = math.pi * (3.0 - math.sqrt(5.0))  # its multiples are spread evenly over a turn
AGREE = 0.3  # of what a run differs from neighbours by: neighbours that agree so far know its error

ELSEWHERE = "runs with weights that start 1e-8 rad elsewhere end {:.1g} away"
REFINED = "runs in ever shorter steps differ by {:.1g}"
UNCOMPUTED = "a neighbouring motion cannot be computed: {}"


def turned_angles(scene: Scene, turn: float) -> dict[str, list[float]] | None:
    """Start angles of every weight that can collide, turned by another part of `turn` [rad].

    By balancer.  None where no start so near is allowed: weights would overlap.
    """
    found = {}
    for balancer in scene.balancer:
        if isinstance(balancer, WeightBalancer) and balancer.half_angle:
            parts = [math.sin(1.0 + GOLDEN * k) for k in range(balancer.count)]
            pairs = zip(balancer.angles, parts, strict=True)
            angles = [angle + turn * part for angle, part in pairs]
            if balancer.overlapping(angles):
                return None
            found[balancer.label] = angles
    return found


def turned(scene: Scene, turn: float) -> Scene | None:
    """The scene with weights that start at `turned_angles`, or None."""
    angles = turned_angles(scene, turn)
    changes = {f"{name}.angles": each for name, each in (angles or {}).items()}
    return None if angles is None else scene.replace(changes)


def run_in_one_piece(
    run: OneFileRun,
    share: float,
    points: Signal,
    names: Sequence[str],
    turn: float = 0.0,
    grain: float = 0.0,
) -> Counted:
    """Signals by `names` at some points [s] of the motion whose weights start so far elsewhere.

    Args:
        share, grain: as of `OneFileRun.start`.
        turn: as of `turned_angles`; 0 is the scene's own motion.

    Raises:
        SimulationError: the motion cannot be computed.
    """
    recorder = Recorder(run.units, names)
    run.start(share, points, grain, turned_angles(run.scene, turn) if turn else None)
    run.record(recorder, None)
    times, found = recorder.columns()
    at = np.searchsorted(times, points * (1.0 - SLIVER))
    return Counted(found, run.events).at(at)


def add_parting(
    error: float,
    own: Mapping[str, Signal],
    others: Sequence[Mapping[str, Signal]],
    scale: Mapping[str, float],
    tolerance: float,
) -> tuple[float, str]:
    """The error of a run with what its motion and two neighbours differ by; why it is not known.

    Args:
        error: of the run by its steps.
        own, others: signals of the motion, and of both neighbours, at the same times.
        scale: by signal, as of `largest_difference`.
    """
    stated = max([error, *(largest_difference(own, each, scale) for each in others)])
    if stated <= tolerance:
        return stated, ""
    if stated > error and largest_difference(others[0], others[1], scale) > AGREE * stated:
        return stated, ELSEWHERE.format(stated)
    return stated, REFINED.format(stated) if stated >= ASYMPTOTIC else ""
