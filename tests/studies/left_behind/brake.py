"""The picture of brake and drag in the manual: `python -m tests.studies.left_behind.brake`.

It is of the machine of `shares` whose supports have two natural frequencies.
"""

from __future__ import annotations

from pathlib import Path

import autobalancer as ab

from .shares import MACHINES, MASS, UNBALANCE

IMAGES = Path(__file__).resolve().parents[3] / "harness" / "manual" / "images"
NAME = "two natural frequencies"


def scene() -> ab.Scene:
    """The machine, its balls alike."""
    stiffness, damping, drag, seconds, speed = MACHINES[NAME]
    return ab.Scene(
        title=f"{NAME}, run-up {seconds:g} s",
        rotor={"kind": "planar", "mass": 1.0, "stiffness": stiffness, "damping": damping,
               "unbalance": UNBALANCE},
        balancer=[{"name": "balls", "kind": "balls", "count": 2, "mass": MASS,
                   "track_radius": 1.0, "drag": drag}],
        operation={"profile": [[0.0, 0.0], [seconds, speed]]},
    )  # fmt: skip


if __name__ == "__main__":
    scene().capture().plot(IMAGES / "brake.png")
