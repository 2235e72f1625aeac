"""An FMU that runs alone, as the document of a system with one unit."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from ...errors import UnitError
from ...scene.patterns import LONGEST_NAME, legal_characters
from .abilities import abilities
from .archive import read_description

DEFAULT_DURATION = 1.0  # s: where the FMU suggests none
DEFAULT_STEPS = 500


def document_of(path: Path) -> dict[str, Any]:
    """A system of one FMU, as long and in the steps that it suggests itself.

    Raises:
        UnitError: it is no FMU that runs here, or suggests a start other than at 0 s.
    """
    description = read_description(path)
    experiment = description.defaultExperiment
    _refuse_later_start(path, experiment)
    stop = _suggested(experiment and experiment.stopTime, DEFAULT_DURATION)
    step = _suggested(experiment and experiment.stepSize, stop / DEFAULT_STEPS)
    if fixed := abilities(description).fixed_step:  # of which steps must be multiples
        step = fixed * max(1, round(step / fixed))
    name = legal_characters(path.stem)[:LONGEST_NAME]
    return {
        "title": description.modelName,
        "unit": [{"name": name, "fmu": path.name}],
        "coupling": {"step": min(step, stop)},
        "run": {"duration": stop},
    }


def _refuse_later_start(path: Path, experiment: Any) -> None:
    start = float((experiment and experiment.startTime) or 0.0)
    if start:
        stop = float(experiment.stopTime or math.inf)
        length = f"{stop - start:g}" if start < stop < math.inf else "1"
        raise UnitError(
            f"{path}: DefaultExperiment.startTime = {start:g}: units start at 0 s here: write a "
            f'scene file with unit = [{{name = "...", fmu = "{path.name}"}}] and run.duration = '
            f"{length}, counted from there"
        )


def _suggested(text: str | None, default: float) -> float:
    """A length of time [s] that a description gives; 0 and INF are what tools write for none."""
    value = float(text or 0.0)
    return value if 0.0 < value < math.inf else default
