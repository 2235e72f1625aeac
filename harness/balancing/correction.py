"""From measured runs to corrections: influence coefficients, least squares, allowed angles, grade.

Corrections come in addition to what is mounted in the run that they correct.  With more readings
than two a plane the sum of squares of what remains is least (Feese & Grazier 2004).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np
from pydantic import ValidationError
from scipy.optimize import nnls

from ...models.arrays import Array, Complex
from ...models.papers.influence import (
    condition_number,
    from_runs,
    limited_correction,
    unbalance_from_response,
)
from ..errors import UserError
from ..output.outcome import Outcome
from ..output.table import Sheet
from ..scene.balancing import Balancing
from .measured import MeasuredRuns, read_measured

_LARGEST_CONDITION = 1e4  # readings of three digits then say nothing of the masses

_NOTHING = 1e-9  # of the largest correction: a mass that rounding makes


@dataclass(frozen=True)
class Piece:
    """A mass at an angle [g, rad] in a plane, by its place in `MeasuredRuns.planes`."""

    plane: int
    mass: float
    angle: float


@dataclass(frozen=True)
class Grade:
    """What a grade of ISO 21940-11 permits, and what is there [kg m], all planes added up.

    Attributes:
        name: such as "G2.5".
        permissible: U_per.
        before, after: unbalance by the coefficients, and what the corrections are expected to
            leave of it: what the allowed angles miss, and the standard uncertainty.
        reached: what `after` would be, as a grade [mm/s].
    """

    name: str
    permissible: float
    before: float
    after: float
    reached: float

    @property
    def met(self) -> bool:
        """Whether no more is expected to remain than is permissible."""
        return self.after <= self.permissible


@dataclass(frozen=True, eq=False, repr=False)
class Correction(Outcome):
    """What to mount, and what is expected of it.

    Attributes:
        measured: the runs.
        corrected: name of the run whose vibration is corrected.
        coefficients: (s, p) influence coefficients [amplitude/g].
        condition: their condition number.
        exact: (p,) corrections [g] by `method`, at any angle.
        pieces: the same at allowed angles; one a plane where any angle is.
        before, after: (s,) complex amplitudes, measured and with the pieces expected.
        uncertainty: (p,) standard uncertainty of the corrections [g], by what least squares leave;
            NaN where there are no more readings than corrections, or another method.
        method: what is least, in words.
        grade: None where it was not asked.
    """

    drawn_by: ClassVar[str] = "..balancing.plot_measured:plot_correction"
    document_by: ClassVar[str] = "..balancing.documents:of_measured"

    measured: MeasuredRuns
    corrected: str
    coefficients: Complex
    condition: float
    exact: Complex
    pieces: tuple[Piece, ...]
    before: Complex
    after: Complex
    uncertainty: Array
    method: str
    grade: Grade | None = None

    @property
    def rms(self) -> float:
        """Root mean square of what is expected to remain."""
        return float(np.sqrt(np.mean(np.abs(self.after) ** 2)))

    def table(self) -> Sheet:
        """What to mount in addition to the run that is corrected, a row for every mass."""
        planes = self.measured.planes
        rows = [(planes[p.plane], p.mass, math.degrees(p.angle) % 360.0) for p in self.pieces]
        return Sheet(("plane", "mass [g]", "angle [deg]"), rows, "lrr", self.corrected)


def correct(
    measured: MeasuredRuns | str | Path,
    *,
    run: str | None = None,
    angles: Sequence[Sequence[float]] = (),
    grade: str = "",
    mass: float | None = None,
    service_speed: float | None = None,
    min_max: bool = False,
    largest: Sequence[float] = (),
) -> Correction:
    """Corrections by least squares, or those that make the largest reading least.

    Args:
        measured: a CSV file of runs, see `read_measured`, or what that returns.
        run: whose vibration is corrected; by default the reference, the first one.
        angles: allowed angles [rad] of every plane, or of all by one list; by default any.
        grade: of ISO 21940-11, such as "G2.5"; needs the radii and
        mass: of the rotor [kg], and
        service_speed: [rad/s]; by default the fastest one measured.
        min_max: the largest reading is to be least.
        largest: mass [g] that a plane takes, of every plane, or of all by one; by default any.

    Raises:
        UserError: there is no such run, the runs do not tell the planes apart, the readings do not
            determine the corrections, allowed angles do not fit the planes, or something that the
            grade needs is missing.

    >>> rows = ["run,sensor,amplitude_um,phase_lead_deg,mass_g[a],angle_deg[a]"]
    >>> rows += ["as found,A,10,0,,", "trial,A,8,60,5,90"]
    >>> text = open("runs.csv", "w").write("\\n".join(rows))
    >>> ab.correct("runs.csv", angles=[[0.0, 1.0, 2.0]]).rms < 10.0
    True
    """
    if not isinstance(measured, MeasuredRuns):
        measured = read_measured(Path(measured))
    corrected = run or measured.runs[0]
    if corrected not in measured.runs:
        raise UserError(f"run {corrected!r}: must be one of {', '.join(measured.runs)}")
    try:
        coefficients = from_runs(measured.responses, measured.mounted)
    except ValueError as error:
        raise UserError(str(error)) from error
    readings, planes = coefficients.shape
    condition = condition_number(coefficients)
    if readings < planes or not condition < _LARGEST_CONDITION:
        raise UserError(
            f"{readings} readings, condition number {condition:.3g}: do not determine corrections "
            f"in {planes} planes; needs at least {planes} readings and a condition number below "
            f"{_LARGEST_CONDITION:g}: leave out a plane, or add a sensor or a speed"
        )
    before = measured.responses[measured.runs.index(corrected)]
    if len(largest) not in (0, 1, planes):
        raise UserError(f"largest mass of {len(largest)} planes: must be one, or {planes}")
    method = "least maximum" if min_max else "least squares"
    limited = min_max or bool(largest)
    if limited:
        bounds = np.broadcast_to(largest, planes) if largest else None
        exact = limited_correction(coefficients, before, bounds, min_max)
    else:
        exact = -unbalance_from_response(coefficients, before)
    pieces = split(coefficients, before, exact, angles, limited)
    mounted = np.zeros(planes, complex)
    for piece in pieces:
        mounted[piece.plane] += piece.mass * np.exp(1j * piece.angle)
    missed = before + coefficients @ exact
    spread = np.full(planes, math.nan)
    if readings > planes and not limited:
        variance = float((np.abs(missed) ** 2).sum()) / (readings - planes)
        inverse = np.linalg.inv(coefficients.conj().T @ coefficients)
        spread = np.sqrt(variance * inverse.diagonal().real)
    graded = None
    if grade:
        left = np.abs(mounted - exact) + np.nan_to_num(spread)
        graded = _graded(measured, grade, np.abs(exact), left, mass, service_speed)
    after = before + coefficients @ mounted
    return Correction(
        measured, corrected, coefficients, condition, exact, pieces, before, after, spread, method,
        graded,
    )  # fmt: skip


def split(
    coefficients: Complex,
    before: Complex,
    exact: Complex,
    angles: Sequence[Sequence[float]],
    limited: bool = False,
) -> tuple[Piece, ...]:
    """Corrections as masses at allowed angles [rad].

    Two neighbouring angles less than half a turn apart make any correction between them.  Where one
    lies in a wider gap, masses at all allowed angles are those of least squares.

    Args:
        limited: the corrections are not those of least squares.

    Raises:
        UserError: there are lists for another number of planes, or too wide a gap between angles.
    """
    if not angles:
        return tuple(Piece(i, abs(w), float(np.angle(w))) for i, w in enumerate(exact.tolist()))
    if len(angles) not in (1, len(exact)):
        raise UserError(f"allowed angles of {len(angles)} planes: must be of all at once, or of "
                        f"each of the {len(exact)}")  # fmt: skip
    lists = list(angles) * (len(exact) if len(angles) == 1 else 1)
    pieces = [_neighbours(i, w, a) for i, (w, a) in enumerate(zip(exact, lists, strict=True))]
    if all(each is not None for each in pieces):
        masses = [piece for each in pieces for piece in each or ()]
        least = _NOTHING * float(np.abs(exact).max())
        return tuple(piece for piece in masses if piece.mass > least)
    if limited:
        raise UserError("allowed angles half a turn or more apart: only with least squares of any "
                        "mass, without --min-max and --largest-mass")  # fmt: skip
    places = [(plane, angle) for plane, allowed in enumerate(lists) for angle in allowed]
    columns = np.array([coefficients[:, p] * np.exp(1j * angle) for p, angle in places]).T
    masses, _ = nnls(
        np.vstack([columns.real, columns.imag]), -np.concatenate([before.real, before.imag])
    )
    return tuple(
        Piece(plane, float(m), angle)
        for (plane, angle), m in zip(places, masses, strict=True)
        if m > 0.0
    )


def _neighbours(plane: int, needed: complex, allowed: Sequence[float]) -> list[Piece] | None:
    """The two allowed angles on both sides, or the one that is hit; None in a gap too wide."""
    behind = sorted(allowed, key=lambda a: (np.angle(needed) - a) % (2.0 * math.pi))[0]
    ahead = sorted(allowed, key=lambda a: (a - np.angle(needed)) % (2.0 * math.pi))[0]
    gap = (ahead - behind) % (2.0 * math.pi)
    if behind == ahead:
        hit = abs(np.angle(needed * np.exp(-1j * behind))) < 1e-9
        return [Piece(plane, abs(needed), behind)] if hit else None
    if not gap < math.pi - 1e-9:
        return None
    part = np.angle(needed * np.exp(-1j * behind)) % (2.0 * math.pi)
    first = abs(needed) * math.sin(gap - part) / math.sin(gap)
    second = abs(needed) * math.sin(part) / math.sin(gap)
    return [Piece(plane, first, behind), Piece(plane, second, ahead)]


def _graded(
    measured: MeasuredRuns,
    name: str,
    before: Array,
    after: Array,
    mass: float | None,
    service_speed: float | None,
) -> Grade:
    if measured.radii is None:
        raise UserError("a grade needs the radius of every plane: columns radius_mm[...]")
    speed = service_speed or float(measured.speeds.max())
    if mass is None or not speed > 0.0:
        raise UserError(
            "a grade needs the rotor's mass (--mass, kg) and its service speed (--service-speed, "
            "rad/s, or a column speed_rpm)"
        )
    try:
        precession = Balancing(grade=name).precession
    except ValidationError as error:
        raise UserError(f"grade {name!r}: {error.errors()[0]['msg']}") from error
    arms = 1e-6 * np.array(measured.radii)  # g mm to kg m
    left = float(arms @ after)
    permissible = mass * precession / speed
    return Grade(name, permissible, float(arms @ before), left, 1e3 * left * speed / mass)
