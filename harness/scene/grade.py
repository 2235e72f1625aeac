"""The grades of ISO 21940-11: what they permit, and what an unbalance is at the supports.

A grade permits U_per = m e_per, e_per = grade/w.  Its reference planes are the supports: each gets
the share of U_per that it carries of the rotor's weight, but 0.3 to 0.7 of it with the centre of
mass between the supports, 0.3 to 1.3 outside.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .balancing import Balancing
from .scene import Scene

SHARE_INBOARD, SHARE_OVERHUNG = (0.3, 0.7), (0.3, 1.3)  # of U_per at a support


def permissible(scene: Scene, setup: Balancing) -> tuple[float, NDArray[np.float64]]:
    """U_per [kg m], and its share at each support (s,)."""
    rotor = scene.rotor
    total = rotor.mass * setup.precession / (setup.service_speed or scene.profile().end)
    carried = rotor.levers([rotor.centre])[:, 0]
    if len(carried) > 1:
        low, high = SHARE_INBOARD if np.all(carried >= 0.0) else SHARE_OVERHUNG
        carried = np.clip(np.abs(carried), low, high)
    return total, total * carried
