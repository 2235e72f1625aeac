"""Forces at supports and feet, of a steady motion that turns with the rotor."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .arrays import Complex
from .rotor import LinearRotor

_BAND = math.sqrt(2.0)  # damping of the band's edges, twice the ratio


@dataclass(frozen=True, eq=False)
class Force:
    """What a support or foot feels: x = Re(X e^{i angle}).

    Attributes:
        name: of the support.
        displacement: (2,) across it, x and y, complex 0-peak [m].
        force: (2,) on what it stands on, complex 0-peak [N].
    """

    name: str
    displacement: Complex
    force: Complex

    @property
    def amplitude(self) -> float:
        """Largest force of the orbit [N]."""
        return largest(self.force)


def forces(rotor: LinearRotor, motion: Complex, speed: float) -> list[Force]:
    """The force of every bearing and foot.

    Args:
        motion: (2, n) complex amplitudes of x and y of the stations [m].
        speed: of the rotor [rad/s].
    """
    found = []
    for k, support in enumerate(rotor.at(speed).supports, start=1):
        if support.across:
            along = [0, 1], [0, support.across - 1]  # axes, and rows along them
            d = motion @ support.rows.T  # (2, s)
            dynamic = support.stiffness + 1j * speed * support.damping
            force = np.einsum("abij,bj->ai", dynamic, d)
            name = support.name or f"support[{k}]"
            found.append(Force(name, d[along], force[along]))
    return found


def largest(pair: Complex) -> float:
    """Largest distance from the middle of the ellipse Re(pair e^{i t}), pair (2,) complex."""
    x, y = pair
    ahead, back = abs(x + 1j * y) / 2.0, abs(x - 1j * y) / 2.0
    return float(ahead + back)


def hand_weight(frequency: float) -> float:
    """Factor that weights an acceleration at a handle by its frequency [Hz].

    A band from 6.31 to 1258.9 Hz, then a fall with the frequency above 15.915 Hz: 0.873 at 8 Hz,
    0.127 at 125 Hz.
    """
    w1, w2, w3 = (math.tau * f for f in (6.310, 1258.9, 15.915))
    s = 1j * math.tau * frequency
    band = s * s * w2 * w2 / ((s * s + s * w1 * _BAND + w1**2) * (s * s + s * w2 * _BAND + w2**2))
    fall = (s + w3) * w3 / (s * s + s * w3 / 0.64 + w3**2)
    return float(abs(band * fall))
