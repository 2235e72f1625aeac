"""Matrices of the rigid rotor on two supports and of the flexible shaft with n discs.

Polushkin 2016 (8), (9) for the rigid rotor, with polar inertia and any centre of mass added;
Filimonikhin 2011 (1) for the shaft, with the shaft's compliance inverted to a stiffness.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .arrays import numbers
from .constants import SAME_PLACE
from .rotor_tilting import Skew, tilting
from .shaft import (
    Matrix,
    Moment,
    beam_compliance,
    beam_shares,
    bending_rows,
    shaft_stiffness,
    symmetric_compliance,
)
from .supports import Bearing, supported
from .tilting import Solve

Unbalance = tuple[float, float, float]


def two_support(
    *,
    mass: float,
    inertia: float,
    span: float,
    stiffness: Sequence[Sequence[float]],
    damping: Sequence[Sequence[float]] = ((0.0, 0.0), (0.0, 0.0)),
    polar_inertia: float = 0.0,
    com: float | None = None,
    planes: Sequence[float] = (),
    unbalances: Sequence[tuple[float, float, float]] = (),
    bearings: Sequence[Bearing] = (),
) -> dict[str, Any]:
    """Rigid rotor, q = displacement at its two supports: Polushkin 2016 (8), (9).

    The run-up torque is taken to act along the tilted axis: the polar inertia then leaves no
    term with w'.

    Args:
        mass, inertia, polar_inertia: m [kg], transverse It about the centre of mass and polar
            Ip [kg m^2]; the paper has Ip = 0.
        span, com: between the supports, and centre of mass from support 1 (default: the middle;
            it may lie outside) [m].
        stiffness, damping: ((k1x, k1y), (k2x, k2y)) [N/m, N s/m].
        planes: correction planes' distances from support 1, overhung ones too [m].
        unbalances: (position from support 1 [m], amount [kg m], angle in the rotor [rad]).
        bearings: in place of a support's spring and damper.

    Raises:
        ValueError: no body has this polar inertia.
    """
    if polar_inertia > 2.0 * inertia:
        raise ValueError(
            f"polar_inertia = {polar_inertia!r} kg m^2: must be 0 to 2 inertia = {2.0 * inertia:g}"
        )
    k, c = numbers(stiffness), numbers(damping)
    tilt = numbers([[-1.0, 1.0]]) / span
    at_centre = line_rows([span / 2.0 if com is None else com], span)
    u = _unbalances(unbalances)
    return {
        "mass": mass * at_centre.T @ at_centre + inertia * tilt.T @ tilt,
        "elastic": np.zeros((2, 2)),
        "supports": supported((0, 1), 2, k, c, bearings),
        "internal_damping": np.zeros((2, 2)),
        "gyroscopic": polar_inertia * tilt.T @ tilt,
        "planes": line_rows(planes, span),
        "unbalance": line_rows([z for z, _ in u], span).T @ np.array([m for _, m in u], complex),
        "deflection": np.zeros((1, 2)),
    }


def flexible(
    *,
    stations: Sequence[float],
    masses: Sequence[float],
    supports: Sequence[int],
    support_stiffness: Sequence[Sequence[float]],
    support_damping: Sequence[Sequence[float]] = ((0.0, 0.0), (0.0, 0.0)),
    bending_stiffness: float | None = None,
    compliance: Sequence[Sequence[float]] | None = None,
    internal_damping: float = 0.0,
    unbalances: Sequence[tuple[float, float, float]] = (),
    transverse_inertias: Sequence[float] = (),
    polar_inertias: Sequence[float] = (),
    shear_stiffness: float | None = None,
    skews: Sequence[Skew] = (),
    bearings: Sequence[Bearing] = (),
    elastic: Callable[[Matrix, Matrix], tuple[Matrix, float]] = shaft_stiffness,
    solve: Solve = np.linalg.solve,
    larger: Callable[[Any, Any], Any] = max,
) -> dict[str, Any]:
    """Discs on a massless shaft, q = their displacements: Filimonikhin 2011 (1).

    Every disc is a correction plane.  The shaft's material is viscous (Dubovik's p = c * its
    viscosity / E), so C_i is proportional to the shaft's stiffness, supports left out.  Discs with
    inertia tilt: behind the stations' displacements q has one more for each of them, that of a
    point of its axis one radius of gyration sqrt(It/m) beyond its station.

    Args:
        stations, masses: (n,) places [m], ascending, and discs [kg], each positive.
        supports: two different stations, from 1, in any order; discs may overhang.
        support_stiffness, support_damping: ((x, y), (x, y)) in that order [N/m, N s/m].
        bending_stiffness: E I of a uniform shaft [N m^2], or else
        compliance: (n-2, n-2) of the shaft simply supported there, without supports [m/N].
        internal_damping: p [N s/m] that belongs to c = 1/(largest delta_jj), what a disc would
            feel where the shaft is softest; with one disc it is Dubovik's p.
        unbalances: (place [m], amount [kg m], angle in the rotor [rad]); a disc's place, or one
            between discs of a uniform shaft.
        transverse_inertias, polar_inertias: (n,) of the discs about a diameter and about the
            axis, 0 for a point [kg m^2]; none: all are points.
        shear_stiffness: kappa G A of the shaft [N]; default: it does not shear.
        skews: (station from 1, angle by which its disc is askew, direction in the rotor [rad]).
        bearings: in place of a support's spring and damper.
        elastic: the shaft's stiffness and its largest compliance by compliance and bending rows.
        solve, larger: matrix^-1 right, and the larger one, of numbers of any kind.

    Raises:
        ValueError: stations, supports, unbalances or skews have places that they cannot have, a
            station has no mass, no body has a disc's inertias, or the shaft is not elastic.
    """
    z, m = _discs(stations, masses)
    p, q = supports
    if p == q:
        raise ValueError(f"supports = {[p, q]}: must be two different stations, 1 to {len(z)}")
    ends = p - 1, q - 1
    k, c = numbers(support_stiffness), numbers(support_damping)
    if len(transverse_inertias) or shear_stiffness is not None:
        if bending_stiffness is None:
            raise ValueError("compliance: has no slopes: give bending_stiffness instead")
        nothing = [0.0] * len(z)
        found = tilting(
            z, m, ends,
            transverse=transverse_inertias or nothing, polar=polar_inertias or nothing,
            bending_stiffness=bending_stiffness, shear_stiffness=shear_stiffness,
            internal_damping=internal_damping, moments=_unbalances(unbalances), skews=skews,
            solve=solve, larger=larger,
        )  # fmt: skip
        return found | {"supports": supported(ends, len(found["mass"]), k, c, bearings)}
    rows = bending_rows(z, ends)
    if compliance is not None:
        delta = symmetric_compliance(compliance, len(rows))
    else:
        assert bending_stiffness is not None, "one of both is given"
        delta = beam_compliance(z, ends, bending_stiffness)
    shaft, softest = elastic(delta, rows)
    if internal_damping > 0.0 and not len(rows):
        raise ValueError("internal_damping: a shaft with discs at its supports only cannot bend")
    return {
        "mass": np.diag(m),
        "elastic": shaft,
        "supports": supported(ends, len(z), k, c, bearings),
        # Dubovik's p belongs to the stiffness 1/delta that a disc feels where the shaft is softest
        "internal_damping": internal_damping * softest * shaft,
        "gyroscopic": np.zeros_like(shaft),
        "planes": np.eye(len(z)),
        "unbalance": _shaft_unbalance(z, unbalances, uniform=compliance is None),
        "deflection": rows if len(rows) else np.zeros((1, len(z))),
    }


def line_rows(positions: Sequence[float], span: float) -> Matrix:
    """Rows (p, 2) that give displacement at `positions` [m from support 1] from the supports'.

    Polushkin 2016 (15), (17): the force's lever, for any plane, between the supports or overhung.
    """
    share = numbers(positions) / span
    return np.stack([1.0 - share, share], axis=1)


def _discs(stations: Sequence[float], masses: Sequence[float]) -> tuple[Matrix, Matrix]:
    z = numbers(stations)
    if not np.all(np.diff(z) > 0.0):
        raise ValueError(f"stations = {z.tolist()}: must be at least two, each beyond the last [m]")
    for number, value in enumerate(masses, 1):
        if not value > 0.0:
            raise ValueError(
                f"masses = {value!r} at station {number}: must be a positive finite number [kg]; "
                "a station without mass has no motion of its own: give a support station the mass "
                "of its journal, and leave out any other"
            )
    return z, numbers(masses)


def _shaft_unbalance(
    z: Matrix, unbalances: Sequence[Unbalance], uniform: bool
) -> NDArray[np.complex128]:
    total = np.zeros(len(z), complex)
    for position, moment in _unbalances(unbalances):
        station = int(np.argmin(np.abs(z - position)))
        if abs(z[station] - position) <= SAME_PLACE * (z[-1] - z[0]):
            total[station] += moment
        elif uniform and z[0] < position < z[-1]:
            total += beam_shares(z, position) * moment
        else:
            raise ValueError(
                f"unbalances: position = {position!r} m: must be a disc's, one of {z.tolist()}, "
                "or between them on a uniform shaft"
            )
    return total


def _unbalances(unbalances: Sequence[Unbalance]) -> list[Moment]:
    """(position, complex static moment) of every unbalance."""
    return [
        (position, amount * complex(np.exp(1j * angle))) for position, amount, angle in unbalances
    ]
