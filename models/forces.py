"""Forces of supports and feet on what they stand on, by the motion of a rotor's stations."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .arrays import Array, Complex
from .harmonic_balance import largest_displacement
from .rotor import LinearRotor
from .supports import Support

_BAND = math.sqrt(2.0)  # damping of the band's edges, twice the ratio


@dataclass(frozen=True, eq=False)
class ForceRows:
    """The force (F_x, F_y) of a support or foot: stiffness q + damping q', q (2, n) = x, y.

    Attributes:
        name: of the support.
        stiffness, damping: (2, 2, n) force along x, y by motion along x, y of the stations
            [N/m, N s/m]; zero where `table` has them.
        displacement: (2, n) across it by that of the stations, along x and y.
        table: number from 0, among the bearings that change with the speed, of its own; below 0:
            it is no such bearing.
    """

    name: str
    stiffness: Array
    damping: Array
    displacement: Array
    table: int = -1


def force_rows(rotor: LinearRotor) -> list[ForceRows]:
    """Of every support and foot that has a force of its own, bearings first."""
    found, tables = [], 0
    for k, support in enumerate(rotor.supports, start=1):
        if support.across:
            found.append(_rows(support, f"support[{k}]", tables))
            tables += support.table is not None
    return found


def _rows(support: Support, name: str, tables: int) -> ForceRows:
    along = np.array([0, support.across - 1])  # rows that are the displacement along x and y
    stiffness, damping = (
        np.stack([block[axis][:, along[axis]] @ support.rows for axis in (0, 1)])
        for block in (support.stiffness, support.damping)
    )
    table = -1 if support.table is None else tables
    return ForceRows(support.name or name, stiffness, damping, support.rows[along], table)


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
    """The force of every bearing and foot, of a steady motion that turns with the rotor.

    Args:
        motion: (2, n) complex amplitudes of x and y of the stations [m].
        speed: of the rotor [rad/s].
    """
    found = []
    for one in force_rows(rotor.at(speed)):
        dynamic = one.stiffness + 1j * speed * one.damping
        force = np.einsum("abj,bj->a", dynamic, motion)
        found.append(Force(one.name, (one.displacement * motion).sum(axis=1), force))
    return found


def largest(pair: Complex) -> float:
    """Largest distance from the middle of the ellipse Re(pair e^{i t}), pair (2,) complex."""
    return float(largest_displacement(pair[None, :, None])[0, 0])


def hand_weight(frequency: float) -> float:
    """Factor that weights an acceleration at a handle by its frequency [Hz]: ISO 5349-1:2001, W_h.

    A band from 6.31 to 1258.9 Hz, then a fall with the frequency above 15.915 Hz: 0.873 at 8 Hz,
    0.127 at 125 Hz.
    """
    w1, w2, w3 = (math.tau * f for f in (6.310, 1258.9, 15.915))
    s = 1j * math.tau * frequency
    band = s * s * w2 * w2 / ((s * s + s * w1 * _BAND + w1**2) * (s * s + s * w2 * _BAND + w2**2))
    fall = (s + w3) * w3 / (s * s + s * w3 / 0.64 + w3**2)
    return float(abs(band * fall))
