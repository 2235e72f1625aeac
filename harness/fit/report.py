"""A fit in words and a table, and as a document for JSON."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from ...models.readable import rounded
from ..output.outcome import Outcome
from ..output.table import Sheet
from .estimate import document_of_values
from .study import Fit


def document(found: Fit) -> dict[str, Any]:
    """Everything that the command says."""
    return {
        **document_of_values(found, found.measured.path, len(found.measured.logarithms)),
        "rms_first_guess": found.guessed if math.isfinite(found.guessed) else None,
        "starts": found.starts,
        "systematic": found.is_systematic,
        "runout": found.runout
        and {
            "is_likely": found.runout.is_likely,
            "significance": None if math.isnan(found.runout.chance) else found.runout.chance,
            "sizes": dict(found.runout.sizes),
        },
    }


def table(found: Outcome) -> Sheet:
    """A line per parameter of a fit."""
    sheet = found.table()
    rows = [
        [
            *names,
            f"{start:.6g}",
            f"{value:.6g}",
            rounded(spread, 2) if math.isfinite(spread) else "-",
        ]
        for *names, start, value, spread in sheet.rows
    ]
    return replace(sheet, rows=rows, title="")


def lines(said: Mapping[str, Any]) -> list[str]:
    """What the table does not say."""
    predicted = []
    if "rms_predicted" in said:
        predicted = [f"Predicted: rms {said['rms_predicted']:.4g}, {said['predicted']}"]
    guessed = said["rms_first_guess"]
    return [
        *([f"By harmonic balance, best of {said['starts']}: rms {guessed:.4g}"] if guessed else []),
        f"{said['values']} measured values; rms of ln(simulated / measured): "
        f"{said['rms_before']:.4g} before, {said['rms']:.4g} after",
        *predicted,
        *(f"Warning: {text}" for text in said["warnings"]),
        "As options: "
        + " ".join(
            f'--set "{path}={one["value"]:.6g}"'
            for one in said["parameters"]
            for path in one["path"].split("=")
        ),
    ]
