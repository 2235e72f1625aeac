"""From measured runs to corrections: influence coefficients, least squares, allowed angles, grade.

Corrections come in addition to what is mounted in the first run.  With more readings than planes
the sum of squares of what remains is least (Feese & Grazier 2004).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np
from pydantic import ValidationError

from ...models.arrays import Array, Complex
from ...models.papers.influence import (
    condition_number,
    from_runs,
    least_maximum_correction,
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
    """A mass at an angle [g, rad] in a plane, by its name."""

    plane: str
    mass: float
    angle: float


@dataclass(frozen=True)
class Grade:
    """What a grade of ISO 21940-11 permits, and what is there [kg m], all planes added up.

    Attributes:
        name: such as "G2.5".
        permissible: U_per.
        before: unbalance by the coefficients.
        after: what the corrections are expected to leave of it: their standard uncertainty.
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
        measured: the runs; the first one is corrected.
        coefficients: (s, p) influence coefficients [amplitude/g].
        condition: their condition number.
        exact: (p,) corrections [g] by `method`, at any angle.
        pieces: the same at allowed angles; one per plane where any angle is.
        before, after: (s,) complex amplitudes, measured and with the corrections expected.
        uncertainty: (p,) standard uncertainty of the corrections [g], by what least squares leave;
            NaN where there are no more readings than corrections, or another method.
        method: what is least, in words.
        grade: None without a grade.
    """

    drawn_by: ClassVar[str] = "..balancing.plot:plot_measured"
    document_by: ClassVar[str] = "dataclasses:asdict"

    measured: MeasuredRuns
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

    @property
    def met(self) -> bool:
        """Whether the grade is expected to be met; true without one."""
        return self.grade is None or self.grade.met

    def table(self) -> Sheet:
        """What to mount in addition to the first run, a row for every mass."""
        rows = [(p.plane, p.mass, math.degrees(p.angle) % 360.0) for p in self.pieces]
        return Sheet(("plane", "mass [g]", "angle [deg]"), rows, "lrr", self.measured.runs[0])


def correct(
    measured: MeasuredRuns | str | Path,
    *,
    angles: Sequence[Sequence[float]] = (),
    grade: str = "",
    mass: float | None = None,
    service_speed: float | None = None,
    min_max: bool = False,
) -> Correction:
    """Corrections by least squares, or those that make the largest reading least.

    Args:
        measured: a CSV file of runs, see `read_measured`, or what that returns.
        angles: allowed angles [rad] of every plane, or of all by one list; default: any.
        grade: of ISO 21940-11, such as "G2.5"; requires the radii and
        mass: of the rotor [kg], and
        service_speed: [rad/s]; default: the fastest one measured.
        min_max: the largest reading is to be least.

    Raises:
        UserError: the runs do not tell the planes apart, the readings do not determine the
            corrections, allowed angles do not fit the planes, or something that the grade needs is
            missing.

    >>> rows = ["run,sensor,amplitude_um,phase_lead_deg,mass_g[a],angle_deg[a]"]
    >>> rows += ["as found,A,10,0,,", "trial,A,8,60,5,90"]
    >>> text = open("runs.csv", "w").write("\\n".join(rows))
    >>> ab.correct("runs.csv", angles=[[0.0, 2.0, 4.0]]).rms < 1e-9
    True
    """
    if not isinstance(measured, MeasuredRuns):
        measured = read_measured(Path(measured))
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
    before = measured.responses[0]
    if min_max:
        exact = least_maximum_correction(coefficients, before)
    else:
        exact = -unbalance_from_response(coefficients, before)
    after = before + coefficients @ exact
    spread = np.full(planes, math.nan)
    if readings > planes and not min_max:
        variance = float((np.abs(after) ** 2).sum()) / (readings - planes)
        inverse = np.linalg.inv(coefficients.conj().T @ coefficients)
        spread = np.sqrt(variance * inverse.diagonal().real)
    return Correction(
        measured=measured,
        coefficients=coefficients,
        condition=condition,
        exact=exact,
        pieces=split(measured.planes, exact, angles),
        before=before,
        after=after,
        uncertainty=spread,
        method="least maximum" if min_max else "least squares",
        grade=_graded(measured, grade, exact, spread, mass, service_speed) if grade else None,
    )


def split(
    planes: Sequence[str], exact: Complex, angles: Sequence[Sequence[float]]
) -> tuple[Piece, ...]:
    """Corrections as masses at allowed angles [rad]: in each plane at the two on either side.

    Raises:
        UserError: there are lists for another number of planes, or a correction lies between angles
            that are half a turn or more apart.
    """
    named = list(zip(planes, exact.tolist(), strict=True))
    if not angles:
        return tuple(Piece(plane, abs(w), float(np.angle(w))) for plane, w in named)
    if len(angles) not in (1, len(planes)):
        raise UserError(
            f"allowed angles of {len(angles)} planes: must be of all at once, or of each of the "
            f"{len(planes)}"
        )
    lists = list(angles) * (len(planes) if len(angles) == 1 else 1)
    pieces = [p for (plane, w), own in zip(named, lists, strict=True) for p in _two(plane, w, own)]
    least = _NOTHING * float(np.abs(exact).max())
    return tuple(piece for piece in pieces if piece.mass > least)


def _two(plane: str, needed: complex, allowed: Sequence[float]) -> list[Piece]:
    """Masses at the allowed angles on either side of a correction."""
    turn, angle = 2.0 * math.pi, float(np.angle(needed))
    behind = min(allowed, key=lambda a: (angle - a) % turn)
    ahead = min(allowed, key=lambda a: (a - angle) % turn)
    if behind == ahead and abs(math.remainder(angle - behind, turn)) < _NOTHING:
        return [Piece(plane, abs(needed), behind)]
    gap, part = (ahead - behind) % turn, (angle - behind) % turn
    if behind == ahead or not gap < math.pi - _NOTHING:
        raise UserError(
            f"plane {plane}: the correction at {math.degrees(angle) % 360.0:.1f} deg has no two "
            "allowed angles less than half a turn apart on either side: allow more angles"
        )
    sizes = math.sin(gap - part), math.sin(part)
    return [
        Piece(plane, abs(needed) * size / math.sin(gap), place)
        for size, place in zip(sizes, (behind, ahead), strict=True)
    ]


def _graded(
    measured: MeasuredRuns,
    name: str,
    exact: Complex,
    spread: Array,
    mass: float | None,
    service_speed: float | None,
) -> Grade:
    if measured.radii is None:
        raise UserError("a grade needs the radius of every plane: columns radius_mm[...]")
    speed = float(measured.speeds.max()) if service_speed is None else service_speed
    if mass is None or not (0.0 < mass < math.inf and 0.0 < speed < math.inf):
        raise UserError(
            "a grade needs the rotor's mass (--mass, kg) and its service speed (--service-speed, "
            "rad/s, or a column speed_rpm), finite and above 0"
        )
    try:
        precession = Balancing(grade=name).precession
    except ValidationError as error:
        raise UserError(f"grade {name!r}: {error.errors()[0]['msg']}") from error
    arms = 1e-6 * np.array(measured.radii)  # g mm to kg m
    before, after = float(arms @ np.abs(exact)), float(arms @ np.nan_to_num(spread))
    permissible = mass * precession / speed
    return Grade(name, permissible, before, after, 1e3 * after * speed / mass)
