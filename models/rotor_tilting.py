"""Matrices of the flexible shaft whose discs tilt."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from .arrays import Numbers
from .constants import SAME_PLACE
from .shaft import Moment, bending_rows
from .tilting import Solve, TiltingShaft, arms, tilting_shaft

Skew = tuple[int, float, float]  # station from 1, angle between disc and shaft, direction [rad]


def tilting(
    z: Numbers,
    masses: Numbers,
    ends: tuple[int, int],
    *,
    transverse: Sequence[float],
    polar: Sequence[float],
    bending_stiffness: float,
    shear_stiffness: float | None,
    internal_damping: float,
    moments: Sequence[Moment],
    skews: Sequence[Skew],
    solve: Solve,
    larger: Callable[[Any, Any], Any],
) -> dict[str, Any]:
    """What `rotor_kinds.flexible` returns, but for the supports; c coordinates, see `tilting`.

    Args:
        z, masses: (n,) places [m] and discs [kg].
        ends: stations with supports, from 0.
        transverse, polar: (n,) inertias of the discs, 0 for a point [kg m^2].
        moments: of the unbalances.
        larger: the larger one of two numbers.

    Raises:
        ValueError: no body has a disc's polar inertia, a point is askew, the shaft cannot bend, or
            an unbalance lies where it cannot.
    """
    refuse_inertias(transverse, polar)
    lengths, count = arms(masses, transverse), len(z)
    beam = tilting_shaft(z, lengths, bending_stiffness, shear_stiffness, solve)
    size = len(beam.stiffness)
    mass, gyroscopic = (np.zeros((size, size), beam.stiffness.dtype) for _ in range(2))
    mass[range(count), range(count)] = masses
    for j in np.flatnonzero(beam.tilts).tolist():
        twice = np.outer(beam.slopes[j], beam.slopes[j])
        mass, gyroscopic = mass + transverse[j] * twice, gyroscopic + polar[j] * twice
    damping = np.zeros((size, size))
    if internal_damping > 0.0:
        compliance = beam.compliances(ends, solve)
        if not compliance:
            raise ValueError(
                "internal_damping: a shaft with discs at its supports only cannot bend"
            )
        damping = internal_damping * functools.reduce(larger, compliance) * beam.stiffness
    unbalance = np.zeros(size, complex)
    for place, moment in moments:
        unbalance += moment * acting_row(z, place, beam, shear_stiffness)
    for station, angle, direction in skews:
        amount, row = skewed(beam, station - 1, angle, transverse, polar)
        unbalance += amount * np.exp(1j * direction) * row
    bent = np.zeros((max(1, count - 2), size), z.dtype)
    if count > 2:
        bent[:, :count] = bending_rows(z, ends)
    return {
        "mass": mass,
        "elastic": beam.stiffness,
        "internal_damping": damping,
        "gyroscopic": gyroscopic,
        "planes": np.eye(count, size),
        "unbalance": unbalance,
        "deflection": bent,
    }


def refuse_inertias(transverse: Sequence[float], polar: Sequence[float]) -> None:
    """Raise ValueError where no body has these inertias."""
    for number, (across, along) in enumerate(zip(transverse, polar, strict=True), 1):
        if along > 2.0 * across:
            raise ValueError(
                f"polar_inertias = {along!r} kg m^2 at station {number}: must be 0 to twice the "
                f"transverse inertia, {across!r} kg m^2"
            )


def skewed(
    beam: TiltingShaft,
    station: int,
    angle: float,
    transverse: Sequence[float],
    polar: Sequence[float],
) -> tuple[float, Numbers]:
    """Couple of a disc that sits askew: its amount (It - Ip) angle [kg m^2] and its row (c,) [1/m].

    Raises:
        ValueError: the disc is a point.
    """
    if not beam.tilts[station]:
        raise ValueError(
            f"skews: station = {station + 1}: has a point for a disc: give its inertias"
        )
    return (transverse[station] - polar[station]) * angle, beam.slopes[station]


def acting_row(
    z: Numbers, place: float, beam: TiltingShaft, shear_stiffness: float | None
) -> Numbers:
    """(c,) displacement where a force acts, by reciprocity its shares.

    Raises:
        ValueError: it is not on the shaft, or between stations of one that shears.
    """
    station = int(np.argmin(np.abs(z - place)))
    if abs(z[station] - place) <= SAME_PLACE * (z[-1] - z[0]):
        return beam.motion[station]
    if not z[0] < place < z[-1] or shear_stiffness is not None:
        raise ValueError(
            f"unbalances: position = {place!r} m: must be a disc's, one of {z.tolist()}, or, on a "
            "shaft without shear_stiffness, between them"
        )
    return beam.row(z, place)
