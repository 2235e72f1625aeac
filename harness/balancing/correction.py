"""From measured runs to corrections: influence coefficients, least squares, allowed angles, grade.

Corrections come in addition to what is mounted in the first run.  Runs without phases need three
trial runs per plane (Siebert's construction).  With more readings than planes
the sum of squares of what remains is least (Feese & Grazier 2004).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np

from ...models.arrays import Array, Complex
from ...models.papers.influence import condition_number, find_correction, from_runs
from ...models.papers.siebert import FromAmplitudes, from_amplitudes
from ..errors import UserError
from ..output.outcome import Outcome
from ..output.table import Sheet
from ..scene.balancing import precession_of
from .errors import READING_ERROR
from .measured import MeasuredRuns, read_measured
from .pieces import Piece, split

_LARGEST_CONDITION = 1e4  # readings of three digits then say nothing of the masses
_NOT_WORSE = 3.0  # times what the best solution without phases misses: another is not clearly worse


@dataclass(frozen=True)
class Grade:
    """What a grade of ISO 21940-11 permits, and what is there [kg m], all planes added up.

    Attributes:
        name: such as "G2.5".
        permissible: U_per.
        before: unbalance by the coefficients.
        after: what the corrections are expected to leave of it: what a largest mass leaves, and
            their standard uncertainty.
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
        uncertainty: (p,) standard uncertainty of the corrections without a largest mass [g], by
            what least squares leave; NaN where there are no more readings than corrections, or
            another method.
        method: what is least, in words.
        grade: None without a grade.
        circles: how the coefficients were found where the runs have no phases; else None.
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
    circles: FromAmplitudes | None = None

    @property
    def ambiguous(self) -> list[tuple[str, str, float]]:
        """Sensor, plane and the rms by which a second solution without phases misses the runs.

        Of those that are not clearly worse: readings that err a little can have exchanged the two.
        """
        if self.circles is None:
            return []
        best = np.sqrt(np.mean(self.circles.left**2, axis=0))
        limits = np.maximum(_NOT_WORSE * best, READING_ERROR * self.circles.responses)
        return [
            (self.measured.sensors[s], self.measured.planes[p], float(self.circles.second[s, p]))
            for s, p in np.argwhere(self.circles.second < limits[:, None]).tolist()
        ]

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
    largest: Sequence[float] = (),
) -> Correction:
    """Corrections by least squares, or those that make the largest reading least.

    Where the runs have no phases, coefficients are found from an initial run and three trial runs
    in every plane (Siebert's construction).

    Args:
        measured: a CSV file of runs, or what `read_measured` returns.
        angles: allowed angles [rad] of every plane, or of all by one list; default: any.
        grade: of ISO 21940-11, such as "G2.5"; requires the radii and
        mass: of the rotor [kg], and
        service_speed: [rad/s]; default: the fastest one measured.
        min_max: the largest reading is to be least.
        largest: largest correction [g] of every plane, or of all by one number, before it is split
            onto allowed angles; default: any.

    Raises:
        UserError: the runs do not tell the planes apart, the readings do not determine the
            corrections, allowed angles or largest masses do not fit the planes, or something that
            the grade needs is missing.

    >>> rows = ["run,sensor,amplitude_um,phase_lead_deg,mass_g[a],angle_deg[a]"]
    >>> rows += ["as found,A,10,0,,", "trial,A,8,60,5,90"]
    >>> text = open("runs.csv", "w").write("\\n".join(rows))
    >>> ab.correct("runs.csv", angles=[[0.0, 2.0, 4.0]]).rms < 1e-9
    True
    """
    place = ""
    if not isinstance(measured, MeasuredRuns):
        place, measured = f"{measured}: ", read_measured(Path(measured))
    coefficients, initial, circles = _coefficients(measured, place)
    condition = condition_number(coefficients)
    _refuse_undetermined(measured, coefficients, condition, place)
    readings, planes = coefficients.shape
    if len(largest) not in (0, 1, planes) or not all(0.0 < mass < math.inf for mass in largest):
        raise UserError(
            f"largest mass {', '.join(f'{mass:g}' for mass in largest)}: must be grams above 0, "
            f"one number for all planes or one for each of the {planes}"
        )
    needed = exact = find_correction(coefficients, initial, min_max=min_max)
    if largest:
        bounds = np.broadcast_to(largest, planes)
        exact = find_correction(coefficients, initial, bounds, min_max)
    spread = np.full(planes, math.nan)
    if readings > planes and not min_max:
        left = initial + coefficients @ needed
        variance = float((np.abs(left) ** 2).sum()) / (readings - planes)
        inverse = np.linalg.inv(coefficients.conj().T @ coefficients)
        spread = np.sqrt(variance * inverse.diagonal().real)
    graded = None
    if grade:
        left_over = np.abs(exact - needed) + np.nan_to_num(spread)
        graded = _graded(measured, grade, np.abs(needed), left_over, mass, service_speed)
    return Correction(
        measured=measured,
        coefficients=coefficients,
        condition=condition,
        exact=exact,
        pieces=split(measured.planes, exact, angles),
        before=measured.responses[0],
        after=initial + coefficients @ exact,
        uncertainty=spread,
        method="least maximum" if min_max else "least squares",
        grade=graded,
        circles=circles,
    )


