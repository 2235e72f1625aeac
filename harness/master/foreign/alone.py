"""An FMU that runs alone, as the document of a system with one unit."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from .abilities import abilities
from .archive import read_description

DEFAULT_DURATION = 1.0  # s: where the FMU suggests none
DEFAULT_STEPS = 500


def document_of(path: Path) -> dict[str, Any]:
    """A system of one FMU, as long and in the steps that it suggests itself.

    Raises:
        UnitError: it is no FMU that runs here.
    """
    description = read_description(path)
    experiment = description.defaultExperiment
    stop = float((experiment and experiment.stopTime) or DEFAULT_DURATION)
    step = float((experiment and experiment.stepSize) or stop / DEFAULT_STEPS)
    if fixed := abilities(description).fixed_step:  # of which steps must be multiples
        step = fixed * max(1, round(step / fixed))
    name = re.sub(r"^(?=[\d-])|[^\w-]", "_", path.stem, flags=re.ASCII)[:32]
    return {
        "title": description.modelName,
        "unit": [{"name": name, "fmu": path.name}],
        "coupling": {"step": min(step, stop)},
        "run": {"duration": stop},
    }
