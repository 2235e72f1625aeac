"""What balancing found, for JSON."""

from __future__ import annotations

import math
from cmath import phase
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .correction import Correction
    from .cycles import BalancingReport, Cycle


def of_measured(result: Correction) -> dict[str, Any]:
    """Everything found; angles in degrees, counted like the masses' in the file."""
    measured = result.measured
    planes = [
        {
            "plane": name,
            "mass_g": abs(exact),
            "angle_deg": math.degrees(phase(exact)) % 360.0,
            "radius_mm": None if measured.radii is None else measured.radii[j],
            "uncertainty_g": None if math.isnan(spread) else spread,
            "pieces": [
                {"mass_g": p.mass, "angle_deg": math.degrees(p.angle) % 360.0}
                for p in result.pieces
                if p.plane == j
            ],
        }
        for j, (name, exact, spread) in enumerate(
            zip(measured.planes, result.exact.tolist(), result.uncertainty.tolist(), strict=True)
        )
    ]
    grade = result.grade
    return {
        "runs": measured.runs,
        "corrected": result.corrected,
        "sensors": measured.sensors,
        "unit": measured.unit,
        "method": result.method,
        "condition_number": result.condition,
        "coefficients": result.coefficients,
        "planes": planes,
        "before": result.before,
        "after": result.after,
        "rms_after": result.rms,
        "grade": grade
        and {
            "name": grade.name,
            "permissible": grade.permissible,
            "before": grade.before,
            "after": grade.after,
            "reached": grade.reached,
            "met": grade.met,
        },
    }


def of_machine(result: BalancingReport) -> dict[str, Any]:
    """Everything found, SI units; for `write_json`."""
    return {
        "scene": result.name,
        "grade": result.grade,
        "speed": result.speed,
        "permissible": result.permissible,
        "permissible_at_supports": result.at_supports,
        "trial_unbalance": result.trial,
        "planes": result.planes,
        "runs": result.runs,
        "coefficients": {
            "measured": result.measured,
            "uncertainty": result.uncertainty,
            "analytic": result.analytic,
            "difference": result.difference,
        },
        "technologies": [
            {
                "name": t.name,
                "cycles": len(t.cycles),
                "meets": t.meets,
                "actually_meets": t.actually_met,
                "note": t.note,
                "coefficients": t.coefficients,
                "runs": [_run(c) for c in t.cycles],
            }
            for t in result.technologies
        ],
    }


def _run(cycle: Cycle) -> dict[str, Any]:
    return {
        "mounted": cycle.mounted,
        "amplitude": cycle.reading.amplitude,
        "uncertainty": cycle.reading.uncertainty,
        "found": cycle.found,
        "found_at_supports": cycle.at_supports,
        "actual": cycle.actual,
        "actual_at_supports": cycle.actual_at_supports,
    }