def _coefficients(
    measured: MeasuredRuns, place: str
) -> tuple[Complex, Complex, FromAmplitudes | None]:
    """Influence coefficients (s, p), amplitudes of the first run (s,), and how both were found
    where the runs have no phases."""
    try:
        if measured.has_phase:
            found = from_runs(measured.responses, measured.mounted)
            return found, measured.responses[0], None
        circles = from_amplitudes(np.abs(measured.responses), measured.mounted)
    except ValueError as error:
        raise UserError(f"{place}{error}") from error
    return circles.coefficients, circles.responses.astype(complex), circles


def _refuse_undetermined(
    measured: MeasuredRuns, coefficients: Complex, condition: float, place: str
) -> None:
    """Raise UserError where the readings do not determine the corrections of all planes."""
    readings, planes = coefficients.shape
    for plane, moved in zip(measured.planes, np.abs(coefficients).T, strict=True):
        if not moved.any():
            raise UserError(
                f"{place}the trial masses of plane {plane or 1} change no reading: check "
                "them, or add a sensor or a speed"
            )
    if readings < planes or not condition < _LARGEST_CONDITION:
        raise UserError(
            f"{place}the readings in each run ({readings}) do not determine corrections "
            f"in all planes ({planes}): condition number {condition:.3g}, must be below "
            f"{_LARGEST_CONDITION:g}, with a reading for every plane: leave out a plane, or add a "
            "sensor or a speed"
        )


def _graded(
    measured: MeasuredRuns,
    name: str,
    needed: Array,
    left_over: Array,
    mass: float | None,
    service_speed: float | None,
) -> Grade:
    if measured.radii is None:
        raise UserError("--grade: needs the radius of every plane: columns radius[PLANE] [mm]")
    speed = float(measured.speeds.max()) if service_speed is None else service_speed
    if mass is None or not (0.0 < mass < math.inf and 0.0 < speed < math.inf):
        raise UserError(
            "--grade: needs the rotor's mass (--mass, kg) and its service speed (--service-speed, "
            "rad/s, or a column speed [rpm]), finite and above 0"
        )
    try:
        precession = precession_of(name)
    except ValueError as error:
        raise UserError(f"--grade {name}: {error}") from None
    arms = 1e-6 * np.array(measured.radii)  # g mm to kg m
    before, after = float(arms @ needed), float(arms @ left_over)
    permissible = mass * precession / speed
    return Grade(name, permissible, before, after, 1e3 * after * speed / mass)
